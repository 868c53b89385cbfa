// Captions in one .txt file for each clip, with the time ranges of HumanML3D.
#pragma once
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/data/caption_file.hpp"
#include "motiongan/data/caption_match.hpp"
#include "motiongan/formats/clip_files.hpp"
#include "motiongan/io/read_number.hpp"

namespace motiongan::motion {

namespace caption_detail {

/// The number, which may be nan, or nothing.
inline std::optional<double> number_of(std::string_view text) {
  text = trimmed(text);
  double value = 0;
  const auto [end, problem] = io::read_number(text.data(), text.data() + text.size(), value);
  return problem == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

/// The caption of a line: HumanML3D's `text#tokens#start#end`, or the whole line. 0 or nan for both times is
/// the whole clip, nan for one of them the clip's start or end.
inline Caption caption_of_line(std::string_view line, std::string_view place) {
  if (std::count(line.begin(), line.end(), '#') != 3) return {std::string(line)};
  const std::size_t last = line.rfind('#'), middle = line.rfind('#', last - 1);
  const auto start = number_of(line.substr(middle + 1, last - middle - 1)),
             stop = number_of(line.substr(last + 1));
  if (!start || !stop) return {std::string(line)};
  Caption out{std::string(trimmed(line.substr(0, line.find('#'))))};
  require(!std::isinf(*start) && !std::isinf(*stop), place, ": found the times ", *start, " to ", *stop,
          " s, expected finite numbers, or nan for the clip's start or end");
  const double begin = std::isnan(*start) ? 0 : *start;
  const double end = std::isnan(*stop) ? std::numeric_limits<double>::infinity() : *stop;
  if (begin == 0 && (end == 0 || std::isinf(end))) return out;
  require(std::isfinite(begin) && begin >= 0 && end > begin, place, ": found the times ", begin, " to ", end,
          " s, expected an end after the start, or 0.0#0.0 for the whole clip");
  out.part = CaptionPart{begin, end};
  return out;
}

/// Adds the captions of one clip's text file.
inline void add_clip_text(CaptionFile& out, const std::string& id, const std::filesystem::path& file) {
  const std::string name = file.string(), text = read_text(file, "text file", largest_list_file);
  for_each_line(text, name, [&](const TextLine& line) {
    require_utf8(line.raw, name, line.number);
    Caption caption = caption_of_line(line.text, place(name, line.number));
    require(!split_words(caption.text).empty(), name, ":", line.number, ": found '", line.text.substr(0, 60),
            "', expected a caption of at least one word");
    const bool has_letter = std::any_of(caption.text.begin(), caption.text.end(), [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c & 0x80) != 0;
    });
    require(has_letter, name, ":", line.number, ": found only numbers, '", line.text.substr(0, 60),
            "', expected a caption; move files that hold no captions elsewhere, or give --captions");
    out.lines.push_back({id, std::move(caption), line.number});
  });
}

/// The .txt files of folders, by folder and name without extension; each folder is listed once.
class TextFolders {
 public:
  /// The text file of that name, or else one whose name differs in case only; empty if there is none.
  std::filesystem::path find(const std::filesystem::path& folder, const std::string& name) {
    const auto [at, is_new] = folders_.try_emplace(folder);
    if (is_new) list(folder, at->second);
    for (const std::string& key : {name, "/" + lower(name)})
      if (const auto found = at->second.find(key); found != at->second.end()) return found->second;
    return {};
  }

 private:
  using Files = std::map<std::string, std::filesystem::path>;

  /// Lists files by name and, with a slash in front, by name in lower case.
  static void list(const std::filesystem::path& folder, Files& files) {
    namespace fs = std::filesystem;
    std::error_code problem, ignored;  // of a link that leads nowhere: its reader names it
    std::vector<fs::path> found;
    fs::directory_iterator entries(folder.empty() ? fs::path(".") : folder, problem);
    for (; !problem && entries != fs::directory_iterator(); entries.increment(problem))
      if (extension_of(entries->path()) == ".txt" && !entries->is_directory(ignored))
        found.push_back(entries->path());
    std::sort(found.begin(), found.end());
    for (const fs::path& file : found) {
      files.emplace(file.stem().string(), file);
      files.emplace("/" + lower(file.stem().string()), file);
    }
  }

  std::map<std::filesystem::path, Files> folders_;
};

}  // namespace caption_detail

/// Reads the .txt files beside the clips: `walk.txt` in the folder of `walk.bvh`, or in a folder `texts` in
/// it or beside it. Each line is a caption, of a part of the clip if it is HumanML3D's
/// `text#tokens#start#end`. `names` are those of `files`. Returns an empty CaptionFile if no clip has one.
/// Throws Error as `file:line: ...`.
inline CaptionFile read_captions_beside(std::span<const std::filesystem::path> files,
                                        std::span<const ClipName> names) {
  CaptionFile out{{}, {}, true};
  caption_detail::TextFolders folders;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const std::filesystem::path folder = files[i].parent_path();
    for (const auto& place : {folder, folder / "texts", (folder / ".." / "texts").lexically_normal()}) {
      const std::filesystem::path text = folders.find(place, clip_stem(files[i]));
      if (text.empty()) continue;
      out.name = "the .txt files beside the clips";
      caption_detail::add_clip_text(out, names[i].path, text);
      break;
    }
  }
  return out;
}

/// Reads all .txt files of a folder and its subfolders; a file's path below it without extension is the
/// clip's id. Throws Error if there are none, and as `file:line: ...`.
inline CaptionFile read_caption_folder(const std::filesystem::path& folder) {
  CaptionFile out{folder.string(), {}};
  for (const std::filesystem::path& file : find_clip_files(folder, {".txt"}))
    caption_detail::add_clip_text(out, file.lexically_relative(folder).replace_extension().generic_string(),
                                  file);
  return out;
}

}  // namespace motiongan::motion

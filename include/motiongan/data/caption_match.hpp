// Which clip a caption belongs to.
#pragma once
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/data/caption_file.hpp"
#include "motiongan/formats/clip_files.hpp"

namespace motiongan::motion {

/// What captions can call a clip.
struct ClipName {
  std::string id;    ///< for messages
  std::string path;  ///< below the folder of clips, without extension, with /
  std::string name;  ///< file name without extension
};

/// The names of files in `folder`, or of the one file `folder`.
inline std::vector<ClipName> clip_names(std::span<const std::filesystem::path> files,
                                        std::span<const std::string> ids,
                                        const std::filesystem::path& folder) {
  std::vector<ClipName> out;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const std::string stem = clip_stem(files[i]);
    std::filesystem::path below = files[i].lexically_relative(folder);
    const bool is_file = below.empty() || below == ".";
    out.push_back({ids[i], is_file ? stem : without_extension(below).generic_string(), stem});
  }
  return out;
}

/// How captions and clips fitted together.
struct CaptionReport {
  std::string source;                  ///< the captions' file; empty if there were none
  std::vector<std::string> unmatched;  ///< captions of no clip: "'01_99' (line 4)"
  std::vector<std::string> without;    ///< ids of the clips without a caption
};

/// The captions of each clip.
struct CaptionMatch {
  std::vector<std::vector<Caption>> of_clip;  ///< in the order of the clips
  CaptionReport report;
};

namespace caption_detail {

/// An id as written, with / for \ and without a leading ./
inline std::string plain_id(std::string_view id) {
  std::string out(id);
  std::replace(out.begin(), out.end(), '\\', '/');
  while (out.starts_with("./")) out.erase(0, 2);
  return out;
}

/// The id without the extension of a clip.
inline std::string without_clip_ending(const std::string& id) {
  const std::string small = lower(id);
  for (const std::string_view ending : {".bvh", ".csv", ".npy", ".npz", ".txt", ".fbx", ".amc", ".c3d"})
    if (small.ends_with(ending) && small.size() > ending.size())
      return id.substr(0, id.size() - ending.size());
  return id;
}

/// Lines by id, with and without extension.
class LineIndex {
 public:
  void add(const std::string& id, std::size_t line) {
    const std::string bare = without_clip_ending(id);
    lines_[id].push_back(line);
    if (bare != id) lines_[bare].push_back(line);
  }

  const std::vector<std::size_t>* find(const std::string& key) const {
    const auto at = lines_.find(key);
    return at == lines_.end() ? nullptr : &at->second;
  }

 private:
  std::map<std::string, std::vector<std::size_t>> lines_;
};

inline std::string name_of_line(const CaptionLine& line) {
  return line.line == 0 ? concat("'", line.id, "'") : concat("'", line.id, "' (line ", line.line, ")");
}

}  // namespace caption_detail

/// The name of a clip in memory.
inline ClipName clip_name(const std::string& id) {
  return {id, caption_detail::plain_id(id), std::filesystem::path(id).stem().string()};
}

/// Finds the captions of each clip.
///
/// A caption's id is the clip's path below its folder (with / or \) or its file name, either with or without
/// an extension; the path takes precedence, and a file name matches all clips of that name. Captions that
/// match no clip in this way are tried again ignoring case, for clips that have none. Throws Error if no
/// caption matches any clip.
inline CaptionMatch match_captions(const CaptionFile& file, std::span<const ClipName> clips) {
  namespace detail = caption_detail;
  CaptionMatch out;
  out.of_clip.resize(clips.size());
  std::vector<char> matched(file.lines.size(), 0);
  const auto match_all = [&](const detail::LineIndex& index, auto&& key_of) {
    for (std::size_t c = 0; c < clips.size(); ++c) {
      if (!out.of_clip[c].empty()) continue;
      const std::string path = key_of(clips[c].path), name = key_of(clips[c].name);
      const auto* const by_path = index.find(path);
      const auto* const by_name = file.by_path || name == path ? nullptr : index.find(name);
      for (const auto* lines : {by_path, by_name})
        if (lines != nullptr)
          for (const std::size_t line : *lines) matched[line] = 1;
      if (const auto* const lines = by_path != nullptr ? by_path : by_name)
        for (const std::size_t line : *lines) out.of_clip[c].push_back(file.lines[line].caption);
    }
  };
  detail::LineIndex exact, folded;
  for (std::size_t i = 0; i < file.lines.size(); ++i) exact.add(detail::plain_id(file.lines[i].id), i);
  match_all(exact, [](const std::string& key) { return key; });
  for (std::size_t i = 0; i < file.lines.size(); ++i)
    if (matched[i] == 0) folded.add(detail::lower(detail::plain_id(file.lines[i].id)), i);
  match_all(folded, [](const std::string& key) { return detail::lower(key); });

  out.report.source = file.name;
  std::vector<std::string>& unmatched = out.report.unmatched;
  for (std::size_t i = 0; i < file.lines.size(); ++i) {
    if (matched[i] != 0) continue;
    const std::string name = detail::name_of_line(file.lines[i]);
    if (unmatched.empty() || unmatched.back() != name) unmatched.push_back(name);  // a list in JSON: once
  }
  const bool any = std::find(matched.begin(), matched.end(), 1) != matched.end();
  if (!clips.empty() && !file.lines.empty() && !any)
    throw Error(
        file.name, ": no caption matches a clip; the first caption is for ", unmatched.front(),
        ", the first clip is '", clips.front().id,
        "'; expected a clip's file name, or its path below the folder, with or without its extension");
  if (!file.name.empty())
    for (std::size_t c = 0; c < clips.size(); ++c)
      if (out.of_clip[c].empty()) out.report.without.push_back(clips[c].id);
  return out;
}

}  // namespace motiongan::motion

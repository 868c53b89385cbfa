// Captions of clips, from caption files or from file names.
#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "motiongan/core/error.hpp"
#include "motiongan/data/caption_csv.hpp"
#include "motiongan/data/caption_file.hpp"
#include "motiongan/data/caption_json.hpp"
#include "motiongan/data/caption_match.hpp"
#include "motiongan/data/caption_texts.hpp"
#include "motiongan/data/vocabulary.hpp"
#include "motiongan/formats/clip_files.hpp"
#include "motiongan/formats/text_file.hpp"

namespace motiongan::motion {

/// Reads a caption file: .csv (parse_caption_csv), .json (parse_caption_json), or else lines of
/// `clip id <TAB> description`; or a folder of .txt files (read_caption_folder). Throws Error if it cannot be
/// read, and as `name:line: ...`.
inline CaptionFile read_caption_file(const std::filesystem::path& path) {
  std::error_code problem;
  if (std::filesystem::is_directory(path, problem)) return read_caption_folder(path);
  const std::string text = read_text(path, "caption file", largest_list_file), extension = extension_of(path);
  return extension == ".csv"    ? parse_caption_csv(text, path.string())
         : extension == ".json" ? parse_caption_json(text, path.string())
                                : parse_caption_lines(text, path.string());
}

/// The captions of `files`, called `names`: those in the file or folder `given`, or, if that is empty, in
/// .txt files beside the clips. Throws Error as read_caption_file and match_captions do.
inline CaptionMatch find_captions(const std::filesystem::path& given,
                                  std::span<const std::filesystem::path> files,
                                  std::span<const ClipName> names) {
  return match_captions(given.empty() ? read_captions_beside(files, names) : read_caption_file(given), names);
}

/// The captions of whole clips, by id as written; captions of parts are left out.
inline Captions captions_by_id(const CaptionFile& file) {
  Captions out;
  for (const CaptionLine& line : file.lines)
    if (!line.caption.part) out[line.id].push_back(line.caption.text);
  return out;
}

/// Captions by id, from lines of `clip id <TAB> description` (parse_caption_lines).
inline Captions parse_captions(std::string_view text, std::string_view name) {
  return captions_by_id(parse_caption_lines(text, name));
}

/// Captions of whole clips by id, from any file that read_caption_file reads.
inline Captions read_captions(const std::filesystem::path& path) {
  return captions_by_id(read_caption_file(path));
}

/// A caption for a clip without one: the words of its file name, without digits
/// (`dataset-1_walk_happy_001.bvh`: "dataset walk happy"); if there are none, the words of its folder's name,
/// else "motion".
inline std::string caption_from_name(const std::filesystem::path& path) {
  std::string letters = path.stem().string();
  for (char& c : letters)
    if (c >= '0' && c <= '9') c = ' ';
  std::string out;
  for (const std::string& word : split_words(letters)) out += (out.empty() ? "" : " ") + word;
  if (!out.empty()) return out;
  for (const std::string& word : split_words(path.parent_path().filename().string()))
    out += (out.empty() ? "" : " ") + word;
  return out.empty() ? "motion" : out;
}

}  // namespace motiongan::motion

// Which files of a folder are clips, and what the clips are called.
#pragma once
#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/formats/text_file.hpp"

namespace motiongan::motion {

/// The extension in lower case: ".bvh".
inline std::string extension_of(const std::filesystem::path& file) {
  std::string text = file.extension().string();
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  const std::size_t mark = text.find('#');  // of an animation, see ClipPath
  return text.substr(0, mark);
}

/// A clip among several in a file: "moves.glb#walk" is the animation "walk" of "moves.glb".
struct ClipPath {
  std::filesystem::path file;
  std::string animation;  ///< empty: the file's only one, or its first

  explicit ClipPath(const std::filesystem::path& path) : file(path) {
    const std::string name = path.filename().string(), last = path.extension().string();
    const std::size_t mark = last.find('#');
    if (mark == std::string::npos || mark < 2) return;
    animation = last.substr(mark + 1);
    file = path.parent_path() / name.substr(0, name.size() - last.size() + mark);
  }
};

/// The path of a clip without its extension, with `_` before the name of an animation: "01/moves_walk".
inline std::filesystem::path without_extension(const std::filesystem::path& path) {
  const ClipPath clip(path);
  std::filesystem::path out = clip.file;
  out.replace_extension();
  if (!clip.animation.empty()) out += "_" + clip.animation;
  return out;
}

/// The name of a clip: its file's name without extension.
inline std::string clip_stem(const std::filesystem::path& path) {
  return without_extension(path.filename()).string();
}

/// All files with one of the extensions (".bvh", in any case) in a folder and its subfolders, sorted, except
/// those in `without`; or the file itself. Hidden files and folders, which start with a dot, are left out; so
/// are the `._name` files that macOS puts next to files. Dead links, pipes and empty files are listed, for a
/// reader to name them. Throws Error if there are none.
inline std::vector<std::filesystem::path> find_clip_files(
    const std::filesystem::path& where, const std::vector<std::string_view>& extensions = {".bvh"},
    const std::vector<std::filesystem::path>& without = {}) {
  namespace fs = std::filesystem;
  std::string kinds;
  for (std::size_t i = 0; i < extensions.size(); ++i)
    kinds += concat(i == 0 ? "" : i + 1 < extensions.size() ? ", " : " or ", extensions[i]);
  std::error_code problem;
  if (!fs::exists(where, problem))
    throw Error(where.string(), " ", why_missing(where), "; give a ", kinds, " file or a folder of them");
  if (!fs::is_directory(where, problem)) return {where};
  std::vector<fs::path> out;
  std::size_t hidden = 0;  // files
  fs::recursive_directory_iterator entries(where, fs::directory_options::skip_permission_denied, problem);
  for (; !problem && entries != fs::recursive_directory_iterator(); entries.increment(problem)) {
    const fs::path& file = entries->path();
    std::error_code ignored;
    const bool is_folder = entries->is_directory(ignored), is_hidden = file.filename().string()[0] == '.';
    if (is_folder) {
      if (is_hidden) entries.disable_recursion_pending();
      continue;
    }
    const bool is_clip =
        std::find(extensions.begin(), extensions.end(), extension_of(file)) != extensions.end();
    const bool left_out = std::any_of(without.begin(), without.end(), [&](const fs::path& other) {
      return !other.empty() && fs::equivalent(file, other, ignored);
    });
    if (!is_clip || left_out) continue;
    if (is_hidden)
      ++hidden;
    else
      out.push_back(file);
  }
  require(!problem, "folder ", where.string(), " cannot be read: ", problem.message());
  require(!out.empty(), "folder ", where.string(), " and its subfolders have no ", kinds, " file",
          hidden > 0 ? " (hidden files, which start with a dot, are not read)" : "");
  std::sort(out.begin(), out.end());
  return out;
}

/// Ids of the files: file names without extension or, where two files share a name, paths below `folder`
/// without extension (`01/walk`).
inline std::vector<std::string> clip_ids(const std::vector<std::filesystem::path>& files,
                                         const std::filesystem::path& folder) {
  std::map<std::string, int> uses;
  for (const auto& file : files) ++uses[clip_stem(file)];
  std::vector<std::string> ids;
  for (const auto& file : files) {
    const std::string stem = clip_stem(file);
    ids.push_back(uses[stem] > 1 ? without_extension(file.lexically_relative(folder)).generic_string()
                                 : stem);
  }
  return ids;
}

}  // namespace motiongan::motion

// Outputs never replace inputs: checks of the files that options name, before any work is done.
#pragma once
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/formats/clip_files.hpp"
#include "motiongan/formats/position_files.hpp"

namespace motiongan::command {

/// What an option writes, by the endings of such files.
struct OutputKind {
  std::string_view name;  ///< for messages: "HTML page"
  std::vector<std::string_view> endings;
};
inline const OutputKind page_output{"an HTML page", {".html", ".htm"}}, picture_output{"a picture", {".png"}},
    table_output{"a table", {".csv", ".tsv", ".txt"}}, json_output{"JSON", {".json"}},
    glb_output{"glTF", {".glb"}};

namespace output_detail {

/// Whether a file in a folder of clips is a clip, a model, or says something of the clips.
inline bool is_data(const std::filesystem::path& file) {
  const std::string ending = motion::extension_of(file), name = file.filename().string();
  for (const std::string_view data :
       {".bvh", ".amc", ".asf", ".npz", ".npy", ".glb", ".vrm", ".vrma", ".fbx", ".safetensors"})
    if (ending == data) return true;
  for (const std::string_view list :
       {"captions.tsv", "captions.csv", "captions.json", "labels.tsv", "bones.tsv", "split.tsv", "log.csv"})
    if (name == list) return true;
  if (ending != ".csv") return false;
  std::ifstream in(file, std::ios::binary);
  std::string head(65536, '\0');
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(in.gcount()));
  return motion::is_position_csv(head);
}

/// Whether `output` is the file `input`, under this or another name, or one of the data in the folder
/// `input`.
inline bool replaces(const std::filesystem::path& output, const std::filesystem::path& input_path) {
  namespace fs = std::filesystem;
  std::error_code problem;
  const fs::path input = motion::ClipPath(input_path).file;
  if (input.empty() || !fs::is_regular_file(output, problem)) return false;
  if (fs::equivalent(output, input, problem)) return true;
  if (!fs::is_directory(input, problem)) return false;
  const fs::path below =
      fs::weakly_canonical(output, problem).lexically_relative(fs::weakly_canonical(input, problem));
  return !below.empty() && *below.begin() != ".." && is_data(output);
}

}  // namespace output_detail

/// Throws Error if one of the files, which `option` writes, is one of `inputs` (files, or folders of clips),
/// or is there twice, so that one clip would replace another.
inline void check_outputs(std::string_view option, const std::vector<std::filesystem::path>& files,
                          const std::vector<std::filesystem::path>& inputs) {
  std::set<std::filesystem::path> names;
  for (const auto& file : files)
    require(names.insert(file).second, option, ": two clips would be written as ", file.string(),
            "; give them by the folder that contains both, or write them to different folders");
  for (const auto& file : files)
    for (const auto& input : inputs)
      require(!output_detail::replaces(file, input), option, ": ", file.string(),
              " is an input and would be replaced; choose another place or name");
}

/// Checks the file that `option` names; empty: none. A device or a pipe, such as /dev/stdout, is written as
/// it is. Throws Error if it is a folder, has the ending of another kind of file, which is probably an input,
/// or is one of `inputs` (see check_outputs).
inline void check_output(std::string_view option, const std::filesystem::path& file, const OutputKind& kind,
                         const std::vector<std::filesystem::path>& inputs) {
  if (file.empty()) return;
  std::error_code problem;
  using enum std::filesystem::file_type;
  const std::filesystem::file_type there = std::filesystem::status(file, problem).type();
  require(there != directory, option, " ", file.string(), " is a folder, expected the name of a file");
  require(there == regular || there == not_found || there == character || there == fifo, option, " ",
          file.string(), " cannot be reached or written, expected the name of a file");
  const std::string ending = motion::extension_of(file);
  const auto is_ending = [&](std::string_view known) { return known == ending; };
  for (const std::string_view known :
       {".bvh", ".amc", ".asf", ".npz", ".npy", ".safetensors", ".csv", ".tsv", ".txt", ".json", ".html",
        ".htm", ".png", ".glb", ".vrm", ".vrma", ".fbx"})
    require(known != ending || std::any_of(kind.endings.begin(), kind.endings.end(), is_ending), option, " ",
            file.string(), " would be ", kind.name, ", which cannot end in ", ending, "; use ",
            kind.endings.front(), ", and give input files before the option");
  check_outputs(option, {file}, inputs);
}

/// Throws Error if the folder that `option` names is one of `inputs`.
inline void check_output_folder(std::string_view option, const std::filesystem::path& folder,
                                const std::vector<std::filesystem::path>& inputs) {
  std::error_code problem;
  for (const auto& input : inputs)
    require(folder.empty() || input.empty() || !std::filesystem::equivalent(folder, input, problem), option,
            " ", folder.string(), " is an input; choose another folder");
}

/// Throws Error if the list `file`, which the command writes beside clips, exists and does not begin with
/// `first_line`: then somebody else wrote it.
inline void check_own_list(const std::filesystem::path& file, std::string_view first_line) {
  std::error_code problem;
  if (!std::filesystem::exists(file, problem)) return;
  require(motion::read_text(file, "list", motion::largest_list_file).starts_with(first_line), file.string(),
          " exists, was not written by this command and would be replaced; choose another folder");
}

/// One list of several.
inline std::vector<std::filesystem::path> inputs_of(const std::vector<std::string>& first,
                                                    const std::vector<std::string>& second = {}) {
  std::vector<std::filesystem::path> out(first.begin(), first.end());
  out.insert(out.end(), second.begin(), second.end());
  return out;
}

}  // namespace motiongan::command

// Trained models that come with motiongan, found by name: "cmu-text".
#pragma once
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/core/os.hpp"
#include "motiongan/io/sha256.hpp"

namespace motiongan {

/// A model in one of the model_folders().
struct ShippedModel {
  std::string name;            ///< the file's name without ".safetensors"
  std::filesystem::path file;  ///< where it is
  std::string sha256;          ///< of the file as it was published, 64 hexadecimal digits
};

/// The file in a folder of models that lists them, in the form of `sha256sum`: a SHA-256, two spaces and a
/// file's name on each line.
inline constexpr std::string_view shipped_list = "SHA256SUMS";

/// The folders that are searched for models: those of the environment variable MOTIONGAN_MODELS, which are
/// separated by colons; `models` beside the running program, and beside the shared library that this is
/// compiled into; share/motiongan/models where the program, or this library, is installed; and the same in
/// /usr/local and /usr.
inline std::vector<std::filesystem::path> model_folders() {
  std::vector<std::filesystem::path> out;
  if (const char* given = std::getenv("MOTIONGAN_MODELS")) {
    std::istringstream folders(given);
    for (std::string folder; std::getline(folders, folder, ':');)
      if (!folder.empty()) out.emplace_back(folder);
  }
  const std::filesystem::path share = std::filesystem::path("share") / "motiongan" / "models";
  if (const std::filesystem::path program = os::program_path(); !program.empty()) {
    out.push_back(program.parent_path() / "models");
    out.push_back(program.parent_path().parent_path() / share);
  }
  if (const std::filesystem::path module = os::module_path(); module.has_parent_path())
    out.push_back(module.parent_path() / "models");
#ifdef MOTIONGAN_MODELS_FOLDER  // where it is installed, from CMake
  out.emplace_back(MOTIONGAN_MODELS_FOLDER);
#endif
  out.push_back("/usr/local" / share);
  out.push_back("/usr" / share);
  return out;
}

/// The models that the lists of all model_folders() name, by name. Of two of one name the first is kept, in
/// the order of the folders. A line that is not of the list's form throws Error as `file:line: ...`.
inline std::vector<ShippedModel> shipped_models() {
  std::vector<ShippedModel> out;
  for (const std::filesystem::path& folder : model_folders()) {
    const std::filesystem::path list = folder / shipped_list;
    std::ifstream in(list);
    std::size_t number = 0;
    for (std::string line; std::getline(in, line);) {
      ++number;
      if (line.empty()) continue;
      const std::filesystem::path file = line.size() > 66 ? line.substr(66) : "";
      require(line.find_first_not_of("0123456789abcdef") == 64 && line.substr(64, 2) == "  " &&
                  file.extension() == ".safetensors" && !file.has_parent_path(),
              list.string(), ":", number, ": found \"", line.substr(0, 100),
              "\", expected a SHA-256, two spaces and the name of a .safetensors file, as sha256sum writes");
      const std::string name = file.stem().string();
      if (std::none_of(out.begin(), out.end(), [&](const ShippedModel& m) { return m.name == name; }))
        out.push_back({name, folder / file, line.substr(0, 64)});
    }
  }
  std::sort(out.begin(), out.end(),
            [](const ShippedModel& a, const ShippedModel& b) { return a.name < b.name; });
  return out;
}

/// Throws Error unless the model's file is there and is the one that was published.
inline void check_shipped(const ShippedModel& model) {
  std::error_code problem;
  require(std::filesystem::is_regular_file(model.file, problem), model.file.string(), ": the model \"",
          model.name, "\" is listed in ", shipped_list, " but is not there; install it again");
  const std::string found = io::sha256_of(model.file);
  require(found == model.sha256, model.file.string(), ": the SHA-256 is ", found, ", expected ", model.sha256,
          " as listed in ", shipped_list, "; the file is damaged or not the one that was published");
}

/// What `given` names: a file or folder of this path, or else, if it is a bare name without an extension, the
/// file of the shipped model of that name, whose SHA-256 is checked. Throws Error for a name of neither; a
/// path is returned as it is.
inline std::filesystem::path find_model(const std::filesystem::path& given) {
  std::error_code problem;
  if (given.empty() || given.has_parent_path() || given.has_extension() ||
      std::filesystem::exists(given, problem))
    return given;
  std::string names;
  for (const ShippedModel& model : shipped_models()) {
    if (model.name == given) {
      check_shipped(model);
      return model.file;
    }
    names += (names.empty() ? "" : ", ") + model.name;
  }
  throw Error("there is no file or folder \"", given.string(), "\", and no shipped model of that name; ",
              names.empty() ? "no models are installed (MOTIONGAN_MODELS names their folder)"
                            : "the shipped models are " + names);
}

}  // namespace motiongan

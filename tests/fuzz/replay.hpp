// Runs every target of a program over its seeds and regression inputs, as an ordinary test.
#pragma once
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "target.hpp"

namespace motiongan::fuzz {

/// The files in tests/fuzz/KIND/NAME, sorted; none if there is no such folder.
inline std::vector<std::filesystem::path> inputs_of(const Target& target, const char* kind) {
  const auto folder = std::filesystem::path(MOTIONGAN_SOURCE_DIR) / "tests" / "fuzz" / kind / target.name;
  std::vector<std::filesystem::path> files;
  if (std::filesystem::is_directory(folder))
    for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

inline std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Runs the target over the files; the number of those that it accepts.
inline std::size_t replay(const Target& target, const char* kind) {
  std::size_t accepted = 0;
  for (const std::filesystem::path& file : inputs_of(target, kind)) {
    INFO(file.string());
    try {
      accepted += accepts(target, bytes_of(file));
    } catch (const std::exception& error) {
      FAIL_CHECK(std::string(error.what()));
    }
  }
  return accepted;
}

/// All targets over all of their files. At least one seed must be accepted, or the target tests only the
/// first lines of its parser.
inline void replay_all() {
  for (const Target* const target : Target::all()) {
    INFO(std::string(target->name));
    CHECK_GE(replay(*target, "corpus"), 1);
    replay(*target, "regressions");
  }
}

}  // namespace motiongan::fuzz

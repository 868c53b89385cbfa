// Folders in tests.
#pragma once
#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

namespace motiongan::testing {

/// A new temporary folder, removed at the end of the test.
struct Scratch {
  std::filesystem::path path;
  Scratch() {
    std::string name = (std::filesystem::temp_directory_path() / "motiongan-test-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) std::abort();
    path = name;
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
};

/// Whether `folder` holds a file that somebody began to write and neither finished nor removed.
inline bool has_unfinished(const std::filesystem::path& folder) {
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.path().extension() == ".tmp") return true;
  return false;
}

}  // namespace motiongan::testing

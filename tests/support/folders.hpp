// Folders in tests.
#pragma once
#include <filesystem>

namespace motiongan::testing {

/// Whether `folder` holds a file that somebody began to write and neither finished nor removed.
inline bool has_unfinished(const std::filesystem::path& folder) {
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.path().extension() == ".tmp") return true;
  return false;
}

}  // namespace motiongan::testing

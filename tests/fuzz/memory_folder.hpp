// A folder in memory, for parsers that take a path.
#pragma once
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>

namespace motiongan::fuzz {

/// A folder of its own in /dev/shm, or among the temporary files, which is removed at the end.
class MemoryFolder {
 public:
  MemoryFolder() {
    const bool memory = ::access("/dev/shm", W_OK) == 0;
    std::string name =
        (memory ? "/dev/shm" : std::filesystem::temp_directory_path().string()) + "/motiongan-fuzz-XXXXXX";
    if (::mkdtemp(name.data()) == nullptr) std::abort();
    path_ = name;
  }
  MemoryFolder(const MemoryFolder&) = delete;
  MemoryFolder& operator=(const MemoryFolder&) = delete;
  ~MemoryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

  const std::filesystem::path& path() const { return path_; }

  /// Writes a file and returns its path.
  std::filesystem::path write(const std::string& name, std::string_view bytes) const {
    const std::filesystem::path file = path_ / name;
    std::ofstream out(file, std::ios::binary | std::ios::trunc);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    out.close();
    if (!out) std::abort();
    return file;
  }

 private:
  std::filesystem::path path_;
};

/// The one folder of the program. All targets of a test program share it, so none writes a file that readers
/// look for beside another one, such as bones.tsv.
inline const MemoryFolder& memory_folder() {
  static const MemoryFolder folder;
  return folder;
}

}  // namespace motiongan::fuzz

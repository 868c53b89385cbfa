// Compiled kernels kept on disk, for drivers that would compile them anew in every process.
#pragma once
#include <zlib.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <system_error>

#include "motiongan/core/device.hpp"
#include "motiongan/core/error.hpp"
#include "motiongan/core/os.hpp"

namespace motiongan::detail {

/// A folder with the binaries of programs: MOTIONGAN_CACHE_DIR (empty: none), else
/// $XDG_CACHE_HOME/motiongan or ~/.cache/motiongan. PoCL keeps its own, and Oclgrind's heap is damaged by
/// programs from binaries. What cannot be read or written is as if it were not there: the kernels are then
/// compiled.
class KernelCache {
 public:
  explicit KernelCache(const Device& device) {
    if (is_pocl(device.platform_name) || device.platform_name == "Oclgrind") return;
    folder_ = chosen_folder();
    if (folder_.empty()) return;
    std::string driver;
    try {
      driver = device_string(device.id, CL_DRIVER_VERSION);
    } catch (const DeviceError&) {
      folder_.clear();  // another version's binaries could not be told from this one's
    }
    device_ = concat("motiongan kernels 1\n", device.platform_name, "\n", device.name, "\n", device.version,
                     "\n", driver, "\n");
  }

  explicit operator bool() const { return !folder_.empty(); }

  /// The binary kept for this source, compiled with these options on this device; empty if there is none.
  std::string find(std::string_view options, std::string_view source) const {
    const std::string key = key_of(options, source);
    std::ifstream in(path_of(key), std::ios::binary);
    std::string file((std::istreambuf_iterator<char>(in)), {});
    if (file.size() < key.size() + checksum_size || !file.starts_with(key)) return {};
    const std::string binary = file.substr(key.size() + checksum_size);
    return file.substr(key.size(), checksum_size) == checksum(binary) ? binary : std::string();
  }

  void keep(std::string_view options, std::string_view source, const std::string& binary) const {
    std::error_code ignored;
    std::filesystem::create_directories(folder_, ignored);
    const std::string key = key_of(options, source);
    const std::filesystem::path path = path_of(key),
                                beside = path.string() + concat(".", os::process_id(), ".tmp");
    const os::FileHandle file = os::create_file(beside);
    if (file < 0) return;
    const std::string text = key + checksum(binary) + binary;
    const bool written = os::write_all(file, text.data(), text.size());
    if (!os::close_file(file) || !written || !os::replace_file(beside, path)) os::remove_file(beside);
  }

 private:
  static constexpr std::size_t checksum_size = 11;

  static std::filesystem::path chosen_folder() {
    if (const char* chosen = std::getenv("MOTIONGAN_CACHE_DIR")) return chosen;
    if (const char* caches = std::getenv("XDG_CACHE_HOME"); caches && *caches)
      return std::filesystem::path(caches) / "motiongan";
    if (const char* home = std::getenv("HOME"); home && *home)
      return std::filesystem::path(home) / ".cache" / "motiongan";
    return {};
  }

  /// All that a binary depends on. A file begins with it, so that no other program's is ever taken.
  std::string key_of(std::string_view options, std::string_view source) const {
    return concat(device_, options, "\n", source);
  }

  std::filesystem::path path_of(const std::string& key) const {
    std::uint64_t hash = 14695981039346656037u;  // FNV-1a
    for (const char c : key) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211u;
    return folder_ / concat(hash, ".clbin");
  }

  static std::string checksum(const std::string& binary) {
    const auto value = ::crc32_z(0, reinterpret_cast<const Bytef*>(binary.data()), binary.size());
    std::string out = std::to_string(value);  // at most ten digits
    out.resize(checksum_size, '\n');
    return out;
  }

  std::filesystem::path folder_;
  std::string device_;
};

}  // namespace motiongan::detail

// Reading whole text files, writing them atomically, and UTF-8 validation.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>

#include "motiongan/core/error.hpp"
#include "motiongan/io/atomic_file.hpp"

namespace motiongan::motion {

/// Why a path that does not lead to a file does not: "is a dead link (to x.bvh)", "does not exist", or
/// "cannot be reached: Permission denied".
inline std::string why_missing(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  std::error_code problem, ignored;
  const bool found = fs::status(path, problem).type() != fs::file_type::not_found;  // but out of reach
  if (!found && fs::is_symlink(fs::symlink_status(path, ignored)))
    return concat("is a dead link (to ", fs::read_symlink(path, ignored).string(), ")");
  if (found) return concat("cannot be reached: ", problem.message());
  return "does not exist";
}

/// Bytes that no file of motion has, and no list of captions, labels or joints: larger ones are refused
/// before they are read.
/// \{
inline constexpr std::uint64_t largest_text_file = std::uint64_t{4} << 30;
inline constexpr std::uint64_t largest_list_file = std::uint64_t{256} << 20;
/// \}

/// Throws Error unless `path` leads to a regular file: opening a pipe or reading a device might never end.
/// `kind` is what messages call it, such as "BVH file".
inline void require_regular_file(const std::filesystem::path& path, std::string_view kind) {
  namespace fs = std::filesystem;
  std::error_code problem;
  const fs::file_type type = fs::status(path, problem).type();
  if (type == fs::file_type::regular) return;
  if (problem || type == fs::file_type::not_found)
    throw Error(kind, " ", path.string(), " ", why_missing(path));
  require(type != fs::file_type::directory, path.string(), " is a folder, expected a ", kind);
  throw Error(kind, " ", path.string(), " is ",
              type == fs::file_type::fifo     ? "a named pipe"
              : type == fs::file_type::socket ? "a socket"
                                              : "a device",
              ", expected a regular file; copy its contents to one");
}

/// The bytes of a file. `kind` is what messages call it, such as "BVH file". Throws Error if it cannot be
/// read, is not a regular file, or has more than `most` bytes.
inline std::string read_text(const std::filesystem::path& path, std::string_view kind,
                             std::uint64_t most = largest_text_file) {
  require_regular_file(path, kind);
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  require(in.good(), kind, " ", path.string(), " cannot be opened; is it readable?");
  const auto size = static_cast<std::uint64_t>(std::max<std::streamoff>(in.tellg(), 0));
  require(size <= most, kind, " ", path.string(), " has ", size, " bytes, expected at most ", most,
          "; is it the right file?");
  std::string text(size, '\0');
  in.seekg(0);
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  require(static_cast<std::size_t>(in.gcount()) == text.size(), kind, " ", path.string(),
          " could not be read completely");
  return text;
}

/// Writes `text` next to `path` and renames it, so that `path` never holds a partial file. Throws Error if
/// that fails.
inline void write_text_atomically(const std::filesystem::path& path, std::string_view text) {
  io::AtomicFile file(path);
  file.write(text);
  file.commit(io::AtomicFile::Sync::no);  // one call for each of thousands of clips
}

/// Whether the bytes are well-formed UTF-8.
inline bool is_utf8(std::string_view text) {
  const auto byte = [&](std::size_t at) {
    return at < text.size() ? static_cast<unsigned char>(text[at]) : 0u;
  };
  for (std::size_t i = 0; i < text.size();) {
    const unsigned lead = byte(i);
    const std::size_t n = lead < 0x80                   ? 1
                          : lead >= 0xC2 && lead < 0xE0 ? 2
                          : lead >= 0xE0 && lead < 0xF0 ? 3
                          : lead >= 0xF0 && lead < 0xF5 ? 4
                                                        : 0;
    if (n == 0) return false;
    for (std::size_t k = 1; k < n; ++k)
      if ((byte(i + k) & 0xC0u) != 0x80u) return false;
    // Overlong forms, surrogates and values past U+10FFFF are visible in the second byte.
    const unsigned second = byte(i + 1);
    if ((lead == 0xE0 && second < 0xA0) || (lead == 0xED && second > 0x9F) ||
        (lead == 0xF0 && second < 0x90) || (lead == 0xF4 && second > 0x8F))
      return false;
    i += n;
  }
  return true;
}

}  // namespace motiongan::motion

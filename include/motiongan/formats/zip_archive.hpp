// Reading entries of a ZIP archive that is in memory (PKWARE APPNOTE 6.3), stored or deflated.
#pragma once
#include <zlib.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/io/checksum.hpp"

namespace motiongan::motion {

/// An entry of a ZIP archive.
struct ZipEntry {
  std::string_view name;
  unsigned flags = 0, method = 0;
  std::uint32_t crc = 0;
  std::size_t packed = 0;  ///< bytes in the archive
  std::size_t size = 0;    ///< bytes after decompression
  std::size_t header = 0;  ///< offset of the entry's header in the archive
};

/// A ZIP archive. The directory is checked when it is read, an entry's sizes and checksum when the entry is
/// read, so that a damaged or hostile file gives an Error and never an allocation that it cannot fill. ZIP64
/// archives (4 GiB and more), archives in several parts and encrypted entries are not supported.
class ZipArchive {
 public:
  /// Refers to `bytes`, which must live as long as the archive. `name` prefixes messages. Throws Error if
  /// this is not a ZIP archive.
  ZipArchive(std::string_view bytes, std::string name) : bytes_(bytes), name_(std::move(name)) {
    const std::size_t end = find_end();
    const std::size_t count = number(end + 10, 2), size = number(end + 12, 4), start = number(end + 16, 4);
    require(number(end + 4, 2) == 0 && number(end + 6, 2) == 0 && number(end + 8, 2) == count, name_,
            ": the ZIP archive is in several parts, expected one file");
    require(count != 0xFFFF && start != 0xFFFFFFFF, name_, ": a ZIP64 archive, which is not supported");
    require(start <= end && size <= end - start, name_, ": the ZIP directory has ", size, " bytes at ", start,
            ", but ends before ", end, "; the file is damaged");
    for (std::size_t i = 0, at = start; i < count; ++i) at = read_entry(at, start + size);
  }

  const std::vector<ZipEntry>& entries() const { return entries_; }

  /// The entry of this name; null if there is none.
  const ZipEntry* find(std::string_view name) const {
    for (const ZipEntry& entry : entries_)
      if (entry.name == name) return &entry;
    return nullptr;
  }

  /// The decompressed bytes of an entry of this archive. Throws Error if they are damaged, encrypted or
  /// compressed by a method other than deflate.
  std::string read(const ZipEntry& entry) const {
    require((entry.flags & 1u) == 0, name_, ": '", entry.name, "' is encrypted, expected a plain archive");
    require(entry.method == 0 || entry.method == 8, name_, ": '", entry.name, "' is compressed by method ",
            entry.method, ", expected 0 (stored) or 8 (deflated)");
    const std::string_view packed = packed_bytes(entry);
    std::string out = entry.method == 0 ? std::string(packed) : inflated(entry, packed);
    require(out.size() == entry.size && checksum(out) == entry.crc, name_, ": '", entry.name,
            "' does not match its size or checksum; the file is damaged");
    return out;
  }

 private:
  /// The little-endian number of `size` bytes at `at`, which must be inside the file.
  std::size_t number(std::size_t at, std::size_t size) const {
    std::size_t out = 0;
    for (std::size_t i = size; i-- > 0;) out = out << 8 | static_cast<unsigned char>(bytes_[at + i]);
    return out;
  }

  /// The end-of-directory record: the last one, because a comment may follow it.
  std::size_t find_end() const {
    constexpr std::size_t record = 22, longest_comment = 0xFFFF;
    const std::size_t last = bytes_.size() >= record ? bytes_.size() - record : 0;
    for (std::size_t back = 0; bytes_.size() >= record && back <= last && back <= longest_comment; ++back)
      if (bytes_.substr(last - back, 4) == "PK\5\6" && number(last - back + 20, 2) <= back)
        return last - back;
    throw Error(name_, ": not a ZIP archive, or truncated: it has no ZIP directory");
  }

  /// Reads the directory's entry at `at`; returns where the next one begins.
  std::size_t read_entry(std::size_t at, std::size_t end) {
    constexpr std::size_t fixed = 46;
    require(end - at >= fixed && bytes_.substr(at, 4) == "PK\1\2", name_, ": the ZIP directory ends after ",
            entries_.size(), " entries, expected more; the file is damaged");
    const std::size_t name = number(at + 28, 2), extra = number(at + 30, 2), comment = number(at + 32, 2);
    require(name + extra + comment <= end - at - fixed, name_, ": entry ", entries_.size() + 1,
            " of the ZIP directory runs past its end; the file is damaged");
    ZipEntry entry;
    entry.name = bytes_.substr(at + fixed, name);
    entry.flags = static_cast<unsigned>(number(at + 8, 2));
    entry.method = static_cast<unsigned>(number(at + 10, 2));
    entry.crc = static_cast<std::uint32_t>(number(at + 16, 4));
    entry.packed = number(at + 20, 4);
    entry.size = number(at + 24, 4);
    entry.header = number(at + 42, 4);
    require(entry.packed != 0xFFFFFFFF && entry.size != 0xFFFFFFFF && entry.header != 0xFFFFFFFF, name_,
            ": '", entry.name, "' is a ZIP64 entry, which is not supported");
    entries_.push_back(entry);
    return at + fixed + name + extra + comment;
  }

  std::string_view packed_bytes(const ZipEntry& entry) const {
    constexpr std::size_t fixed = 30;
    require(entry.header <= bytes_.size() && bytes_.size() - entry.header >= fixed &&
                bytes_.substr(entry.header, 4) == "PK\3\4",
            name_, ": '", entry.name, "' has no header where the ZIP directory says; the file is damaged");
    // The name and the extra field of this header may differ from the directory's.
    const std::size_t skip = fixed + number(entry.header + 26, 2) + number(entry.header + 28, 2);
    const std::size_t left = bytes_.size() - entry.header;
    require(skip <= left && entry.packed <= left - skip, name_, ": '", entry.name, "' has ", entry.packed,
            " bytes, but the file ends before them; the file is truncated");
    return bytes_.substr(entry.header + skip, entry.packed);
  }

  std::string inflated(const ZipEntry& entry, std::string_view packed) const {
    // Deflate makes at most 1032 bytes of one, so a directory that announces more is wrong.
    require(entry.size / 1032 <= packed.size(), name_, ": '", entry.name, "' would have ", entry.size,
            " bytes decompressed from ", packed.size(), "; the file is damaged");
    std::string out(entry.size, '\0');
    z_stream stream{};
    require(inflateInit2(&stream, -MAX_WBITS) == Z_OK, name_, ": zlib could not start");
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));  // zlib only reads it
    stream.avail_in = static_cast<uInt>(packed.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    const int result = inflate(&stream, Z_FINISH);
    const bool whole = result == Z_STREAM_END && stream.avail_out == 0;
    inflateEnd(&stream);
    require(whole, name_, ": '", entry.name, "' cannot be decompressed to ", entry.size,
            " bytes; the file is damaged");
    return out;
  }

  static std::uint32_t checksum(std::string_view bytes) {
    io::Checksum sum;
    sum.add(bytes.data(), bytes.size());
    return sum.value();
  }

  std::string_view bytes_;
  std::string name_;
  std::vector<ZipEntry> entries_;
};

}  // namespace motiongan::motion

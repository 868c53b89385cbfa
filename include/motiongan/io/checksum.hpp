// CRC-32 of a sequence of texts and blocks of data: tells a damaged file from a whole one.
#pragma once
#include <zlib.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace motiongan::io {

/// The CRC-32 (as in zip and PNG) of all that is added. Every change of up to 32 neighbouring bits changes
/// it.
class Checksum {
 public:
  /// Takes in more bytes.
  void add(const void* bytes, std::size_t size) {
    if (size == 0) return;  // a null pointer would reset the sum
    value_ = ::crc32_z(value_, static_cast<const Bytef*>(bytes), size);
  }
  /// A text and a zero byte, so that texts added one after the other keep their limits.
  void add(std::string_view text) {
    add(text.data(), text.size());
    add("", 1);
  }

  /// The CRC-32 of all bytes so far.
  std::uint32_t value() const { return static_cast<std::uint32_t>(value_); }

  /// Eight hexadecimal digits.
  std::string text() const {
    std::string out;
    for (int shift = 28; shift >= 0; shift -= 4) out += "0123456789abcdef"[(value() >> shift) & 15];
    return out;
  }

 private:
  uLong value_ = 0;
};

}  // namespace motiongan::io

// NumPy arrays and ZIP archives as bytes, for tests of readers.
#pragma once
#include <zlib.h>

#include <bit>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

namespace motiongan::testing {

/// `size` bytes of a number, little-endian.
inline std::string little(std::uint64_t value, std::size_t size) {
  std::string out(size, '\0');
  for (std::size_t i = 0; i < size && i < 8; ++i)
    out[i] = static_cast<char>(static_cast<unsigned char>(value >> (8 * i)));
  return out;
}

/// An .npy file, version 1, of the type `descr` and a shape as Python writes it; `data` are its numbers.
inline std::string npy_file(const std::string& descr, const std::string& shape, const std::string& data,
                            bool fortran = false) {
  const std::string header = "{'descr': '" + descr + "', 'fortran_order': " + (fortran ? "True" : "False") +
                             ", 'shape': " + shape + ", }\n";
  return std::string("\x93NUMPY\x01\x00", 8) + little(header.size(), 2) + header + data;
}

inline std::string doubles(const std::vector<double>& values) {
  std::string out;
  for (const double v : values) out += little(std::bit_cast<std::uint64_t>(v), 8);
  return out;
}

inline std::string floats(const std::vector<double>& values) {
  std::string out;
  for (const double v : values) out += little(std::bit_cast<std::uint32_t>(static_cast<float>(v)), 4);
  return out;
}

/// Raw deflate, by zlib.
inline std::string deflated(const std::string& data) {
  z_stream stream{};
  if (deflateInit2(&stream, 9, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY) != Z_OK) std::abort();
  std::string out(deflateBound(&stream, data.size()), '\0');
  std::string in = data;
  stream.next_in = reinterpret_cast<Bytef*>(in.data());
  stream.avail_in = static_cast<uInt>(in.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  if (deflate(&stream, Z_FINISH) != Z_STREAM_END) std::abort();
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

struct ZipPart {
  std::string name, data;
};

/// A ZIP archive as numpy.savez (stored) or numpy.savez_compressed (deflated) lays it out: the local headers
/// have a ZIP64 extra field, the directory does not.
inline std::string zip_file(const std::vector<ZipPart>& parts, bool compress) {
  std::string out, directory;
  for (const auto& [name, data] : parts) {
    const std::string packed = compress ? deflated(data) : data;
    const std::uint64_t crc =
        crc32(0, reinterpret_cast<const Bytef*>(data.data()), static_cast<uInt>(data.size()));
    const std::string common = little(0, 2) + little(compress ? 8 : 0, 2) + little(0, 4) + little(crc, 4);
    directory += "PK\1\2" + little(45, 2) + little(45, 2) + common + little(packed.size(), 4) +
                 little(data.size(), 4) + little(name.size(), 2) + little(0, 12) + little(out.size(), 4) +
                 name;
    out += "PK\3\4" + little(45, 2) + common + little(0xFFFFFFFF, 4) + little(0xFFFFFFFF, 4) +
           little(name.size(), 2) + little(20, 2) + name + little(1, 2) + little(16, 2) +
           little(data.size(), 8) + little(packed.size(), 8) + packed;
  }
  const std::size_t start = out.size();
  return out + directory + "PK\5\6" + little(0, 4) + little(parts.size(), 2) + little(parts.size(), 2) +
         little(directory.size(), 4) + little(start, 4) + little(0, 2);
}

}  // namespace motiongan::testing

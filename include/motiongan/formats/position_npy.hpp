// Joint positions as NumPy .npy arrays.
#pragma once
#include <bit>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/formats/bone_list.hpp"
#include "motiongan/formats/position_csv.hpp"
#include "motiongan/motion/position_clip.hpp"

namespace motiongan::motion {

namespace npy_detail {

/// The header of an .npy file.
struct NpyHeader {
  std::string descr;               ///< such as "<f4"
  bool fortran_order = false;      ///< the first index varies fastest
  std::vector<std::size_t> shape;  ///< empty for a scalar
  std::size_t data = 0;            ///< offset of the values in the file
};

/// The text after `'key':` in the header's dictionary. Throws Error as `name: ...` if there is none.
inline std::string_view npy_entry(std::string_view dictionary, std::string_view key, std::string_view name) {
  for (const char quote : {'\'', '"'}) {
    const std::string quoted = quote + std::string(key) + quote;
    std::size_t at = dictionary.find(quoted);
    if (at == dictionary.npos) continue;
    at = dictionary.find_first_not_of(' ', at + quoted.size());
    if (at == dictionary.npos || dictionary[at] != ':') continue;
    at = dictionary.find_first_not_of(' ', at + 1);
    if (at != dictionary.npos) return dictionary.substr(at);
  }
  throw Error(name, ": the header of the .npy file has no entry '", key, "': found ",
              dictionary.substr(0, 120));
}

/// Reads the header of an .npy file, version 1, 2 or 3. Throws Error as `name: ...` if it is not one.
inline NpyHeader parse_npy_header(std::string_view bytes, std::string_view name) {
  constexpr std::string_view magic = "\x93NUMPY";
  require(bytes.starts_with(magic) && bytes.size() >= 12, name,
          ": not an .npy file: it does not start with the bytes \\x93NUMPY; write it with numpy.save");
  const auto byte = [&](std::size_t i) {
    return static_cast<std::size_t>(static_cast<unsigned char>(bytes[i]));
  };
  const std::size_t version = byte(6);
  require(version >= 1 && version <= 3, name, ": .npy version ", version, ".", byte(7),
          ", expected 1, 2 or 3");
  const std::size_t start = version == 1 ? 10 : 12;
  const std::size_t size = byte(8) | byte(9) << 8 | (version == 1 ? 0 : byte(10) << 16 | byte(11) << 24);
  require(size <= bytes.size() - start, name, ": the header has ", size, " bytes, but the file ends after ",
          bytes.size() - start, " of them; the file is truncated");
  const std::string_view dictionary = bytes.substr(start, size);

  NpyHeader out;
  out.data = start + size;
  const std::string_view descr = npy_entry(dictionary, "descr", name);
  const std::size_t close = descr.find(descr.front(), 1);
  require((descr.front() == '\'' || descr.front() == '"') && close != descr.npos, name,
          ": the array is structured (descr ", descr.substr(0, 60),
          "), expected plain numbers: '<f4', '<f8', '>f4' or '>f8'");
  out.descr = descr.substr(1, close - 1);
  const std::string_view order = npy_entry(dictionary, "fortran_order", name);
  out.fortran_order = order.starts_with("True");
  require(out.fortran_order || order.starts_with("False"), name, ": fortran_order is ", order.substr(0, 20),
          ", expected True or False");
  std::string_view shape = npy_entry(dictionary, "shape", name);
  const std::size_t end = shape.find(')');
  require(shape.front() == '(' && end != shape.npos, name, ": the shape is ", shape.substr(0, 60),
          ", expected a tuple such as (240, 31, 3)");
  shape = shape.substr(1, end - 1);
  while (shape.find_first_not_of(" ,") != shape.npos) {
    shape.remove_prefix(shape.find_first_not_of(" ,"));
    std::size_t extent = 0;
    const auto [stop, problem] = std::from_chars(shape.data(), shape.data() + shape.size(), extent);
    require(problem == std::errc(), name, ": the shape contains '", shape.substr(0, 40),
            "', expected whole numbers");
    out.shape.push_back(extent);
    shape.remove_prefix(static_cast<std::size_t>(stop - shape.data()));
  }
  return out;
}

/// The number at `bytes`; `Raw` is an unsigned integer of the same size.
template <class Number, class Raw>
double npy_number(const char* bytes, bool big_endian) {
  static_assert(sizeof(Number) == sizeof(Raw));
  Raw raw = 0;
  for (std::size_t i = 0; i < sizeof(Raw); ++i) {
    const auto part = static_cast<Raw>(static_cast<unsigned char>(bytes[i]));
    raw = static_cast<Raw>(raw | part << (8 * (big_endian ? sizeof(Raw) - 1 - i : i)));
  }
  return static_cast<double>(std::bit_cast<Number>(raw));
}

}  // namespace npy_detail

/// Reads an .npy file (version 1 to 3) of float32 or float64, either byte order, C or Fortran order, of shape
/// [frames, joints, 3] or [frames, 3 * joints]: world positions, y up, joints in the order of `skeleton`,
/// `rate` frames per second. Offsets come from the positions (with_offsets_of). Throws Error as `name: ...`
/// for another type or shape, a file that is truncated or too long, a value that is not finite, or a rate
/// that is not above 0.
inline PositionClip parse_position_npy(std::string_view bytes, const Skeleton& skeleton, double rate,
                                       std::string_view name) {
  const npy_detail::NpyHeader header = npy_detail::parse_npy_header(bytes, name);
  const std::size_t joints = skeleton.size();
  require(joints > 0, name, ": the bone list is empty, expected at least one joint");
  const bool single = header.descr == "<f4" || header.descr == ">f4";
  require(single || header.descr == "<f8" || header.descr == ">f8", name, ": the numbers are of type '",
          header.descr, "', expected '<f4', '<f8', '>f4' or '>f8'; convert with array.astype('float32')");
  const bool cubic = header.shape.size() == 3 && header.shape[1] == joints && header.shape[2] == 3;
  const bool flat = header.shape.size() == 2 && header.shape[1] == 3 * joints;
  require(cubic || flat, name, ": the shape is ", header.shape, ", expected [frames, ", joints,
          ", 3] or [frames, ", 3 * joints, "] for the ", joints, " joints of the bone list");
  require(std::isfinite(rate) && rate > 0, name, ": the rate is ", rate,
          " frames per second, expected more than 0; an .npy file does not store it: give --rate or "
          "--fps on the command line, the argument `rate` in the API");
  const std::size_t frames = header.shape.front(), size = single ? 4 : 8, row = 3 * joints * size;
  const std::size_t found = bytes.size() - header.data;
  require(frames > 0, name, ": found no frames, expected at least one");
  require(found % row == 0 && found / row == frames, name, ": found ", found, " bytes of numbers, expected ",
          frames, " frames x ", 3 * joints, " numbers x ", size, " bytes; the file is damaged");

  PositionClip out;
  out.rate = rate;
  out.frames = frames;
  out.positions.resize(frames * joints);
  for (std::size_t f = 0; f < frames; ++f) {
    for (std::size_t j = 0; j < joints; ++j) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t column = cubic ? joints * k + j : 3 * j + k;  // column index in Fortran order
        const std::size_t at = header.fortran_order ? frames * column + f : 3 * (joints * f + j) + k;
        const char* number = bytes.data() + header.data + at * size;
        const bool big = header.descr.front() == '>';
        const double value = single ? npy_detail::npy_number<float, std::uint32_t>(number, big)
                                    : npy_detail::npy_number<double, std::uint64_t>(number, big);
        require(std::isfinite(value), name, ": frame ", f + 1, ", joint '", skeleton.joints[j].name,
                "': found ", value, ", expected a finite number");
        out.positions[f * joints + j][k] = value;
      }
    }
  }
  out.skeleton = with_offsets_of(skeleton, out.positions);
  return out;
}

/// The clip as an .npy file: version 1, '<f8', C order, [frames, joints, 3]. Rate and bones are not stored.
inline std::string format_position_npy(const PositionClip& clip) {
  check_writable(clip);
  std::string header = concat("{'descr': '<f8', 'fortran_order': False, 'shape': (", clip.frames, ", ",
                              clip.skeleton.size(), ", 3), }");
  // With the ten bytes before it, the header ends in a line break at a multiple of 64 bytes.
  header.append(63 - (10 + header.size()) % 64, ' ') += '\n';
  std::string out = "\x93NUMPY";
  out += '\x01';
  out += '\0';
  out += static_cast<char>(header.size() & 0xFFu);
  out += static_cast<char>(header.size() >> 8);
  out += header;
  out.reserve(out.size() + 24 * clip.positions.size());
  for (const Vec3& p : clip.positions)
    for (const double v : p) {
      const auto raw = std::bit_cast<std::uint64_t>(v);
      for (unsigned i = 0; i < 8; ++i) out += static_cast<char>(static_cast<unsigned char>(raw >> (8 * i)));
    }
  return out;
}

}  // namespace motiongan::motion

// Arrays of numbers in NumPy's .npz files, which are ZIP archives of .npy files.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/formats/position_npy.hpp"
#include "motiongan/formats/zip_archive.hpp"

namespace motiongan::motion {

/// An array of an .npy file, in C order.
struct NpyArray {
  std::vector<std::size_t> shape;  ///< empty for a scalar
  std::vector<double> values;      ///< row-major, whatever the order in the file
};

namespace npy_detail {

/// Reads the number of type `descr` at `bytes`; null if the type is not supported.
using NumberReader = double (*)(const char* bytes, bool big_endian);

inline NumberReader number_reader(std::string_view type) {
  if (type == "f4") return npy_number<float, std::uint32_t>;
  if (type == "f8") return npy_number<double, std::uint64_t>;
  if (type == "i2") return npy_number<std::int16_t, std::uint16_t>;
  if (type == "i4") return npy_number<std::int32_t, std::uint32_t>;
  if (type == "i8") return npy_number<std::int64_t, std::uint64_t>;
  return nullptr;
}

}  // namespace npy_detail

/// Reads an .npy file of float32, float64 or int16 to int64, either byte order, C or Fortran order (one or
/// two dimensions). Throws Error as `name: ...` for another type, and if the number of bytes does not match
/// the shape.
inline NpyArray parse_npy_array(std::string_view bytes, std::string_view name) {
  const npy_detail::NpyHeader header = npy_detail::parse_npy_header(bytes, name);
  const std::string_view descr = header.descr;
  const bool ordered = descr.size() == 3 && (descr[0] == '<' || descr[0] == '>');
  const npy_detail::NumberReader read = ordered ? npy_detail::number_reader(descr.substr(1)) : nullptr;
  require(read != nullptr, name, ": the array is of type '", descr,
          "', expected numbers: '<f4', '<f8', '<i2', '<i4' or '<i8' (or '>')");
  const std::size_t size = static_cast<std::size_t>(descr[2] - '0'), found = bytes.size() - header.data;
  const bool none = std::find(header.shape.begin(), header.shape.end(), 0) != header.shape.end();
  std::size_t count = none ? 0 : 1;
  for (const std::size_t extent : header.shape) {
    // Each number takes at least a byte: stop before the product overflows.
    require(none || count <= found / extent, name, ": the shape is ", header.shape, ", but only ", found,
            " bytes of numbers follow; the file is damaged");
    count *= extent;
  }
  require(found == count * size, name, ": found ", found, " bytes of numbers, expected ", count, " x ", size,
          " for the shape ", header.shape, "; the file is damaged");
  require(!header.fortran_order || header.shape.size() <= 2, name, ": the array of shape ", header.shape,
          " is in Fortran order, expected C order; convert with numpy.ascontiguousarray");

  NpyArray out{header.shape, std::vector<double>(count)};
  const std::size_t columns = header.fortran_order && header.shape.size() == 2 ? header.shape[1] : 1;
  const std::size_t rows = count / (columns == 0 ? 1 : columns);
  const char* number = bytes.data() + header.data;
  for (std::size_t c = 0; c < columns; ++c)
    for (std::size_t r = 0; r < rows; ++r, number += size)
      out.values[r * columns + c] = read(number, descr[0] == '>');
  return out;
}

/// The array `key` of an .npz file. Throws Error as `name: ...` if there is none, listing those there are.
inline NpyArray npz_array(const ZipArchive& archive, std::string_view key, std::string_view name) {
  const ZipEntry* const entry = archive.find(std::string(key) + ".npy");
  if (entry == nullptr) {
    std::string keys;
    for (const ZipEntry& e : archive.entries())
      if (keys.size() < 200 && e.name.ends_with(".npy"))
        keys.append(keys.empty() ? "" : ", ").append(e.name.substr(0, e.name.size() - 4));
    throw Error(name, ": there is no array '", key, "'; the file has ", keys.empty() ? "none" : keys);
  }
  return parse_npy_array(archive.read(*entry), std::string(name) + ", array '" + std::string(key) + "'");
}

}  // namespace motiongan::motion

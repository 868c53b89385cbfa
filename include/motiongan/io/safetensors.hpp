// Reads and writes safetensors files: the header's length (8 bytes, little endian), a JSON header, and the
// tensors' data.
#pragma once
#include <algorithm>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "atomic_file.hpp"
#include "checksum.hpp"
#include "motiongan/core/error.hpp"
#include "safetensors_header.hpp"

namespace motiongan::io {

static_assert(std::endian::native == std::endian::little, "safetensors files hold little-endian numbers");

/// IEEE half precision to float (exact).
inline float half_to_float(std::uint16_t half) {
  const int exponent = (half >> 10) & 31, mantissa = half & 1023;
  float value = exponent == 0    ? std::ldexp(static_cast<float>(mantissa), -24)
                : exponent != 31 ? std::ldexp(static_cast<float>(mantissa + 1024), exponent - 25)
                : mantissa == 0  ? std::numeric_limits<float>::infinity()
                                 : std::numeric_limits<float>::quiet_NaN();
  return half & 0x8000 ? -value : value;
}

/// float to IEEE half precision: the nearest, of two the even one; infinite from 65520 on.
inline std::uint16_t float_to_half(float value) {
  const auto sign = static_cast<std::uint32_t>(std::signbit(value)) << 15;
  const float size = std::abs(value);
  if (!(size < 65520)) return static_cast<std::uint16_t>(sign | (std::isnan(value) ? 0x7E00u : 0x7C00u));
  int exponent = -24;  // of zero
  if (size > 0) std::frexp(size, &exponent);
  const int step = std::max(exponent - 11, -24);  // 2^step is the distance of its neighbours
  const auto steps = static_cast<std::uint32_t>(std::nearbyint(std::ldexp(size, -step)));
  return static_cast<std::uint16_t>(sign | ((static_cast<std::uint32_t>(step + 24) << 10) + steps));
}

/// bfloat16, the upper half of a float, to float (exact).
inline float bfloat_to_float(std::uint16_t upper) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(upper) << 16);
}

/// One tensor of a file: its elements as stored, row-major.
struct SafeTensor {
  std::string dtype;               ///< F64 F32 F16 BF16 I64 I32 I16 I8 U64 U32 U16 U8 BOOL
  std::vector<std::size_t> shape;  ///< empty for a scalar
  std::vector<std::byte> data;     ///< dtype_size(dtype) bytes per element

  /// A tensor of `shape` with these `values` (float, double, std::int32_t, std::int64_t or std::uint8_t).
  /// Throws Error if their number does not match the shape.
  template <class T>
  static SafeTensor of(std::vector<std::size_t> shape, const std::vector<T>& values) {
    SafeTensor tensor{dtype_of<T>(), std::move(shape), {}};
    const std::size_t bytes = tensor_bytes(tensor.dtype, tensor.shape, "a new tensor");
    require(bytes == values.size() * sizeof(T), "a tensor of shape ", shape_text(tensor.shape), " needs ",
            bytes / sizeof(T), " values, not ", values.size());
    tensor.data.resize(bytes);
    if (bytes > 0) std::memcpy(tensor.data.data(), values.data(), bytes);
    return tensor;
  }

  /// The number of elements.
  std::size_t count() const { return tensor_bytes(dtype, shape, "a tensor") / dtype_size(dtype); }

  /// The elements as T. A floating-point T accepts F64, F32, F16 and BF16; an integer T the integer types and
  /// BOOL. Throws Error for any other type, and if a finite element is out of T's range.
  template <class T>
  requires std::is_arithmetic_v<T> std::vector<T> as()
  const {
    if constexpr (std::is_floating_point_v<T>) {
      if (dtype == "F64") return convert<double, T>([](double v) { return v; });
      if (dtype == "F32") return convert<float, T>([](float v) { return v; });
      if (dtype == "F16") return convert<std::uint16_t, T>(half_to_float);
      if (dtype == "BF16") return convert<std::uint16_t, T>(bfloat_to_float);
    } else {
      const auto same = [](auto v) { return +v; };  // small types become int
      if (dtype == "I64") return convert<std::int64_t, T>(same);
      if (dtype == "I32") return convert<std::int32_t, T>(same);
      if (dtype == "I16") return convert<std::int16_t, T>(same);
      if (dtype == "I8") return convert<std::int8_t, T>(same);
      if (dtype == "U64") return convert<std::uint64_t, T>(same);
      if (dtype == "U32") return convert<std::uint32_t, T>(same);
      if (dtype == "U16") return convert<std::uint16_t, T>(same);
      if (dtype == "U8" || dtype == "BOOL") return convert<std::uint8_t, T>(same);
    }
    throw Error("a tensor has type ", dtype, ", expected ",
                std::is_floating_point_v<T> ? "floating-point" : "integer", " elements");
  }

  /// The elements rounded to F16. Throws Error if a finite one exceeds its range.
  SafeTensor as_half() const {
    std::vector<std::uint16_t> halves;
    halves.reserve(count());
    for (const float value : as<float>()) {
      halves.push_back(float_to_half(value));
      require(!std::isfinite(value) || (halves.back() & 0x7C00) != 0x7C00, "an element is ", value,
              ", more than the 65504 that 16 bits hold");
    }
    SafeTensor out{"F16", shape, std::vector<std::byte>(2 * halves.size())};
    if (!halves.empty()) std::memcpy(out.data.data(), halves.data(), out.data.size());
    return out;
  }

  friend bool operator==(const SafeTensor&, const SafeTensor&) = default;

 private:
  template <class T>
  static const char* dtype_of() {
    if constexpr (std::is_same_v<T, double>) return "F64";
    if constexpr (std::is_same_v<T, float>) return "F32";
    if constexpr (std::is_same_v<T, std::int64_t>) return "I64";
    if constexpr (std::is_same_v<T, std::int32_t>) return "I32";
    if constexpr (std::is_same_v<T, std::uint8_t>) return "U8";
  }

  template <class Stored, class T, class Widen>
  std::vector<T> convert(Widen widen) const {
    const std::size_t n = count();
    require(data.size() == n * sizeof(Stored), "a tensor of type ", dtype, " and shape ", shape_text(shape),
            " has ", data.size(), " bytes, expected ", n * sizeof(Stored));
    std::vector<T> values(n);
    for (std::size_t i = 0; i < n; ++i) {
      Stored stored;
      std::memcpy(&stored, data.data() + i * sizeof(Stored), sizeof(Stored));
      const auto wide = widen(stored);
      bool fits = true;
      if constexpr (std::is_floating_point_v<T>)
        fits = !std::isfinite(wide) || std::abs(wide) <= std::numeric_limits<T>::max();
      else
        fits = std::in_range<T>(wide);
      require(fits, "element ", i, " of a tensor of type ", dtype, " is ", +wide,
              ", out of range for the requested type");
      values[i] = static_cast<T>(wide);
    }
    return values;
  }
};

/// The contents of one safetensors file.
class SafeTensors {
 public:
  std::map<std::string, SafeTensor> tensors;    ///< by name
  std::map<std::string, std::string> metadata;  ///< the header's __metadata__

  /// Reads a file. Throws Error, naming the file and the problem, unless it conforms to the format in every
  /// respect and, if write() made it, its checksum is right. Sizes claimed by the header are checked before
  /// any memory is allocated for them.
  static SafeTensors read(const std::filesystem::path& path);

  /// Writes a file atomically, with the tensors sorted by name and a checksum as "crc32" in the metadata of
  /// the file: equal contents give equal bytes. Throws Error if a tensor's data does not match its type and
  /// shape, a name is not UTF-8, or writing fails.
  void write(const std::filesystem::path& path) const {
    AtomicFile file(path);
    write_to(file, path.string());
    file.commit();
  }
  /// Writes to a file that the caller commits; `where` names it in errors.
  void write_to(AtomicFile& file, const std::string& where) const;

  /// CRC-32 of all names, types, shapes, data and metadata, whatever their order in the file.
  std::string checksum() const;

  /// The tensor called `name`. Throws Error if there is none.
  const SafeTensor& at(const std::string& name) const {
    const auto found = tensors.find(name);
    require(found != tensors.end(), "there is no tensor \"", name, "\" among the ", tensors.size(),
            " in the file");
    return found->second;
  }
};

inline SafeTensors SafeTensors::read(const std::filesystem::path& path) {
  constexpr std::uint64_t largest_header = 100'000'000;
  const std::string where = path.string();
  std::error_code error;
  require(std::filesystem::is_regular_file(path, error), where, ": no such file",
          std::filesystem::exists(path, error) ? " (it is not a regular file)" : "");
  const std::uint64_t size = std::filesystem::file_size(path, error);
  std::ifstream file(path, std::ios::binary);
  require(!error && file.is_open(), where, ": cannot be opened: ", std::strerror(errno));
  const auto fetch = [&](void* to, std::size_t bytes) {
    file.read(static_cast<char*>(to), static_cast<std::streamsize>(bytes));
    require(static_cast<std::size_t>(file.gcount()) == bytes, where, ": could not be read to its end");
  };

  std::uint64_t length = 0;
  require(size >= sizeof(length), where, ": ", size, " bytes are too few for a safetensors file");
  fetch(&length, sizeof(length));
  require(length > 0, where, ": the header has length 0; is this a safetensors file?");
  require(length <= largest_header, where, ": the header claims ", length, " bytes, more than the ",
          largest_header, " that the format allows; is this a safetensors file?");
  require(length <= size - sizeof(length), where, ": the header claims ", length, " bytes, but only ",
          size - sizeof(length), " follow; the file was cut short or is not a safetensors file");
  std::string text(length, '\0');
  fetch(text.data(), text.size());
  const std::uint64_t data_begin = sizeof(length) + length;
  SafeTensorsHeader header = parse_safetensors_header(text, size - data_begin, where);

  SafeTensors content;
  content.metadata = std::move(header.metadata);
  for (auto& [name, entry] : header.entries) {
    SafeTensor& tensor = content.tensors[name];
    tensor.dtype = std::move(entry.dtype);
    tensor.shape = std::move(entry.shape);
    tensor.data.resize(entry.offsets[1] - entry.offsets[0]);
    file.seekg(static_cast<std::streamoff>(data_begin + entry.offsets[0]));
    fetch(tensor.data.data(), tensor.data.size());
  }
  // Files of earlier versions and of other programs have no checksum.
  if (const auto stored = content.metadata.extract("crc32"); !stored.empty())
    require(stored.mapped() == content.checksum(), where, ": the file is damaged: its checksum is ",
            content.checksum(), ", it was ", stored.mapped(),
            " when it was written; use a copy, or an earlier save (if another program changed the file on "
            "purpose, remove \"crc32\" from its metadata)");
  return content;
}

inline std::string SafeTensors::checksum() const {
  Checksum sum;
  for (const auto& [key, value] : metadata) sum.add(key), sum.add(value);
  for (const auto& [name, tensor] : tensors) {
    sum.add(name);
    sum.add(tensor.dtype);
    sum.add(shape_text(tensor.shape));
    sum.add(tensor.data.data(), tensor.data.size());
  }
  return sum.text();
}

inline void SafeTensors::write_to(AtomicFile& file, const std::string& where) const {
  std::string text = "{";
  const auto add = [&](const std::string& name, const std::string& value) {
    try {
      text += concat(text.size() > 1 ? "," : "", nlohmann::json(name).dump(), ":", value);
    } catch (const nlohmann::json::exception& error) {
      throw Error(where, ": the name of a tensor is not UTF-8: ", error.what());
    }
  };
  nlohmann::json values;
  for (const auto& [key, value] : metadata) values[key] = value;
  values["crc32"] = checksum();
  try {
    add("__metadata__", values.dump());
  } catch (const nlohmann::json::exception& error) {
    throw Error(where, ": the metadata is not UTF-8: ", error.what());
  }
  std::size_t at = 0;
  for (const auto& [name, tensor] : tensors) {
    require(name != "__metadata__", where, ": no tensor can be called __metadata__");
    const std::size_t bytes =
        tensor_bytes(tensor.dtype, tensor.shape, concat(where, ": tensor \"", name, "\""));
    require(tensor.data.size() == bytes, where, ": tensor \"", name, "\" of type ", tensor.dtype,
            " and shape ", shape_text(tensor.shape), " has ", tensor.data.size(), " bytes of data, expected ",
            bytes);
    std::string shape;
    for (const std::size_t n : tensor.shape) shape += (shape.empty() ? "" : ",") + std::to_string(n);
    add(name, concat("{\"dtype\":\"", tensor.dtype, "\",\"shape\":[", shape, "],\"data_offsets\":[", at, ",",
                     at + bytes, "]}"));
    at += bytes;
  }
  text += "}";
  text.resize((text.size() + 7) / 8 * 8, ' ');  // aligns the data to 8 bytes

  const std::uint64_t length = text.size();
  file.write(&length, sizeof(length));
  file.write(text);
  for (const auto& [name, tensor] : tensors) file.write(tensor.data.data(), tensor.data.size());
}

}  // namespace motiongan::io

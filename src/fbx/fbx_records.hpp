// The records of binary FBX files.
#pragma once
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "motiongan/core/error.hpp"

namespace motiongan::command::fbx_records {

// Before a record's name: the offset of its end, the number and the bytes of its properties, the length of
// its name. All zeros: the end of a list of records. With 8 bytes for each number from version 7.5 on.
constexpr std::size_t header_size = 25, first_record = 27, version_at = 23;

inline std::uint64_t number_at(std::string_view bytes, std::size_t at) {
  std::uint64_t out = 0;
  require(at + sizeof out <= bytes.size(), "an FBX file from Assimp ends in the middle of a record");
  std::memcpy(&out, bytes.data() + at, sizeof out);
  return out;
}

/// Appends the record at `at`, with an empty record after its last child; also where there is no child if it
/// `is_list`, as every object is.
inline void append_record(std::string_view bytes, std::size_t at, bool is_list, bool holds_objects,
                          std::string& out) {
  const std::uint64_t end = number_at(bytes, at), length = number_at(bytes, at + 16);
  require(at + header_size < bytes.size() && end <= bytes.size(),
          "an FBX file from Assimp has no whole records");
  const std::size_t begin = out.size(),
                    children = at + header_size + static_cast<unsigned char>(bytes[at + 24]) + length;
  require(children <= end, "an FBX file from Assimp has a record of ", length,
          " bytes that ends before them");
  out += bytes.substr(at, children - at);
  for (std::size_t child = children; child < end;) {
    const std::uint64_t next = number_at(bytes, child);
    if (next > child) append_record(bytes, child, holds_objects, false, out);
    child = next > child ? next : end;
  }
  if (children < end || is_list) out.append(header_size, '\0');
  const std::uint64_t new_end = out.size();
  std::memcpy(&out[begin], &new_end, sizeof new_end);
}

/// A binary FBX file of version 7.5 in which every list of records ends with an empty one. Assimp 5.2, which
/// is Debian 12's, leaves those out, and nobody reads its files. Throws Error for bytes of another form.
inline std::string with_ends_of_lists(std::string_view bytes) {
  require(bytes.starts_with("Kaydara FBX Binary") && bytes.size() > first_record &&
              static_cast<std::uint32_t>(number_at(bytes, version_at)) >= 7500,
          "Assimp wrote an FBX file of an unknown form");
  std::string out(bytes.substr(0, first_record));
  std::size_t at = first_record;
  while (const std::uint64_t end = number_at(bytes, at)) {
    require(end > at, "an FBX file from Assimp has a record that ends before it begins");
    append_record(bytes, at, true, bytes.substr(at + header_size).starts_with("Objects"), out);
    at = end;
  }
  out += bytes.substr(at);  // the empty record, and what ends the file
  return out;
}

/// Sets properties of that name which hold a time, in seconds. Assimp 5.2 rounds them down to whole seconds.
inline void set_time(std::string& file, std::string_view name, double seconds) {
  constexpr std::string_view kind{"S\5\0\0\0KTimeS\4\0\0\0TimeS\0\0\0\0L", 25};
  constexpr double ticks_per_second = 46186158000;
  const auto ticks = static_cast<std::int64_t>(seconds * ticks_per_second);
  for (std::size_t at = 0; (at = file.find(name, at)) != std::string::npos;) {
    at += name.size();
    if (file.compare(at, kind.size(), kind) != 0 || at + kind.size() + sizeof ticks > file.size()) continue;
    std::memcpy(&file[at + kind.size()], &ticks, sizeof ticks);
  }
}

/// The values of an animation curve, in a file.
struct Curve {
  std::size_t at, keys;
};

/// All animation curves, in the order of the file.
inline std::vector<Curve> curves_of(std::string_view file) {
  constexpr std::string_view name = "KeyValueFloatf";
  const auto word = [&](std::size_t at) {
    std::uint32_t out = 0;
    require(at + sizeof out <= file.size(), "an FBX file from Assimp ends in the middle of a curve");
    std::memcpy(&out, file.data() + at, sizeof out);
    return out;
  };
  std::vector<Curve> out;
  for (std::size_t at = 0; (at = file.find(name, at)) != std::string_view::npos;) {
    at += name.size();
    const std::size_t keys = word(at), compressed = word(at + 4), bytes = word(at + 8);
    require(compressed == 0 && bytes == sizeof(float) * keys && at + 12 + bytes <= file.size(),
            "an FBX file from Assimp has a curve of ", keys, " keys in ", bytes, " bytes");
    out.push_back({at + 12, keys});
    at += 12 + bytes;
  }
  return out;
}

}  // namespace motiongan::command::fbx_records

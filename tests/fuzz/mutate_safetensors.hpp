// Mutations of safetensors files: a change in the JSON header, after which lengths and offsets fit again.
#pragma once
#include <cstdint>
#include <cstring>
#include <motiongan/io/safetensors_header.hpp>
#include <string>
#include <string_view>

#include "mutate_json.hpp"

namespace motiongan::fuzz {

namespace safetensors_detail {

using json_detail::Json;

/// The bytes of the tensor by its type and shape; `most` if there is no such type, or if it is larger.
inline std::size_t size_of(const Json& entry, std::size_t most) {
  std::size_t bytes = io::dtype_size(entry.value("dtype", std::string()));
  for (const Json& extent : entry["shape"]) {
    if (!extent.is_number_unsigned() || bytes == 0) return most;
    if (__builtin_mul_overflow(bytes, extent.get<std::size_t>(), &bytes) || bytes > most) return most;
  }
  return bytes;
}

/// Lays the tensors out one after another; returns the number of bytes that they take.
inline std::size_t lay_out(Json& header) {
  std::size_t at = 0;
  if (!header.is_object()) return at;
  for (auto& [name, entry] : header.items()) {
    if (name == "__metadata__" || !entry.is_object() || !entry.contains("dtype") ||
        !entry["dtype"].is_string() || !entry.contains("shape") || !entry["shape"].is_array())
      continue;
    const std::size_t size = size_of(entry, 4096);
    entry["data_offsets"] = {at, at + size};
    at += size;
  }
  return at;
}

}  // namespace safetensors_detail

/// A safetensors file of this header and data.
inline std::string safetensors_file(std::string_view header, std::string_view data) {
  const std::uint64_t length = header.size();
  std::string out(sizeof length, '\0');
  std::memcpy(out.data(), &length, sizeof length);
  return out.append(header).append(data);
}

/// Changes a value of the header; in most cases the offsets are then computed anew.
inline std::string mutate_safetensors(std::string_view bytes, const ChangeBytes& change, Random& random) {
  std::uint64_t length = 0;
  if (bytes.size() < sizeof length || below(8, random) == 0) return change(bytes);
  std::memcpy(&length, bytes.data(), sizeof length);
  const std::string_view rest = bytes.substr(sizeof length);
  const std::string_view header = rest.substr(0, std::min<std::uint64_t>(length, rest.size()));
  std::string data(rest.substr(header.size())), text = mutate_json(header, change, random);
  if (!data.empty() && below(8, random) == 0) data = change(data);
  if (below(4, random) > 0) {
    json_detail::Json json = json_detail::Json::parse(text, nullptr, false);
    if (!json.is_discarded()) {
      data.resize(safetensors_detail::lay_out(json), '\1');
      text = json_detail::text_of(json);
    }
  }
  return safetensors_file(text, data);
}

}  // namespace motiongan::fuzz

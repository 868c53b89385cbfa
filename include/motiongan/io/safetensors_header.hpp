// Parses and validates the JSON header of a safetensors file with a SAX reader, which rejects the first value
// that the format does not allow.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"

namespace motiongan::io {

/// Bytes per element of a safetensors type (F32, I64, ...); 0 if there is no such type.
inline std::size_t dtype_size(std::string_view dtype) {
  if (dtype == "F64" || dtype == "I64" || dtype == "U64") return 8;
  if (dtype == "F32" || dtype == "I32" || dtype == "U32") return 4;
  if (dtype == "F16" || dtype == "BF16" || dtype == "I16" || dtype == "U16") return 2;
  if (dtype == "I8" || dtype == "U8" || dtype == "BOOL") return 1;
  return 0;
}

/// `[2, 3]`, for messages.
inline std::string shape_text(const std::vector<std::size_t>& shape) {
  std::string text = "[";
  for (std::size_t i = 0; i < shape.size(); ++i) text += (i ? ", " : "") + std::to_string(shape[i]);
  return text + "]";
}

/// Bytes of a tensor. Throws Error for an unknown type or a size that overflows 64 bits.
inline std::size_t tensor_bytes(const std::string& dtype, const std::vector<std::size_t>& shape,
                                const std::string& where) {
  std::size_t bytes = dtype_size(dtype);
  require(bytes > 0, where, ": unknown type \"", dtype,
          "\", expected one of F64 F32 F16 BF16 I64 I32 I16 I8 U64 U32 U16 U8 BOOL");
  for (const std::size_t n : shape)
    require(!__builtin_mul_overflow(bytes, n, &bytes), where, ": a tensor of shape ", shape,
            " has more bytes than 64 bits can count");
  return bytes;
}

/// The header of a safetensors file.
struct SafeTensorsHeader {
  /// Far beyond any model: a header with more would cost much time and memory for its few bytes.
  static constexpr std::size_t most_dimensions = 16, most_entries = 100'000;

  /// A tensor of the file.
  struct Entry {
    std::string dtype;  ///< as in the file, such as F32
    std::vector<std::size_t> shape;
    std::vector<std::size_t> offsets;  ///< begin and end, in bytes after the header
  };
  std::map<std::string, Entry> entries;
  std::map<std::string, std::string> metadata;
};

/// SAX handler that fills a SafeTensorsHeader. Throws Error at the first unexpected event; `where` (the
/// file's name) starts every message.
class SafeTensorsHeaderReader : public nlohmann::json_sax<nlohmann::json> {
 public:
  SafeTensorsHeaderReader(SafeTensorsHeader& header, std::string where)
      : header_(header), where_(std::move(where)) {}

  bool null() override { return refuse("null"); }
  bool boolean(bool) override { return refuse("a boolean"); }
  bool number_integer(number_integer_t value) override {
    return refuse("the number " + std::to_string(value));
  }
  bool number_float(number_float_t, const string_t& text) override { return refuse("the number " + text); }
  bool binary(binary_t&) override { return refuse("binary data"); }

  bool number_unsigned(number_unsigned_t value) override {
    if (!in_array_) return refuse("the number " + std::to_string(value));
    expect(array_->size() < SafeTensorsHeader::most_dimensions, ": \"", field_, "\" has more than ",
           SafeTensorsHeader::most_dimensions, " numbers, the most that are read");
    array_->push_back(value);
    return true;
  }

  bool string(string_t& value) override {
    if (depth_ == 2 && in_metadata_)
      header_.metadata[field_] = std::move(value);
    else if (depth_ == 2 && field_ == "dtype")
      entry_->dtype = std::move(value);
    else
      return refuse("the string \"" + value + "\"");
    return true;
  }

  bool start_object(std::size_t) override {
    if (depth_ == 2) return refuse("an object");
    ++depth_;
    field_.clear();
    fields_seen_.clear();
    return true;
  }

  bool key(string_t& name) override {
    if (depth_ == 1) {
      require(!has_seen(names_seen_, name), where_, ": the name \"", name, "\" appears twice in the header");
      require(names_seen_.size() <= SafeTensorsHeader::most_entries, where_, ": the header has more than ",
              SafeTensorsHeader::most_entries, " tensors, the most that are read");
      name_ = name;
      in_metadata_ = name == "__metadata__";
      if (!in_metadata_) entry_ = &header_.entries[name];
    } else {
      expect(!has_seen(fields_seen_, name), ": \"", name, "\" appears twice");
      expect(in_metadata_ || name == "dtype" || name == "shape" || name == "data_offsets",
             ": unknown field \"", name, "\", expected dtype, shape and data_offsets");
      expect(fields_seen_.size() <= SafeTensorsHeader::most_entries, " has more than ",
             SafeTensorsHeader::most_entries, " members, the most that are read");
      field_ = name;
    }
    return true;
  }

  bool end_object() override {
    if (depth_ == 2 && !in_metadata_)
      expect(fields_seen_.size() == 3, ": an entry needs dtype, shape and data_offsets, this one has ",
             fields_seen_.size(), " of them");
    --depth_;
    field_.clear();
    return true;
  }

  bool start_array(std::size_t) override {
    if (depth_ != 2 || in_metadata_ || in_array_ || (field_ != "shape" && field_ != "data_offsets"))
      return refuse("a list");
    array_ = field_ == "shape" ? &entry_->shape : &entry_->offsets;
    in_array_ = true;
    return true;
  }

  bool end_array() override {
    in_array_ = false;
    return true;
  }

  bool parse_error(std::size_t position, const std::string&,
                   const nlohmann::json::exception& error) override {
    throw Error(where_, ": the header is not JSON in UTF-8: byte ", position, " of it: ", error.what());
  }

 private:
  static bool has_seen(std::map<std::string, bool>& seen, const std::string& name) {
    return !seen.emplace(name, true).second;
  }

  std::string where() const {
    return where_ + ": " + (in_metadata_ ? "__metadata__" : "tensor \"" + name_ + "\"");
  }

  /// As require(), starting with where(), which is made only for a message.
  template <class... Parts>
  void expect(bool condition, const Parts&... parts) const {
    if (!condition) throw Error(where(), parts...);
  }

  /// Always throws; returns bool like the parser's event handlers.
  bool refuse(const std::string& found) const {
    if (depth_ == 0) throw Error(where_, ": the header is ", found, ", expected an object of tensors");
    if (depth_ == 1) throw Error(where(), " is ", found, ", expected an object");
    throw Error(where(), ": \"", field_, "\" holds ", found, ", expected ",
                in_metadata_ || field_ == "dtype" ? "a string" : "a list of whole numbers of at least 0");
  }

  SafeTensorsHeader& header_;
  std::string where_;
  int depth_ = 0;  ///< open objects: 1 the header, 2 a tensor's entry or the metadata
  bool in_metadata_ = false, in_array_ = false;
  std::string name_, field_;
  std::map<std::string, bool> names_seen_, fields_seen_;
  SafeTensorsHeader::Entry* entry_ = nullptr;
  std::vector<std::size_t>* array_ = nullptr;
};

/// Throws Error unless every tensor has as many bytes as its type and shape need, and together they fill the
/// `data_size` bytes after the header without gap or overlap.
inline void check_layout(const SafeTensorsHeader& header, std::size_t data_size, const std::string& where) {
  std::vector<std::pair<std::pair<std::size_t, std::size_t>, const std::string*>> spans;
  for (const auto& [name, entry] : header.entries) {
    const auto expect = [&, &tensor = name](bool condition, const auto&... parts) {
      if (!condition) throw Error(where, ": tensor \"", tensor, "\": ", parts...);
    };
    expect(entry.offsets.size() == 2, "data_offsets has ", entry.offsets.size(),
           " numbers, expected begin and end");
    const std::size_t begin = entry.offsets[0], end = entry.offsets[1];
    const std::size_t bytes =
        tensor_bytes(entry.dtype, entry.shape, concat(where, ": tensor \"", name, "\""));
    expect(begin <= end, "data_offsets ", entry.offsets, " end before they begin");
    expect(end <= data_size, "its data ends at byte ", end, ", but only ", data_size,
           " bytes follow the header; the file was cut short or its header is wrong");
    expect(end - begin == bytes, entry.dtype, " of shape ", entry.shape, " takes ", bytes,
           " bytes, data_offsets ", entry.offsets, " give it ", end - begin);
    spans.push_back({{begin, end}, &name});
  }
  std::sort(spans.begin(), spans.end());
  std::size_t at = 0;
  for (const auto& [span, name] : spans) {
    require(span.first >= at, where, ": tensor \"", *name, "\" begins at byte ", span.first,
            ", inside the previous tensor, which ends at ", at);
    require(span.first == at, where, ": ", span.first - at, " bytes before tensor \"", *name,
            "\" belong to no tensor");
    at = span.second;
  }
  require(at == data_size, where, ": the last ", data_size - at, " bytes of the file belong to no tensor");
}

/// Parses and validates the header `text`; `data_size` bytes follow it in the file. Throws Error, starting
/// with `where`, if the header is malformed or does not match the data.
inline SafeTensorsHeader parse_safetensors_header(const std::string& text, std::size_t data_size,
                                                  const std::string& where) {
  // The parser would skip a byte order mark and stop at a zero byte; the format allows neither.
  require(!text.empty() && text[0] == '{', where,
          ": the header does not begin with {; is this a safetensors file?");
  require(text.find('\0') == std::string::npos, where, ": the header contains a zero byte");
  SafeTensorsHeader header;
  SafeTensorsHeaderReader reader(header, where);
  nlohmann::json::sax_parse(text, &reader);
  check_layout(header, data_size, where);
  return header;
}

}  // namespace motiongan::io

// The bytes of glTF 2.0 binaries (GLB): a JSON document and a buffer of numbers.
#pragma once
#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/formats/glb_reader.hpp"

namespace motiongan::motion::glb_detail {

/// The parts of a file: its JSON and its binary buffer.
class Document {
 public:
  using Json = nlohmann::json;

  /// A document with an empty scene.
  Document() = default;
  /// An existing file, to which something is added.
  explicit Document(GlbParts parts) : json_(std::move(parts.json)), bytes_(std::move(parts.binary)) {}

  /// Adds values as an accessor and returns its index. `kind` is glTF's: "SCALAR", "VEC3", ...; `width` its
  /// number of values. With `bounds`, the smallest and largest values are given, as glTF asks for positions
  /// and times. `target` is the kind of buffer view; 0: none.
  template <class T>
  std::size_t add(const std::vector<T>& values, const char* kind, std::size_t width, bool bounds = false,
                  int target = 0) {
    constexpr int type = std::is_same_v<T, float> ? 5126 : std::is_same_v<T, std::uint16_t> ? 5123 : 5125;
    while (bytes_.size() % 4 != 0) bytes_ += '\0';
    Json view = {{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", values.size() * sizeof(T)}};
    if (target != 0) view["target"] = target;
    // glTF is little-endian, as are all machines that this library runs on.
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    json_["bufferViews"].push_back(std::move(view));
    Json accessor = {{"bufferView", json_["bufferViews"].size() - 1},
                     {"componentType", type},
                     {"count", values.size() / width},
                     {"type", kind}};
    if (bounds) {
      std::vector<T> least(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(width)), most = least;
      for (std::size_t i = 0; i < values.size(); ++i) {
        least[i % width] = std::min(least[i % width], values[i]);
        most[i % width] = std::max(most[i % width], values[i]);
      }
      accessor["min"] = least, accessor["max"] = most;
    }
    return push("accessors", std::move(accessor));
  }

  /// Appends to a list of the document and returns the index.
  std::size_t push(const char* list, Json value) {
    json_[list].push_back(std::move(value));
    return json_[list].size() - 1;
  }
  Json& operator[](const char* key) { return json_[key]; }

  /// The whole file.
  std::string file() {
    while (bytes_.size() % 4 != 0) bytes_ += '\0';
    json_["buffers"] = Json::array({{{"byteLength", bytes_.size()}}});
    std::string text = json_.dump(-1, ' ', false, Json::error_handler_t::replace);
    while (text.size() % 4 != 0) text += ' ';
    std::string out;
    const auto word = [&](std::size_t value) {
      require(value < (std::uint64_t{1} << 32), "a GLB file of ", value,
              " bytes: at most 4 GiB are possible; ", "write fewer or shorter motions to it");
      const auto v = static_cast<std::uint32_t>(value);
      out.append(reinterpret_cast<const char*>(&v), 4);
    };
    out += "glTF";
    word(2), word(12 + 8 + text.size() + 8 + bytes_.size());
    word(text.size()), out += "JSON" + text;
    word(bytes_.size()), out.append("BIN\0", 4), out += bytes_;
    return out;
  }

 private:
  Json json_{{"asset", {{"version", "2.0"}, {"generator", "motiongan"}}},
             {"scene", 0},
             {"scenes", Json::array({{{"nodes", Json::array()}}})}};
  std::string bytes_;
};

}  // namespace motiongan::motion::glb_detail

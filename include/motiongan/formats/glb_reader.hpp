// Reading glTF 2.0 binaries (GLB, and VRM and VRMA, which are GLB): nodes, joints and animations.
#pragma once
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/formats/node_scene.hpp"
#include "motiongan/formats/text_file.hpp"
#include "motiongan/io/json_depth.hpp"

namespace motiongan::motion {

/// The two parts of a GLB file.
struct GlbParts {
  nlohmann::json json;
  std::string binary;
};

namespace glb_detail {

[[noreturn]] inline void damaged(const std::string& where, const std::string& what) {
  throw Error(where, ": ", what, "; the file is damaged, or no GLB file");
}

/// Numbers of glTF's JSON, whose every mistake is named by the file and what the number is of.
class Values {
 public:
  Values(const GlbParts& parts, const std::string& where) : parts_(parts), where_(where) {}

  /// The element of a list at the top of the document.
  const nlohmann::json& element(const char* list, std::size_t index) const {
    const auto found = parts_.json.find(list);
    if (found == parts_.json.end() || !found->is_array() || index >= found->size() ||
        !(*found)[index].is_object())
      damaged(where_, concat(list, " ", index, " is used, but is not there"));
    return (*found)[index];
  }

  /// How many elements a list at the top has.
  std::size_t count(const char* list) const {
    const auto found = parts_.json.find(list);
    return found == parts_.json.end() ? 0 : found->size();
  }

  /// A whole number of at least 0; `fallback` if it is not given.
  std::size_t whole(const nlohmann::json& in, const char* key, std::size_t fallback = missing) const {
    const auto found = in.is_object() ? in.find(key) : in.end();
    if (found == in.end() && fallback != missing) return fallback;
    if (found == in.end() || !found->is_number_unsigned() || found->get<std::uint64_t>() > 0xffffffffu)
      damaged(where_, concat("'", key, "' should be a whole number"));
    return found->get<std::size_t>();
  }

  /// `width` numbers into `out`, which are left as they are if they are not given.
  void numbers(const nlohmann::json& in, const char* key, std::size_t width, double* out) const {
    const auto found = in.find(key);
    if (found == in.end()) return;
    if (!found->is_array() || found->size() != width)
      damaged(where_, concat("'", key, "' should be ", width, " numbers"));
    for (std::size_t i = 0; i < width; ++i) {
      if (!(*found)[i].is_number()) damaged(where_, concat("'", key, "' should be ", width, " numbers"));
      out[i] = (*found)[i].get<double>();
      if (!std::isfinite(out[i]) || std::abs(out[i]) > 1e12)
        damaged(where_, concat("'", key, "' is out of range"));
    }
  }

  /// All numbers of an accessor, of `width` each; integers that stand for fractions are converted.
  std::vector<double> accessor(std::size_t index, std::size_t width) const {
    const nlohmann::json& a = element("accessors", index);
    const std::string kind =
        a.value("type", nlohmann::json()).is_string() ? a["type"].get<std::string>() : "";
    const std::size_t has = kind == "SCALAR" ? 1 : kind == "VEC3" ? 3 : kind == "VEC4" ? 4 : 0;
    if (has != width)
      damaged(where_, concat("accessor ", index, " is of type '", kind, "', expected ", width, " numbers"));
    require(!a.contains("sparse"), where_, ": accessor ", index,
            " is sparse, which is not read; export the animation without compression");
    const std::size_t type = whole(a, "componentType"), count = whole(a, "count");
    const std::size_t size = type == 5126 || type == 5125   ? 4
                             : type == 5122 || type == 5123 ? 2
                             : type == 5120 || type == 5121 ? 1
                                                            : 0;
    if (size == 0) damaged(where_, concat("accessor ", index, " has the component type ", type));
    const nlohmann::json& view = element("bufferViews", whole(a, "bufferView"));
    require(whole(view, "buffer") == 0 && !element("buffers", 0).contains("uri"), where_,
            ": its numbers are in another file, which is not read; export one binary file (.glb)");
    const std::size_t step = whole(view, "byteStride", size * width), length = whole(view, "byteLength"),
                      begin = whole(view, "byteOffset", 0), at = whole(a, "byteOffset", 0);
    if (begin + length > parts_.binary.size() || step < size * width || count > length + 1 ||
        (count > 0 && at + (count - 1) * step + size * width > length))
      damaged(where_, concat("accessor ", index, " reaches beyond the end of the file's numbers"));
    std::vector<double> out;
    out.reserve(count * width);
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t k = 0; k < width; ++k) {
        const double v = number(&parts_.binary[begin + at + i * step + k * size], type);
        if (!std::isfinite(v)) damaged(where_, concat("accessor ", index, " has a value that is not finite"));
        out.push_back(v);
      }
    return out;
  }

 private:
  static constexpr std::size_t missing = std::numeric_limits<std::size_t>::max();

  template <class T>
  static T read(const char* bytes) {
    T out;
    std::memcpy(&out, bytes, sizeof out);
    return out;
  }
  static double number(const char* bytes, std::size_t type) {
    switch (type) {  // integers are normalised
      case 5120:
        return std::max(read<std::int8_t>(bytes) / 127.0, -1.0);
      case 5121:
        return read<std::uint8_t>(bytes) / 255.0;
      case 5122:
        return std::max(read<std::int16_t>(bytes) / 32767.0, -1.0);
      case 5123:
        return read<std::uint16_t>(bytes) / 65535.0;
      case 5125:
        return read<std::uint32_t>(bytes);
      default:
        return static_cast<double>(read<float>(bytes));
    }
  }

  const GlbParts& parts_;
  const std::string& where_;
};

/// Place, rotation and scale of a node, from those or from its matrix.
inline void read_transform(const Values& values, const nlohmann::json& node, SceneNode& out) {
  values.numbers(node, "translation", 3, out.translation.data());
  values.numbers(node, "scale", 3, out.scale.data());
  std::array<double, 4> q{0, 0, 0, 1};
  values.numbers(node, "rotation", 4, q.data());
  out.rotation = normalize(Quat{q[3], q[0], q[1], q[2]});
  if (!node.contains("matrix")) return;
  std::array<double, 16> m{};
  values.numbers(node, "matrix", 16, m.data());
  Mat3 turn{};
  for (std::size_t column = 0; column < 3; ++column) {
    const Vec3 axis{m[4 * column], m[4 * column + 1], m[4 * column + 2]};
    out.scale[column] = length(axis);
    for (std::size_t row = 0; row < 3; ++row)
      turn[3 * row + column] = out.scale[column] > 0 ? axis[row] / out.scale[column] : row == column;
  }
  out.rotation = normalize(quat_from_matrix(turn));
  out.translation = {m[12], m[13], m[14]};
}

inline std::string name_of(const nlohmann::json& in) {
  const auto found = in.find("name");
  return found != in.end() && found->is_string() ? found->get<std::string>() : std::string();
}

inline SceneAnimation read_animation(const Values& values, const nlohmann::json& animation, std::size_t nodes,
                                     const std::string& where) {
  SceneAnimation out{name_of(animation), 0, {}};
  const nlohmann::json samplers = animation.value("samplers", nlohmann::json::array()),
                       channels = animation.value("channels", nlohmann::json::array());
  for (const nlohmann::json& channel : channels) {
    const nlohmann::json target = channel.value("target", nlohmann::json::object());
    const auto path = target.find("path");
    if (!target.contains("node") || path == target.end()) continue;  // extensions animate other things
    NodeTrack track;
    track.node = values.whole(target, "node");
    if (*path == "rotation")
      track.kind = TrackKind::rotation;
    else if (*path == "translation")
      track.kind = TrackKind::translation;
    else
      continue;
    const std::size_t width = track.kind == TrackKind::rotation ? 4 : 3,
                      at = values.whole(channel, "sampler");
    if (track.node >= nodes || at >= samplers.size() || !samplers[at].is_object())
      damaged(where, concat("an animation moves node ", track.node, " by sampler ", at));
    const nlohmann::json& sampler = samplers[at];
    const nlohmann::json kind = sampler.value("interpolation", nlohmann::json("LINEAR"));
    track.between = kind == "CUBICSPLINE" ? Between::cubic : kind == "STEP" ? Between::step : Between::linear;
    track.times = values.accessor(values.whole(sampler, "input"), 1);
    track.values = values.accessor(values.whole(sampler, "output"), width);
    const std::size_t each = track.between == Between::cubic ? 3 * width : width;
    if (track.times.empty() || track.values.size() != each * track.times.size())
      damaged(where, concat("an animation has ", track.times.size(), " keys with ", track.values.size(),
                            " numbers, expected ", each, " each"));
    if (!std::is_sorted(track.times.begin(), track.times.end()))
      damaged(where, "the times of an animation do not increase");
    out.tracks.push_back(std::move(track));
  }
  return out;
}

}  // namespace glb_detail

/// Takes the bytes of a GLB file apart. Throws Error, naming the file `where`, for other bytes and for a
/// version other than 2.
inline GlbParts parse_glb(std::string_view bytes, const std::string& where) {
  const auto word = [&](std::size_t at) {
    std::uint32_t out = 0;
    if (at + 4 > bytes.size()) glb_detail::damaged(where, concat("it ends after ", bytes.size(), " bytes"));
    std::memcpy(&out, bytes.data() + at, 4);
    return static_cast<std::size_t>(out);
  };
  require(bytes.starts_with("glTF"), where, " is no GLB file, which begins with \"glTF\"",
          bytes.starts_with("{") ? "; of .gltf files only the binary form (.glb) is read" : "");
  require(word(4) == 2, where, " is of glTF version ", word(4), ", expected 2");
  GlbParts out;
  for (std::size_t at = 12; at + 8 <= bytes.size();) {
    const std::size_t size = word(at), kind = word(at + 4);
    if (size > bytes.size() - at - 8)
      glb_detail::damaged(where, "a part of it ends beyond the end of the file");
    const std::string_view part = bytes.substr(at + 8, size);
    if (kind == 0x4E4F534A) {
      require(!io::nests_too_deeply(part), where, ": its JSON nests more than ", io::most_nested_json,
              " deep");
      try {
        out.json = nlohmann::json::parse(part);
      } catch (const nlohmann::json::exception& error) {
        glb_detail::damaged(where, concat("its JSON cannot be read: ", error.what()));
      }
    } else if (kind == 0x004E4942 && out.binary.empty()) {
      out.binary = part;
    }
    at += 8 + size;
  }
  if (!out.json.is_object()) glb_detail::damaged(where, "it has no JSON");
  return out;
}

/// The nodes and animations in a GLB file. Throws Error, naming the file `where`, if something points at what
/// is not there.
inline NodeScene scene_of(const GlbParts& parts, const std::string& where) {
  const glb_detail::Values values(parts, where);
  NodeScene out;
  try {
    out.nodes.resize(values.count("nodes"));
    for (std::size_t n = 0; n < out.nodes.size(); ++n) {
      const nlohmann::json& node = values.element("nodes", n);
      out.nodes[n].name = glb_detail::name_of(node);
      out.nodes[n].is_thing =
          node.contains("mesh") || node.contains("camera") ||
          (node.contains("extensions") && node["extensions"].contains("KHR_lights_punctual"));
      glb_detail::read_transform(values, node, out.nodes[n]);
      for (const nlohmann::json& child : node.value("children", nlohmann::json::array())) {
        if (!child.is_number_unsigned() || child.get<std::size_t>() >= out.nodes.size() ||
            out.nodes[child.get<std::size_t>()].parent >= 0)
          glb_detail::damaged(where,
                              concat("node ", n, " has a child that is not there or has another parent"));
        out.nodes[child.get<std::size_t>()].parent = static_cast<int>(n);
      }
    }
    for (std::size_t s = 0; s < values.count("skins"); ++s)
      for (const nlohmann::json& joint :
           values.element("skins", s).value("joints", nlohmann::json::array())) {
        if (!joint.is_number_unsigned() || joint.get<std::size_t>() >= out.nodes.size())
          glb_detail::damaged(where, concat("skin ", s, " has a joint that is not there"));
        out.nodes[joint.get<std::size_t>()].is_joint = true;
      }
    for (std::size_t a = 0; a < values.count("animations"); ++a)
      out.animations.push_back(
          glb_detail::read_animation(values, values.element("animations", a), out.nodes.size(), where));
  } catch (const nlohmann::json::exception& error) {
    glb_detail::damaged(where, concat("its JSON is not as glTF has it: ", error.what()));
  }
  return out;
}

/// Reads a GLB, VRM or VRMA file. Throws Error as parse_glb() and scene_of(), or if it cannot be read.
inline NodeScene read_glb(const std::filesystem::path& file) {
  return scene_of(parse_glb(read_text(file, "GLB file"), file.string()), file.string());
}

}  // namespace motiongan::motion

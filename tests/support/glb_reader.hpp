// A reader of GLB files for tests, written from the specification and not from the writer.
#pragma once
#include <doctest/doctest.h>

#include <cstdint>
#include <cstring>
#include <motiongan/motion/rotation.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace motiongan::testing {

using motion::Quat;
using motion::Vec3;

/// A GLB file, taken apart by the specification.
struct Glb {
  nlohmann::json json;
  std::string bytes;

  explicit Glb(const std::string& file) {
    const auto word = [&](std::size_t at) {
      std::uint32_t v = 0;
      std::memcpy(&v, file.data() + at, 4);
      return v;
    };
    REQUIRE(file.size() > 28);
    REQUIRE(file.substr(0, 4) == "glTF");
    REQUIRE(word(4) == 2);
    REQUIRE(word(8) == file.size());
    REQUIRE(file.size() % 4 == 0);
    const std::size_t text = word(12);
    REQUIRE(text % 4 == 0);
    REQUIRE(file.substr(16, 4) == "JSON");
    json = nlohmann::json::parse(file.substr(20, text));
    const std::size_t at = 20 + text;
    REQUIRE(file.substr(at + 4, 4) == std::string("BIN\0", 4));
    bytes = file.substr(at + 8, word(at));
    REQUIRE(json.at("buffers").at(0).at("byteLength") == bytes.size());
    REQUIRE(json.at("asset").at("version") == "2.0");
  }

  std::size_t width(std::size_t accessor) const {
    const std::string type = json["accessors"][accessor]["type"];
    return type == "SCALAR" ? 1 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : 16;
  }

  template <class T>
  std::vector<T> values(std::size_t accessor) const {
    const auto& a = json["accessors"][accessor];
    const auto& view = json["bufferViews"][a["bufferView"].get<std::size_t>()];
    const std::size_t n = a["count"].get<std::size_t>() * width(accessor), from = view["byteOffset"];
    REQUIRE(from % 4 == 0);
    REQUIRE(view["byteLength"] == n * sizeof(T));
    REQUIRE(from + n * sizeof(T) <= bytes.size());
    std::vector<T> out(n);
    std::memcpy(out.data(), bytes.data() + from, n * sizeof(T));
    return out;
  }

  /// Places of the nodes from `first` on, in key frame f of an animation.
  std::vector<Vec3> places(std::size_t animation, std::size_t f) const {
    const std::size_t nodes = json["nodes"].size();
    std::vector<Vec3> move(nodes, Vec3{});
    std::vector<Quat> turn(nodes);
    std::vector<int> parent(nodes, -1);
    for (std::size_t i = 0; i < nodes; ++i) {
      const auto& node = json["nodes"][i];
      if (node.contains("translation"))
        for (std::size_t a = 0; a < 3; ++a) move[i][a] = node["translation"][a];
      if (node.contains("children"))
        for (const std::size_t child : node["children"]) parent[child] = static_cast<int>(i);
    }
    const auto& made = json["animations"][animation];
    for (const auto& channel : made["channels"]) {
      const auto& sampler = made["samplers"][channel["sampler"].get<std::size_t>()];
      REQUIRE(sampler["interpolation"] == "LINEAR");
      const std::vector<float> v = values<float>(sampler["output"]);
      const std::size_t node = channel["target"]["node"];
      if (channel["target"]["path"] == "rotation")
        turn[node] = {v[4 * f + 3], v[4 * f], v[4 * f + 1], v[4 * f + 2]};
      else
        move[node] = {v[3 * f], v[3 * f + 1], v[3 * f + 2]};
    }
    std::vector<Vec3> out(nodes);
    std::vector<Quat> world(nodes);
    for (std::size_t i = 0; i < nodes; ++i) {  // parents come first
      if (parent[i] < 0) {
        out[i] = move[i], world[i] = turn[i];
        continue;
      }
      const auto p = static_cast<std::size_t>(parent[i]);
      REQUIRE(p < i);
      out[i] = motion::add(out[p], rotate(world[p], move[i])), world[i] = multiply(world[p], turn[i]);
    }
    return out;
  }
};

}  // namespace motiongan::testing

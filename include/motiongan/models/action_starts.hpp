// Starts: seconds of given motion that a class-conditioned model keeps, for it to continue where the clips
// that it was trained on are not at hand.
//
// In a model file, the metadata contain "starts", a JSON list of {"clip", "frame", "class"}; start number N
// is the tensors "start.N.poses" [T, dof], "start.N.positions" [T, joints, 3], "start.N.places" [T, 4] (x, z,
// yaw, height), "start.N.offsets" [joints, 3] and, where the clip had rotations, "start.N.rotations" [joints,
// 4] (w, x, y, z), all F32.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/data/action_prior.hpp"
#include "motiongan/io/fields_json.hpp"
#include "motiongan/io/safetensors.hpp"

namespace motiongan {

/// A second of motion to continue.
struct ActionStart {
  motion::ActionPrior prior;
  std::size_t label = 0;                ///< class of the clip that it is from
  std::vector<motion::Quat> rotations;  ///< [joints], joint rotations at its end; empty if not known
};

namespace detail {

/// Rows of numbers as the values of a tensor, and back.
template <class Row>
std::vector<float> to_floats(const std::vector<Row>& rows) {
  std::vector<float> out;
  for (const Row& row : rows)
    for (const double v : row) out.push_back(static_cast<float>(v));
  return out;
}
template <std::size_t Width>
std::vector<std::array<double, Width>> to_rows(const std::vector<double>& values) {
  std::vector<std::array<double, Width>> out(values.size() / Width);
  for (std::size_t i = 0; i < out.size() * Width; ++i) out[i / Width][i % Width] = values[i];
  return out;
}

}  // namespace detail

/// Adds starts to a model file's contents.
inline void add_starts(io::SafeTensors& file, const std::vector<ActionStart>& starts,
                       const motion::PositionFormat& format) {
  auto list = nlohmann::json::array();
  for (const ActionStart& start : starts) {
    const std::string name = concat("start.", list.size(), ".");
    const std::size_t frames = start.prior.places.size(), joints = start.prior.skeleton.size();
    list.push_back({{"clip", start.prior.id},
                    {"frame", start.prior.first_frame},
                    {"class", format.classes.at(start.label)}});
    std::vector<std::array<double, 4>> places, rotations;
    for (const motion::RootTrack& at : start.prior.places) places.push_back({at.x, at.z, at.yaw, at.height});
    for (const motion::Quat& q : start.rotations) rotations.push_back({q.w, q.x, q.y, q.z});
    std::vector<motion::Vec3> offsets;
    for (const motion::Joint& joint : start.prior.skeleton.joints) offsets.push_back(joint.offset);
    const auto add = [&](const char* part, std::vector<std::size_t> shape, const std::vector<float>& values) {
      file.tensors[name + part] = io::SafeTensor::of(std::move(shape), values);
    };
    add("poses", {frames, format.dof()}, start.prior.poses);
    add("positions", {frames, joints, 3}, detail::to_floats(start.prior.positions));
    add("places", {frames, 4}, detail::to_floats(places));
    add("offsets", {joints, 3}, detail::to_floats(offsets));
    if (!rotations.empty()) add("rotations", {joints, 4}, detail::to_floats(rotations));
  }
  file.metadata["starts"] = list.dump();
}

/// The starts in the contents of a model file; empty if it has none. Throws Error, naming the file (`where`),
/// if they do not fit the model's format.
inline std::vector<ActionStart> starts_in(const io::SafeTensors& file, const motion::PositionFormat& format,
                                          const std::string& where) {
  std::vector<ActionStart> out;
  const auto text = file.metadata.find("starts");
  if (text == file.metadata.end()) return out;
  try {
    for (const auto& entry : io::parse_json(text->second)) {
      const std::string name = concat("start.", out.size(), ".");
      const std::size_t joints = format.skeleton().size();
      ActionStart start;
      start.prior.id = entry.at("clip").get<std::string>();
      start.prior.first_frame = entry.at("frame").get<std::size_t>();
      const auto label =
          std::find(format.classes.begin(), format.classes.end(), entry.at("class").get<std::string>());
      require(label != format.classes.end(), "start ", out.size(), " is of no class of the model");
      start.label = static_cast<std::size_t>(label - format.classes.begin());
      const auto values = [&](const char* part, const std::vector<std::size_t>& shape) {
        const io::SafeTensor& tensor = file.at(name + part);
        require(tensor.shape == shape, "the tensor \"", name, part, "\" has shape ",
                io::shape_text(tensor.shape), ", expected ", io::shape_text(shape));
        std::vector<double> numbers = tensor.as<double>();
        for (const double v : numbers) require(std::isfinite(v), "the tensor \"", name, part, "\" holds ", v);
        return numbers;
      };
      const std::vector<double> poses = values("poses", {format.frames, format.dof()});
      start.prior.poses.assign(poses.begin(), poses.end());
      start.prior.positions = detail::to_rows<3>(values("positions", {format.frames, joints, 3}));
      for (const auto& [x, z, yaw, height] : detail::to_rows<4>(values("places", {format.frames, 4})))
        start.prior.places.push_back({.x = x, .z = z, .yaw = yaw, .started = true, .height = height});
      start.prior.skeleton = format.skeleton();
      const auto offsets = detail::to_rows<3>(values("offsets", {joints, 3}));
      for (std::size_t j = 0; j < joints; ++j) start.prior.skeleton.joints[j].offset = offsets[j];
      if (file.tensors.contains(name + "rotations"))
        for (const auto& [w, x, y, z] : detail::to_rows<4>(values("rotations", {joints, 4})))
          start.rotations.push_back({w, x, y, z});
      out.push_back(std::move(start));
    }
  } catch (const nlohmann::json::exception& error) {
    throw Error(where, ": the model's starts: ", error.what());
  } catch (const Error& error) {
    throw Error(where, ": the model's starts: ", error.what());
  }
  return out;
}

}  // namespace motiongan

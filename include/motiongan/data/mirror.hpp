// Mirror images of motion and its captions: left and right exchanged.
#pragma once
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/data/pose.hpp"
#include "motiongan/motion/body_side.hpp"

namespace motiongan::motion {

namespace mirror_detail {

/// The mirrored counterpart of every joint, by name; a joint of the centre is its own.
inline std::vector<std::size_t> counterparts(const Skeleton& skeleton) {
  std::vector<std::size_t> out(skeleton.size());
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const std::string& name = skeleton.joints[j].name;
    const Side side = side_of(name);
    out[j] = j;
    for (std::size_t k = 0; side != Side::centre && k < skeleton.size(); ++k)
      if (side == Side::left ? are_mirrored(name, skeleton.joints[k].name)
                             : are_mirrored(skeleton.joints[k].name, name))
        out[j] = k;
    require(side == Side::centre || out[j] != j, "the skeleton cannot be mirrored: joint '", name,
            "' has no counterpart on the other side");
  }
  return out;
}

/// The axis, x or z, along which the body's sides lie apart at rest.
inline std::size_t side_axis(const Skeleton& skeleton, const std::vector<std::size_t>& counterpart) {
  const std::vector<Vec3> rest = rest_positions(skeleton);
  double x = 0, z = 0;
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const Vec3 apart = subtract(rest[j], rest[counterpart[j]]);
    x += std::abs(apart[0]), z += std::abs(apart[2]);
  }
  return z > x ? 2 : 0;
}

}  // namespace mirror_detail

/// Mirrors poses of a body whose left and right are images of each other at rest.
class PoseMirror {
 public:
  /// Throws Error, naming the joint, if one of a side has no counterpart, or has it at a place that is not
  /// its image by more than a quarter of the bone.
  explicit PoseMirror(const PoseLayout& layout) : from_(layout.dof()), sign_(layout.dof()) {
    const Skeleton& skeleton = layout.skeleton();
    const std::vector<std::size_t> counterpart = mirror_detail::counterparts(skeleton);
    const std::size_t across = mirror_detail::side_axis(skeleton, counterpart);
    for (std::size_t j = 0; j < skeleton.size(); ++j) {
      const Joint &joint = skeleton.joints[j], &other = skeleton.joints[counterpart[j]];
      Vec3 image = joint.offset;
      image[across] = -image[across];
      require(
          layout.root() == j || length(subtract(image, other.offset)) <= 0.25 * length(joint.offset) + 1e-9,
          "the skeleton cannot be mirrored: joint '", other.name, "' is not the image of '", joint.name,
          "' at rest");
      for (std::size_t c = 0; c < 3; ++c) {
        // A rotation's axis is reflected the other way round.
        from_[3 * counterpart[j] + c] = 3 * j + c;
        sign_[3 * counterpart[j] + c] = c == across ? 1 : -1;
      }
    }
    for (std::size_t c = 0; layout.root_position() && c < 3; ++c) {
      from_[layout.position_dim() + c] = layout.position_dim() + c;
      sign_[layout.position_dim() + c] = c == across ? -1 : 1;
    }
  }

  /// Poses [frames, dof] of the mirrored motion, for every form of the root. Throws Error for another dof.
  std::vector<double> operator()(std::span<const double> poses) const {
    const std::size_t dof = from_.size();
    require(poses.size() % dof == 0, "found ", poses.size(), " pose values, expected a multiple of ", dof);
    std::vector<double> out(poses.size());
    for (std::size_t at = 0; at < poses.size(); at += dof)
      for (std::size_t d = 0; d < dof; ++d) out[at + d] = sign_[d] * poses[at + from_[d]];
    return out;
  }

 private:
  std::vector<std::size_t> from_;
  std::vector<double> sign_;
};

/// A caption of the mirrored motion: in words that begin with "left" or "right" the one is replaced by the
/// other, and "clockwise" is exchanged with "counterclockwise". Replaced words become lower-case.
inline std::string mirrored_caption(std::string_view caption) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 5> exchanged{
      {{"left", "right"},
       {"right", "left"},
       {"clockwise", "counterclockwise"},
       {"counterclockwise", "clockwise"},
       {"anticlockwise", "clockwise"}}};
  const auto letter = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; };
  std::string out;
  for (std::size_t at = 0; at < caption.size();) {
    std::string lower;
    for (std::size_t i = at; i < caption.size() && letter(caption[i]); ++i)
      lower += static_cast<char>(std::tolower(static_cast<unsigned char>(caption[i])));
    const auto found = std::find_if(exchanged.begin(), exchanged.end(),
                                    [&](const auto& pair) { return lower.starts_with(pair.first); });
    if (lower.empty()) {
      out += caption[at++];
    } else if (found == exchanged.end()) {
      out += caption.substr(at, lower.size());
      at += lower.size();
    } else {
      out += found->second;
      out += caption.substr(at + found->first.size(), lower.size() - found->first.size());
      at += lower.size();
    }
  }
  return out;
}

}  // namespace motiongan::motion

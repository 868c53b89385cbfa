// What is needed to use a trained model of positions and classes.
#pragma once
#include <algorithm>
#include <cstddef>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/data/normalizer.hpp"
#include "motiongan/data/position_layout.hpp"
#include "motiongan/formats/text_file.hpp"
#include "motiongan/motion/body.hpp"
#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/skeleton.hpp"
#include "motiongan/motion/skeleton_match.hpp"

namespace motiongan::motion {

/// A joint and its parent.
struct Bone {
  std::size_t joint = 0, parent = 0;
  friend bool operator==(const Bone&, const Bone&) = default;
};

namespace position_format_detail {

/// Levenshtein distance: insertions, deletions and substitutions that turn `a` into `b`.
inline std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t exchanged = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({exchanged, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace position_format_detail

/// Conversion between network values and joint positions, and between class names and class indices.
struct PositionFormat {
  /// Sizes beyond any model's, which a damaged file may claim.
  static constexpr std::size_t most_frames = 65536, most_dof = 65536, most_classes = 65536;

  PositionLayout layout;             ///< holds the skeleton
  Normalizer normalizer;             ///< mean and standard deviation of each dimension
  double rate = 30;                  ///< frames per second
  std::size_t frames = 30;           ///< T, frames of a prior and of a future
  std::vector<std::string> classes;  ///< names, in the order of class indices
  ClipSpace space{};  ///< unit of its motion, and the up axis of the clips that it was fitted to

  const Skeleton& skeleton() const { return layout.skeleton(); }

  /// Values per frame that a network sees.
  std::size_t dof() const { return normalizer.kept_dof(); }

  /// The bones with a rest length (a millionth of the mean or more), in joint order.
  std::vector<Bone> bones() const {
    const std::vector<double> lengths = bone_lengths(skeleton());
    double sum = 0;
    for (const double l : lengths) sum += l;
    std::vector<Bone> out;
    for (std::size_t j = 1; j < lengths.size(); ++j)
      if (lengths[j] > 0 && lengths[j] >= 1e-6 * sum / static_cast<double>(lengths.size() - 1))
        out.push_back({j, static_cast<std::size_t>(skeleton().joints[j].parent)});
    return out;
  }

  /// Mean rest length of bones(), in the file's unit; 0 if there are none.
  double mean_bone_length() const {
    const std::vector<double> lengths = bone_lengths(skeleton());
    const std::vector<Bone> all = bones();
    double sum = 0;
    for (const Bone& bone : all) sum += lengths[bone.joint];
    return all.empty() ? 0 : sum / static_cast<double>(all.size());
  }

  /// The linear map from normalised poses to vectors of bones(): bone_map() * pose + bone_shift() is joint -
  /// parent, in the body's frame, in the file's unit. [3 * bones, dof()], row-major; at most two values per
  /// row are not 0.
  std::vector<double> bone_map() const {
    const std::vector<Bone> all = bones();
    const auto& kept = normalizer.kept();
    std::vector<double> out(3 * all.size() * dof(), 0.0);
    for (std::size_t b = 0; b < all.size(); ++b)
      for (std::size_t a = 0; a < 3; ++a) {
        double* const row = &out[(3 * b + a) * dof()];
        for (std::size_t k = 0; k < kept.size(); ++k) {
          if (kept[k] == 3 * all[b].joint + a) row[k] += normalizer.std()[kept[k]];
          if (kept[k] == 3 * all[b].parent + a) row[k] -= normalizer.std()[kept[k]];
        }
      }
    return out;
  }

  /// Bone vectors of the mean pose, [3 * bones].
  std::vector<double> bone_shift() const {
    std::vector<double> out;
    for (const Bone& bone : bones())
      for (std::size_t a = 0; a < 3; ++a)
        out.push_back(normalizer.mean()[3 * bone.joint + a] - normalizer.mean()[3 * bone.parent + a]);
    return out;
  }

  /// How many of the values that a network sees are places of joints; the root's track follows.
  std::size_t kept_places() const {
    const auto& kept = normalizer.kept();
    return static_cast<std::size_t>(std::lower_bound(kept.begin(), kept.end(), 3 * skeleton().size()) -
                                    kept.begin());
  }

  /// The linear map back from vectors of bones() to normalised places: place_map() * vectors + place_shift()
  /// are the first kept_places() values of a pose. [kept_places(), 3 * bones], row-major.
  std::vector<double> place_map() const {
    const std::vector<Bone> all = bones();
    std::vector<double> out(3 * all.size() * kept_places(), 0.0);
    for (std::size_t k = 0; k < kept_places(); ++k) {
      const std::size_t dim = normalizer.kept()[k];
      for (int j = static_cast<int>(dim / 3); j > 0;
           j = skeleton().joints[static_cast<std::size_t>(j)].parent) {
        const auto bone = std::find_if(all.begin(), all.end(),
                                       [&](const Bone& b) { return b.joint == static_cast<std::size_t>(j); });
        if (bone == all.end()) continue;
        const auto b = static_cast<std::size_t>(bone - all.begin());
        out[k * 3 * all.size() + 3 * b + dim % 3] = 1 / normalizer.std()[dim];
      }
    }
    return out;
  }

  /// The normalised places of a body without any length, [kept_places()].
  std::vector<double> place_shift() const {
    std::vector<double> out;
    for (std::size_t k = 0; k < kept_places(); ++k) {
      const std::size_t dim = normalizer.kept()[k];
      out.push_back(-normalizer.mean()[dim] / normalizer.std()[dim]);
    }
    return out;
  }

  /// World positions [frames, joints] as a network sees them, [frames, dof()].
  std::vector<float> encode(std::span<const Vec3> positions) const {
    return normalizer.normalize<float>(layout.encode(positions));
  }

  /// World positions [frames, joints] of normalised poses [frames, dof()]; for `track` see
  /// PositionLayout::decode.
  std::vector<Vec3> decode(std::span<const float> poses, RootTrack* track = nullptr) const {
    return layout.decode(normalizer.denormalize(poses), track);
  }

  /// World positions [frames, joints] of normalised poses [frames, dof()] placed at `places` [frames].
  std::vector<Vec3> restore(std::span<const float> poses, std::span<const RootTrack> places) const {
    return layout.restore(normalizer.denormalize(poses), places);
  }

  /// Index of the class. Throws Error, listing the classes and suggesting the most similar one, for an
  /// unknown name.
  std::size_t class_index(std::string_view name) const {
    std::string known;
    std::size_t best = 0, fewest = static_cast<std::size_t>(-1);
    for (std::size_t c = 0; c < classes.size(); ++c) {
      if (classes[c] == name) return c;
      known += (c > 0 ? ", '" : "'") + classes[c] + "'";
      const std::size_t apart = position_format_detail::edit_distance(name, classes[c]);
      if (apart < fewest) fewest = apart, best = c;
    }
    const bool alike = !classes.empty() && 2 * fewest <= std::max<std::size_t>(name.size(), 2);
    throw Error("there is no class '", name, "'",
                alike ? "; did you mean '" + classes[best] + "'?" : std::string("."),
                " The classes are: ", known.empty() ? std::string("none") : known);
  }

  /// Throws Error, naming the joints, unless `other` has the same joints as this format; bone lengths and
  /// channels may differ. `what` names its owner in the message, such as "the prior walk.bvh".
  void require_skeleton(const Skeleton& other, const std::string& what) const {
    require_same_joints(skeleton(), other, what);
  }

  /// Throws Error unless the members are consistent.
  void check() const {
    require(skeleton().size() > 0, "a position format has no skeleton");
    require(layout.dof() <= most_dof, "a position format has ", layout.dof(),
            " pose dimensions, expected at most ", most_dof);
    require(normalizer.full_dof() == layout.dof(), "a normalizer of ", normalizer.full_dof(),
            " dimensions does not fit a pose of ", layout.dof());
    require(dof() > 0, "all ", layout.dof(), " pose dimensions are constant: nothing moves");
    require(rate > 0 && rate < 1e6, "a position format has a rate of ", rate,
            " frames per second, expected more than 0");
    require(frames > 0 && frames <= most_frames, "a position format has windows of ", frames,
            " frames, expected 1 to ", most_frames);
    require(classes.size() <= most_classes, "a position format has ", classes.size(),
            " classes, expected at most ", most_classes);
    require(!classes.empty(), "a position format has no classes, expected at least one");
    std::set<std::string_view> seen;
    for (const std::string& name : classes) {
      require(!name.empty() && is_utf8(name), "the class '", name,
              "' is empty or not UTF-8, expected a name");
      require(seen.insert(name).second, "two classes are called '", name, "'");
    }
  }
};

}  // namespace motiongan::motion

// The bones of normalised poses of positions: their vectors and lengths, and poses whose bones keep theirs.
#pragma once
#include <algorithm>

#include "motiongan/data/position_format.hpp"
#include "motiongan/ops/conv1d.hpp"

namespace motiongan {

/// Maps between normalised motion [T, B, dof] and its bones, in the file's unit. Bones of zero rest length
/// are left out.
class Bones {
 public:
  /// Throws Error if no bone has a length.
  Bones(const Context& context, const motion::PositionFormat& format)
      : bones_(format.bones().size()), mean_length_(format.mean_bone_length()) {
    require(bones_ > 0,
            "the skeleton has no bone of non-zero length; the skeleton loss and exact bones need "
            "at least one");
    const auto constant = [&](const Shape& shape, const std::vector<double>& values) {
      return Var::constant(Tensor::from(context, shape, values));
    };
    map_ = constant({1, 3 * bones_, format.dof()}, format.bone_map());
    shift_ = constant({3 * bones_}, format.bone_shift());
    places_ = format.kept_places();
    back_ = constant({1, places_, 3 * bones_}, format.place_map());
    back_shift_ = constant({places_}, format.place_shift());
  }

  std::size_t count() const { return bones_; }
  /// Mean rest length, in the file's unit.
  double mean_length() const { return mean_length_; }

  /// Vectors from parent to joint, [T, B, 3 * count()], in the body's frame.
  Var vectors(const Var& motion) const { return linear(motion, map_, {.bias = shift_}); }

  /// Lengths of such vectors, [T, B, count()].
  Var lengths(const Var& vectors) const {
    return sqrt(sum(square(reshape(vectors, {vectors.dim(0), vectors.dim(1), bones_, 3})), -1) + 1e-12);
  }

  /// Unit vectors from parent to joint, [T, B, 3 * count()].
  Var directions(const Var& motion) const {
    const Shape by_bone{motion.dim(0), motion.dim(1), bones_, 3};
    const Var along = vectors(motion);
    return reshape(
        reshape(along, by_bone) /
            broadcast_to(reshape(lengths(along), {motion.dim(0), motion.dim(1), bones_, 1}), by_bone),
        along.shape());
  }

  /// The motion [T, B, dof] whose bones point as those of `motion` do and are as long as those of `pose` [1,
  /// B, dof]; the root's track is that of `motion`. A bone of length 0 in `motion` stays one.
  Var with_lengths_of(const Var& pose, const Var& motion) const {
    const std::size_t frames = motion.dim(0), batch = motion.dim(1);
    const Shape by_bone{frames, batch, bones_, 3};
    const Var longs = broadcast_to(reshape(lengths(vectors(pose)), {1, batch, bones_, 1}), by_bone);
    const Var made = reshape(directions(motion), by_bone) * longs;
    Var places = linear(reshape(made, {frames, batch, 3 * bones_}), back_, {.bias = back_shift_});
    if (places_ == motion.dim(2)) return places;
    return concatenate({places, slice(motion, 2, places_, motion.dim(2) - places_)}, 2);
  }

 private:
  std::size_t bones_, places_ = 0;
  double mean_length_;
  Var map_, shift_, back_, back_shift_;
};

}  // namespace motiongan

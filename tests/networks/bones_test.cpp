// Bones of normalised poses: lengths, and motion whose bones keep theirs.
#include <doctest/doctest.h>

#include <motiongan/networks/bones.hpp>
#include <motiongan/procedural/procedural.hpp>

#include "../support/check_grads.hpp"
#include "../support/messages.hpp"

namespace bones_test {

using namespace motiongan;
using namespace motiongan::testing;

namespace {

/// A format whose normalizer is fitted to a walk, with or without the root's track.
motion::PositionFormat format_of(const motion::Motion& walk, bool track) {
  motion::PositionFormat format;
  format.layout = motion::PositionLayout(walk.skeleton, track);
  format.normalizer =
      motion::Normalizer::fit(format.layout.encode(joint_positions(walk)), format.layout.dof());
  format.classes = {"walk"};
  format.check();
  return format;
}

std::vector<double> lengths_of(const motion::PositionFormat& format, const std::vector<float>& poses) {
  const std::vector<motion::Vec3> places = format.decode(poses);
  const std::size_t joints = format.skeleton().size();
  std::vector<double> out;
  for (std::size_t f = 0; f < places.size() / joints; ++f)
    for (const motion::Bone& bone : format.bones())
      out.push_back(motion::length(
          motion::subtract(places[f * joints + bone.joint], places[f * joints + bone.parent])));
  return out;
}

}  // namespace

TEST_CASE("motion takes the bone lengths of a pose, and keeps directions and the root's track" *
          doctest::test_suite("double")) {
  const motion::Motion walk = motion::procedural_motion(0, {.seconds = 1}).motion;
  for (const bool track : {false, true}) {
    const motion::PositionFormat format = format_of(walk, track);
    const std::size_t dof = format.dof(), count = format.bones().size(), frames = 6, batch = 2;
    const Bones bones(double_context(), format);
    REQUIRE(bones.count() == count);
    const std::vector<float> poses = format.encode(joint_positions(walk));
    const auto rows = [&](std::size_t first, std::size_t n, double stretch, double noise) {
      std::vector<double> out;
      for (std::size_t f = 0; f < n; ++f)
        for (std::size_t b = 0; b < batch; ++b)
          for (std::size_t d = 0; d < dof; ++d)
            out.push_back(stretch * poses[(first + f + 3 * b) * dof + d] + noise * randn({1}).values[0]);
      return Var::constant(Tensor::from(double_context(), {n, batch, dof}, out));
    };
    const Var pose = rows(0, 1, 1, 0), wild = rows(4, frames, 1.5, 0.5);
    const Var made = bones.with_lengths_of(pose, wild);
    REQUIRE(made.shape() == wild.shape());
    const std::vector<double> is = bones.lengths(bones.vectors(made)).value().to_host<double>(),
                              wish = bones.lengths(bones.vectors(pose)).value().to_host<double>();
    for (std::size_t i = 0; i < is.size(); ++i)
      CHECK(is[i] == doctest::Approx(wish[i % wish.size()]).epsilon(1e-6));
    const std::vector<double> before = bones.vectors(wild).value().to_host<double>(),
                              after = bones.vectors(made).value().to_host<double>(),
                              long_before = bones.lengths(bones.vectors(wild)).value().to_host<double>();
    for (std::size_t i = 0; i < before.size(); ++i)
      CHECK(after[i] * long_before[i / 3] == doctest::Approx(before[i] * is[i / 3]).epsilon(1e-6));
    const std::vector<double> all = made.value().to_host<double>(), given = wild.value().to_host<double>();
    for (std::size_t i = 0; track && i < all.size(); ++i)
      if (i % dof >= format.kept_places()) CHECK(all[i] == given[i]);
    // Motion whose bones are as long already stays as it is, and the files have the lengths too.
    const Var real = rows(4, frames, 1, 0);
    const std::vector<double> same = bones.with_lengths_of(pose, real).value().to_host<double>(),
                              was = real.value().to_host<double>();
    for (std::size_t i = 0; i < same.size(); ++i) CHECK(same[i] == doctest::Approx(was[i]).epsilon(1e-4));
    const std::vector<double> real_lengths = lengths_of(format, poses),
                              in_file = lengths_of(format, std::vector<float>(all.begin(), all.end()));
    for (std::size_t i = 0; i < in_file.size(); ++i)
      CHECK(in_file[i] == doctest::Approx(real_lengths[i % count]).epsilon(1e-4));
  }
}

TEST_CASE("derivatives to the second, also of a bone that has collapsed" * doctest::test_suite("double")) {
  const motion::PositionFormat format = format_of(motion::procedural_motion(0, {.seconds = 1}).motion, true);
  const Bones bones(double_context(), format);
  const Input pose = randn({1, 2, format.dof()}), motion = randn({2, 2, format.dof()});
  CHECK(check_grads(
            double_context(), [&](auto& v) { return bones.with_lengths_of(v[0], v[1]); }, {pose, motion}, 2) <
        1e-6);
  // The pose that place_shift() describes has no lengths.
  std::vector<double> none = format.place_shift();
  none.resize(format.dof());
  const Var collapsed = Var::leaf(Tensor::from(double_context(), {1, 1, format.dof()}, none));
  const Var made = bones.with_lengths_of(
      Var::constant(Tensor::from(double_context(), {1, 1, format.dof()}, randn({format.dof()}).values)),
      collapsed);
  for (const double v : grad(sum(square(made)), {collapsed})[0].value().to_host<double>())
    CHECK(std::isfinite(v));
}

TEST_CASE("a skeleton without lengths has no bones" * doctest::test_suite("double")) {
  motion::Motion point;
  point.skeleton.joints.resize(2);
  point.skeleton.joints[1].parent = 0;
  motion::PositionFormat format;
  format.layout = motion::PositionLayout(point.skeleton);
  format.normalizer = motion::Normalizer(std::vector<double>(10, 0.0), std::vector<double>(10, 1.0));
  format.classes = {"walk"};
  CHECK(says(message_of([&] { Bones(double_context(), format); }), "no bone of non-zero length"));
}

}  // namespace bones_test

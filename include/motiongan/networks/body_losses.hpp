// Losses of a generator on what is seen of the body: how much it trembles and how its feet stand, beside real
// motion. Not in the papers.
#pragma once
#include <cmath>
#include <vector>

#include "motiongan/core/fields.hpp"
#include "motiongan/motion/percentile.hpp"
#include "motiongan/networks/body_view.hpp"

namespace motiongan {

/// Weights of the losses; 0: not used.
struct BodyLossOptions {
  double smooth = 0, contact = 0;

  /// Whether there is a loss at all.
  bool any() const { return smooth > 0 || contact > 0; }

  void list_fields(FieldList& list) {
    list.add(smooth, {.key = "loss_smooth",
                      .help = "weight of the generator's loss where joints accelerate more than in the "
                              "clips; 0: none",
                      .range = Range::at_least(0)});
    list.add(contact, {.key = "loss_contact",
                       .help = "weight of the generator's loss where feet near the floor slide more than in "
                               "the clips, or are there less often; 0: none",
                       .range = Range::at_least(0)});
  }
};

/// Compares a batch of generated with a batch of real motion, both as BodyView shows them, by statistics of
/// the whole batches: no motion has to be like another one.
///
/// - Smoothness: for every joint the mean square of the second and of the third difference of its place over
///   time (acceleration and jerk). The loss is the mean over joints of max(0, log(generated / real))^2.
/// - Contact, for every foot: with w = sigmoid((threshold - height) / softness), which is 1 near the floor,
///   the mean of v^2 / (v^2 + slow^2) weighted by w, that is, how much of the time near the floor the foot
///   moves, compared in the same way, and the squared difference of the mean w. v is its speed over the
///   ground, slow 0.3 legs per second. The threshold is a twentieth of a leg above the floor, which is where
///   the lowest tenth of the foot's heights in real motion begins.
class BodyLosses {
 public:
  /// `real` [N, B, dof]: normalised windows, from which the floor is taken; `format` one of rotations or
  /// positions. Throws Error for a contact loss and a skeleton without feet.
  template <class Format>
  BodyLosses(const Format& format, const BodyLossOptions& options, const Tensor& real)
      : options_(options), view_(real.context(), format) {
    if (options.contact <= 0) return;
    const Var seen = view_(Var::constant(real));
    for (const std::size_t joint : motion::find_feet(format.skeleton())) {
      const std::size_t at = view_.joint(joint);
      const std::vector<double> heights = column(seen, view_.heights() + at).value().to_host<double>();
      feet_.push_back({at, motion::percentile(heights, 0.1) + place_scale / 20});
    }
  }

  /// The loss, [1], of generated beside real motion, both normalised, [N, B, dof]. Needs 4 frames.
  Var operator()(const Var& made, const Var& real) const {
    require(made.dim(0) >= 4, "BodyLosses: motion of ", made.dim(0),
            " frames, expected at least 4: jerk is a third difference");
    const Var fake = view_(made), truth = view_(real.detach());
    Var loss = zeros(made.context(), {1});
    if (options_.smooth > 0) {
      Var f = velocities(fake), t = velocities(truth);
      for (int order = 2; order <= 3; ++order) {
        f = difference(f), t = difference(t);
        loss = weighted_sum(loss, 1, excess(power(f), power(t)), options_.smooth);
      }
    }
    for (const Foot& foot : feet_) {
      const Near f = near_floor(fake, foot), t = near_floor(truth, foot);
      loss = weighted_sum(loss, 1, excess(f.slide, t.slide), options_.contact);
      loss = weighted_sum(loss, 1, square(f.share - t.share), options_.contact);
    }
    return loss;
  }

 private:
  static constexpr double place_scale = BodyView::place_scale, softness = place_scale / 50,
                          slow = 0.3;  // legs per second

  struct Foot {
    std::size_t joint;  // in the view
    double threshold;   // as heights in the view
  };
  struct Near {
    Var slide, share;  // each [1]
  };

  static Var column(const Var& seen, std::size_t at) {
    return reshape(slice(seen, 2, at, 1), {seen.dim(0) * seen.dim(1)});
  }

  /// [N, B, 3 * joints].
  Var velocities(const Var& seen) const { return slice(seen, 2, view_.speeds(), 3 * view_.joints()); }
  static Var difference(const Var& v) { return slice(v, 0, 1, v.dim(0) - 1) - slice(v, 0, 0, v.dim(0) - 1); }
  /// The mean square of every joint's values, [joints].
  Var power(const Var& v) const {
    const std::size_t rows = v.dim(0) * v.dim(1) * 3;
    return sum(square(reshape(v, {rows, view_.joints()})), 0, 1 / static_cast<double>(rows));
  }
  static Var excess(const Var& made, const Var& real) {
    return mean(square(relu(log(made + 1e-6) - log(real + 1e-6))));
  }

  Near near_floor(const Var& seen, const Foot& foot) const {
    const Var height = column(seen, view_.heights() + foot.joint);
    const Var near = sigmoid(affine(height, -1 / softness, foot.threshold / softness));
    const Var speed = square(column(seen, view_.speeds() + foot.joint)) +
                      square(column(seen, view_.speeds() + 2 * view_.joints() + foot.joint));
    const Var share = mean(near);
    return {mean(near * (speed / (speed + slow * slow))) / (share + 1e-6), share};
  }

  BodyLossOptions options_;
  BodyView view_;
  std::vector<Foot> feet_;
};

}  // namespace motiongan

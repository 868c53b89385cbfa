// Evaluation of action models against real futures (Malek-Podjaski & Deligianni, Fig. 2).
#pragma once
#include <cmath>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "motiongan/experiments/evaluation_windows.hpp"
#include "motiongan/metrics/joint_angle.hpp"
#include "motiongan/metrics/position_metrics.hpp"
#include "motiongan/sample/action_stream.hpp"

namespace motiongan {

/// A model as a function: for each prior [T, dof] of class labels[i], the next `frames` frames [frames, dof],
/// all normalised.
using FutureMaker = std::function<std::vector<std::vector<float>>(
    std::span<const std::vector<float>> priors, std::span<const std::size_t> labels, std::size_t frames)>;

/// The autoregressive rollout of a model, which must outlive the returned function. Window i uses noise
/// sample i of `seed`, if the model takes noise.
inline FutureMaker future_maker(const ActionGan& model, std::uint64_t seed = 1) {
  return [&model, seed](std::span<const std::vector<float>> priors, std::span<const std::size_t> labels,
                        std::size_t frames) {
    const std::size_t length = model.format().frames;
    ActionStream stream(model);
    std::vector<ActionStream::Id> ids;
    for (std::size_t i = 0; i < priors.size(); ++i) {
      ActionPrior prior;
      prior.id = concat("of window ", i);
      prior.poses = priors[i];
      prior.skeleton = model.format().skeleton();
      prior.places.resize(length);  // only poses are used, so the root track may be zero
      ids.push_back(stream.add(
          {.prior = &prior, .label = labels[i], .seed = seed, .sample = static_cast<std::uint32_t>(i)}));
    }
    std::vector<std::vector<float>> out(priors.size());
    for (std::size_t done = 0; done < frames; done += length) {
      const std::size_t now = std::min(length, frames - done);
      stream.step(now);
      for (std::size_t i = 0; i < ids.size(); ++i) {
        const std::span<const float> poses = stream.poses(ids[i]);
        out[i].insert(out[i].end(), poses.begin(), poses.end());
      }
    }
    return out;
  };
}

/// The zero-velocity baseline: holds the prior's last pose, with the root at rest. The format must outlive
/// the returned function.
inline FutureMaker stand_still(const motion::PositionFormat& format) {
  return [&format](std::span<const std::vector<float>> priors, std::span<const std::size_t>,
                   std::size_t frames) {
    const std::size_t dof = format.dof();
    std::vector<std::vector<float>> out;
    for (const std::vector<float>& prior : priors) {
      std::vector<double> pose = format.normalizer.denormalize(std::span(prior).last(dof));
      if (format.layout.root_track())
        for (const std::size_t part : {0u, 1u, 3u}) pose[format.layout.track_dim() + part] = 0;
      const std::vector<float> held = format.normalizer.normalize<float>(pose);
      std::vector<float> all;
      for (std::size_t f = 0; f < frames; ++f) all.insert(all.end(), held.begin(), held.end());
      out.push_back(std::move(all));
    }
    return out;
  };
}

/// Measures of a model's motion, or of the real motion, over all windows. Lengths are in the files' unit
/// times EvaluationOptions::unit_metres.
struct ActionMeasures {
  std::vector<double> angles;  ///< [frames], degrees: mean angle between adjacent bones (the paper's Fig. 2)
  /// Mean over frames of |mean angle - mean angle of the real motion|, in degrees: the distance between the
  /// two curves of Fig. 2. Errors of opposite sign in different windows cancel.
  double curve_error = 0;
  double curve_error_first = 0;  ///< the same over the first T frames
  double curve_error_last = 0;   ///< the same over the last T frames
  /// Mean over windows and frames of |angle - real angle of that window and frame|, in degrees. Errors cancel
  /// only within a pose.
  double window_error = 0;
  double window_error_deviation = 0;  ///< its standard deviation between windows
  double bone_error = 0;              ///< mean |length / length in the prior's first frame - 1|, in percent
  /// Fraction of windows with a bone-length error above 100% (or NaN) over the last T frames: collapsed
  /// motion. A few such windows dominate the means of a long rollout.
  double broken = 0;
  /// Mean displacement of the joints at the seams: from the prior to the first generated frame, and every T
  /// frames after it, where a generator is fed its own output. Real motion moves there too; compare with it.
  double seam = 0;
  double seam_body = 0;   ///< the same without the root's displacement
  double first_seam = 0;  ///< the first seam alone, from the prior to the first generated frame
  double step = 0;        ///< median displacement of the joints between frames, mean over windows
  double speed = 0;       ///< of the root over the ground, per second
  double distance = 0;    ///< of the root, straight from first to last frame
};

/// Options of ActionEvaluation.
struct EvaluationOptions {
  std::size_t windows = 96;  ///< maximum number of windows
  std::size_t frames = 70;   ///< frames after each prior; the paper: 70 at 30 Hz
  double unit_metres = 1;    ///< metres per unit of the files; 1 keeps their unit
  std::uint64_t seed = 1;    ///< seed of the choice of windows
};

/// Measures models on the test clips of a data set, which must outlive it.
class ActionEvaluation {
 public:
  /// Throws Error if no test clip is long enough.
  ActionEvaluation(const motion::ActionDataset& data, const EvaluationOptions& options = {})
      : data_(data),
        options_(options),
        windows_(choose_windows(data, options.frames, options.windows, options.seed)) {
    for (const EvaluationWindow& w : windows_.windows) {
      const motion::ActionClip& clip = data_.test[w.clip];
      const std::size_t length = format().frames, dof = format().dof();
      const std::span<const float> poses(clip.poses);
      const std::span<const float> prior = poses.subspan(w.start * dof, length * dof);
      priors_.emplace_back(prior.begin(), prior.end());
      labels_.push_back(w.label);
      real_.push_back(format().restore(poses.subspan(w.start * dof, (length + options.frames) * dof),
                                       std::span(clip.places).subspan(w.start, length + options.frames)));
    }
    for (const auto& clip : real_) real_angles_.push_back(angles_of(future_of(clip)));
    truth_ = measure_positions(real_, true);
  }

  const motion::PositionFormat& format() const { return data_.format; }
  const EvaluationOptions& options() const { return options_; }
  const EvaluationWindows& windows() const { return windows_; }
  /// The priors of all windows, normalised.
  const std::vector<std::vector<float>>& priors() const { return priors_; }
  /// The class of each window.
  const std::vector<std::size_t>& labels() const { return labels_; }

  /// The measures of the real motion; its errors are 0.
  const ActionMeasures& truth() const { return truth_; }

  /// The real positions of each window, [T + frames, joints], in world space.
  const std::vector<std::vector<motion::Vec3>>& real() const { return real_; }

  /// Each prior with a model's continuation of `frames` frames, [T + frames, joints], in world space. Throws
  /// Error if the model returns another number of values.
  std::vector<std::vector<motion::Vec3>> positions(const FutureMaker& maker, std::size_t frames) const {
    const std::size_t length = format().frames, joints = format().skeleton().size();
    const std::vector<std::vector<float>> made = maker(priors_, labels_, frames);
    require(made.size() == priors_.size(), "a model made ", made.size(), " motions for ", priors_.size(),
            " priors");
    std::vector<std::vector<motion::Vec3>> out;
    for (std::size_t i = 0; i < made.size(); ++i) {
      require(made[i].size() == frames * format().dof(), "a model made ", made[i].size(),
              " values, expected ", frames, " frames x ", format().dof(), " channels");
      std::vector<motion::Vec3> all(real_[i].begin(),
                                    real_[i].begin() + static_cast<std::ptrdiff_t>(length * joints));
      const EvaluationWindow& w = windows_.windows[i];
      motion::RootTrack track = data_.test[w.clip].places[w.start + length - 1];
      const std::vector<motion::Vec3> future = format().decode(made[i], &track);
      all.insert(all.end(), future.begin(), future.end());
      out.push_back(std::move(all));
    }
    return out;
  }

  /// Measures a model against the real motion.
  ActionMeasures measure(const FutureMaker& maker) const {
    return measure_positions(positions(maker, options_.frames), true);
  }

  /// Measures positions() of any length without comparing with the real motion: angle errors are 0. Throws
  /// Error unless there is one motion per window.
  ActionMeasures measure_alone(const std::vector<std::vector<motion::Vec3>>& all) const {
    require(all.size() == real_.size() && !all.front().empty(), "found positions of ", all.size(),
            " motions, expected ", real_.size(), " (one for each window)");
    return measure_positions(all, false);
  }

 private:
  std::span<const motion::Vec3> future_of(const std::vector<motion::Vec3>& all) const {
    return std::span(all).subspan(format().frames * format().skeleton().size());
  }

  std::vector<double> angles_of(std::span<const motion::Vec3> positions) const {
    return mean_joint_angle(format().skeleton(), positions);
  }

  ActionMeasures measure_positions(const std::vector<std::vector<motion::Vec3>>& all,
                                   bool against_real) const {
    const std::size_t joints = format().skeleton().size(), length = format().frames;
    const std::size_t frames = all.front().size() / joints - length;
    const double count = static_cast<double>(all.size());
    const auto share = [](std::size_t of) { return 1 / static_cast<double>(of); };
    ActionMeasures out;
    out.angles.assign(frames, 0);
    std::vector<double> real(frames, 0), errors;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const std::span<const motion::Vec3> both(all[i]), future = future_of(all[i]);
      const std::vector<double> angles = angles_of(future);
      double error = 0;
      for (std::size_t f = 0; f < frames; ++f) {
        out.angles[f] += angles[f] / count;
        if (!against_real) continue;
        real[f] += real_angles_[i][f] / count;
        error += std::abs(angles[f] - real_angles_[i][f]) * share(frames);
      }
      errors.push_back(error);
      out.bone_error += bone_length_error(format().skeleton(), future, both.first(joints)) / count;
      const auto last_part = future.last(std::min(frames, length) * joints);
      const double at_last = bone_length_error(format().skeleton(), last_part, both.first(joints));
      out.broken += (at_last <= 100 ? 0 : 1) / count;  // NaN counts as broken
      const std::size_t seams = (frames + length - 1) / length;
      for (std::size_t s = 1; s <= seams; ++s) {
        const FrameStep jump = seam_jump(both.subspan((s * length - 1) * joints, joints),
                                         both.subspan(s * length * joints, joints), options_.unit_metres);
        out.seam += jump.world * share(seams) / count;
        out.seam_body += jump.body * share(seams) / count;
        if (s == 1) out.first_seam += jump.world / count;
      }
      // From the prior's last frame on, so that there are as many steps as generated frames.
      const auto from_prior = both.subspan((length - 1) * joints);
      out.step += median_step(from_prior, joints, options_.unit_metres).world / count;
      const Distance way = distance_travelled(from_prior, joints, options_.unit_metres);
      out.speed += way.path * format().rate * share(frames) / count;
      out.distance += way.net / count;
    }
    if (!against_real) return out;
    const std::size_t part = std::min(frames, length);
    for (std::size_t f = 0; f < frames; ++f) {
      const double error = std::abs(out.angles[f] - real[f]);
      out.curve_error += error * share(frames);
      if (f < part) out.curve_error_first += error * share(part);
      if (f + part >= frames) out.curve_error_last += error * share(part);
    }
    double squares = 0;
    for (const double e : errors) out.window_error += e / count;
    for (const double e : errors) squares += (e - out.window_error) * (e - out.window_error);
    if (errors.size() > 1) out.window_error_deviation = std::sqrt(squares / (count - 1));
    return out;
  }

  const motion::ActionDataset& data_;
  EvaluationOptions options_;
  EvaluationWindows windows_;
  std::vector<std::vector<float>> priors_;  // [T, dof] each
  std::vector<std::size_t> labels_;
  std::vector<std::vector<motion::Vec3>> real_;   // [T + frames, joints] each
  std::vector<std::vector<double>> real_angles_;  // [frames] each
  ActionMeasures truth_;
};

}  // namespace motiongan

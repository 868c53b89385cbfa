// Normalised power spectrum similarity (NPSS) of predicted and true motion.
#pragma once
#include <cmath>
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/metrics/euler_error.hpp"
#include "motiongan/motion/kinematics.hpp"

namespace motiongan {

/// How the power of a Fourier coefficient X is computed.
enum class SpectralPower {
  magnitude,  ///< |X|^2, the paper's definition
  real_part,  ///< (Re X)^2, as in the paper's code and its derivatives; to reproduce their numbers
};

/// Normalised power spectrum similarity (Gopalakrishnan et al. 2019, A Neural Temporal Model for Human Motion
/// Prediction, eq. 9-11) of predicted and true sequences, accumulated pair by pair. It is 0 for equal
/// spectra, lower is better. It has no unit but grows with the length of the sequences, so compare sequences
/// of one length.
///
/// Each dimension's power spectra over the frequencies 0 .. frames - 1 are normalised to sum to 1 and
/// compared by the earth mover's distance sum_w |cumulative true - cumulative predicted|; the mean over
/// dimensions and sequences is weighted by the true power. A dimension whose mean is far from 0 has most of
/// its power at frequency 0, so its movement contributes little.
class Npss {
 public:
  explicit Npss(SpectralPower power = SpectralPower::magnitude) : kind_(power) {}

  /// Adds a pair of sequences [frames, width], usually of angles in radians (the unit cancels out). Throws
  /// Error if the sizes do not fit.
  void add(std::span<const double> truth, std::span<const double> prediction, std::size_t frames) {
    require(frames > 0 && truth.size() == prediction.size() && truth.size() % frames == 0, "found ",
            truth.size(), " true and ", prediction.size(),
            " predicted values, expected the same number in both, a multiple of ", frames, " frames");
    const std::size_t width = truth.size() / frames;
    turns_.resize(frames);
    for (std::size_t i = 0; i < frames; ++i)
      turns_[i] = std::polar(1.0, -2 * motion::pi * static_cast<double>(i) / static_cast<double>(frames));
    for (std::size_t d = 0; d < width; ++d) {
      const std::vector<double> a = powers(truth, d, width), b = powers(prediction, d, width);
      double sum_a = 0, sum_b = 0, ahead = 0, distance = 0;
      for (std::size_t w = 0; w < frames; ++w) sum_a += a[w], sum_b += b[w];
      if (!(sum_a > 0)) continue;  // its weight is 0
      for (std::size_t w = 0; w < frames; ++w) {
        ahead += a[w] / sum_a - (sum_b > 0 ? b[w] / sum_b : 0);
        distance += std::abs(ahead);
      }
      weighted_ += sum_a * distance;
      weight_ += sum_a;
    }
    ++sequences_;
  }

  /// The number of pairs added so far.
  std::size_t sequences() const { return sequences_; }

  /// The NPSS of all pairs; 0 if the true sequences have no power. Throws Error if no pair was added.
  double value() const {
    require(sequences_ > 0, "no sequence was added; NPSS needs at least one pair of them");
    return weight_ > 0 ? weighted_ / weight_ : 0;
  }

 private:
  /// Power spectrum of one dimension, [frames], by a plain DFT: sequences are short.
  std::vector<double> powers(std::span<const double> values, std::size_t d, std::size_t width) const {
    const std::size_t frames = turns_.size();
    std::vector<double> out(frames);
    for (std::size_t w = 0; w < frames; ++w) {
      std::complex<double> sum = 0;
      for (std::size_t t = 0, at = 0; t < frames; ++t, at = (at + w) % frames)
        sum += values[t * width + d] * turns_[at];
      out[w] = kind_ == SpectralPower::magnitude ? std::norm(sum) : sum.real() * sum.real();
    }
    return out;
  }

  SpectralPower kind_;
  std::vector<std::complex<double>> turns_;  // e^(-2 pi i t / frames)
  double weighted_ = 0, weight_ = 0;
  std::size_t sequences_ = 0;
};

/// A motion's Euler angles for NPSS, [frames, 3 * (joints - 1)] in radians: of all local rotations but that
/// of `root`, inverted as in the motion-prediction papers' text files, as in euler_errors().
inline std::vector<double> prediction_angles(const motion::Motion& motion, std::size_t root = 0) {
  motion::check_motion(motion);
  std::vector<double> out;
  for (std::size_t f = 0; f < motion.frames; ++f)
    for (std::size_t j = 0; j < motion.skeleton.size(); ++j) {
      if (j == root) continue;
      const motion::Vec3 r = motion::expmap_from_quat(motion::inverse(motion.rotation(f, j)));
      for (const double angle : prediction_euler(r)) out.push_back(angle);
    }
  return out;
}

}  // namespace motiongan

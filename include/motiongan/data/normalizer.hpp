// Normalisation of pose dimensions to zero mean and unit deviation; constant dimensions are dropped.
#pragma once
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"

namespace motiongan::motion {

/// Mean and standard deviation of every pose dimension. Dimensions with a deviation below `min_std` are
/// dropped, and restored as their mean.
class Normalizer {
 public:
  /// Dimensions that vary less are left out.
  static constexpr double min_std = 1e-4;

  Normalizer() = default;

  /// Both [full dof]. Throws Error if the sizes differ, a value is not finite or a deviation is negative.
  Normalizer(std::vector<double> mean, std::vector<double> std)
      : mean_(std::move(mean)), std_(std::move(std)) {
    require(mean_.size() == std_.size(), "a normalizer got ", mean_.size(), " means and ", std_.size(),
            " standard deviations, expected equal numbers");
    for (std::size_t d = 0; d < mean_.size(); ++d) {
      require(std::isfinite(mean_[d]) && std::isfinite(std_[d]) && std_[d] >= 0, "dimension ", d,
              " has mean ", mean_[d], " and standard deviation ", std_[d],
              ", expected finite numbers and no negative deviation");
      if (std_[d] >= min_std) kept_.push_back(d);
    }
  }

  /// Statistics of poses [frames, full dof]; deviations divide by the number of frames (ddof 0). Throws Error
  /// if there is no frame.
  static Normalizer fit(std::span<const double> poses, std::size_t full_dof) {
    check_rows(poses.size(), full_dof, "to fit a normalizer");
    require(!poses.empty(), "a normalizer needs at least one frame to be fitted");
    const std::size_t frames = poses.size() / full_dof;
    std::vector<double> mean(full_dof), std(full_dof);
    for (std::size_t i = 0; i < poses.size(); ++i) mean[i % full_dof] += poses[i];
    for (double& m : mean) m /= static_cast<double>(frames);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const double d = poses[i] - mean[i % full_dof];
      std[i % full_dof] += d * d;
    }
    for (double& s : std) s = std::sqrt(s / static_cast<double>(frames));
    return Normalizer(std::move(mean), std::move(std));
  }

  const std::vector<double>& mean() const { return mean_; }  ///< [full dof]
  const std::vector<double>& std() const { return std_; }    ///< [full dof]
  /// Full dimension of each kept dimension, ascending, [kept dof].
  const std::vector<std::size_t>& kept() const { return kept_; }
  /// Dimensions of a pose vector.
  std::size_t full_dof() const { return mean_.size(); }
  /// Dimensions that a model sees: those that vary.
  std::size_t kept_dof() const { return kept_.size(); }

  /// Poses [frames, full dof] to normalised [frames, kept dof].
  template <class T>
  std::vector<T> normalize(std::span<const double> poses) const {
    check_rows(poses.size(), full_dof(), "to normalise");
    std::vector<T> out;
    out.reserve(poses.size() / full_dof() * kept_dof());
    for (std::size_t row = 0; row < poses.size(); row += full_dof())
      for (const std::size_t d : kept_) out.push_back(static_cast<T>((poses[row + d] - mean_[d]) / std_[d]));
    return out;
  }

  /// Normalised [frames, kept dof] to poses [frames, full dof].
  template <class T>
  std::vector<double> denormalize(std::span<const T> poses) const {
    check_rows(poses.size(), kept_dof(), "to de-normalise");
    std::vector<double> out;
    out.reserve(poses.size() / kept_dof() * full_dof());
    for (std::size_t row = 0; row < poses.size(); row += kept_dof()) {
      const std::size_t begin = out.size();
      out.insert(out.end(), mean_.begin(), mean_.end());
      for (std::size_t k = 0; k < kept_dof(); ++k)
        out[begin + kept_[k]] += std_[kept_[k]] * static_cast<double>(poses[row + k]);
    }
    return out;
  }

 private:
  static void check_rows(std::size_t values, std::size_t dof, const char* what) {
    require(dof > 0, "found no dimensions ", what);
    require(values % dof == 0, "found ", values, " values ", what, ", expected a multiple of ", dof,
            " (frames x dimensions)");
  }

  std::vector<double> mean_, std_;
  std::vector<std::size_t> kept_;
};

}  // namespace motiongan::motion

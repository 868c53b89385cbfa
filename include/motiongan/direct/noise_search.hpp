// The search for noise whose motion meets constraints: Adam on several starts of several tasks at once.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "motiongan/direct/objective.hpp"
#include "motiongan/direct/options.hpp"
#include "motiongan/optim/adam.hpp"

namespace motiongan::detail {

/// A part of a motion that is searched for at once.
struct SearchWindow {
  std::size_t number = 0, of = 1;

  /// The excess that is good enough. What a window leaves undone the next one has to mend, with its own
  /// constraints to meet.
  double aim() const { return number + 1 < of ? 0.5 : 1; }
};

/// Samples of a batch are numbered task * starts + start.
class NoiseSearch {
 public:
  NoiseSearch(const DirectOptions& options, std::size_t tasks) : options_(options), tasks_(tasks) {}

  /// Changes the noise until half of every task's starts are good enough, at most for the iterations of the
  /// options. `measure(task, poses)` gives the excess of normalised poses [frames, dof]. Returns the
  /// iterations.
  template <class Noise, class Measure>
  std::size_t run(Noise& noise, DirectObjective& objective, const SearchWindow& window,
                  const Measure& measure) {
    Adam adam(noise.parameters(), {.learning_rate = options_.learning_rate, .beta1 = 0.9, .beta2 = 0.99});
    best_.assign(tasks_ * options_.starts, {});
    for (std::size_t iteration = 0;; ++iteration) {
      const Var made = noise.motion();
      if (iteration == 0) objective.keep_moving(made);
      const bool last = iteration == options_.iterations || (options_.should_stop && options_.should_stop());
      if (last || iteration % check_every == 0) {
        const double worst = keep_best(made, measure);
        if (options_.report) options_.report({window.number, window.of, iteration, worst});
        if (last || enough(window.aim())) return iteration;
      }
      const Var loss = weighted_sum(objective(made), 1, noise.turned_away(), options_.stay);
      // Smaller and smaller steps, so that the last ones settle.
      adam.set_rate_factor(0.5 + 0.5 * std::cos(motion::pi * static_cast<double>(iteration) /
                                                static_cast<double>(options_.iterations)));
      adam.step(grad(loss, adam.parameters()));
    }
  }

  /// The best poses of every sample, each [frames, dof].
  std::vector<std::vector<float>> best() const {
    std::vector<std::vector<float>> out;
    for (const Best& b : best_) out.push_back(b.poses);
    return out;
  }

  /// The poses of a task's best start: of those that are good enough the one of the highest score, if there
  /// are scores [samples], and else that of the smallest error.
  const std::vector<float>& chosen(std::size_t task, const std::vector<float>& scores,
                                   const SearchWindow& window) const {
    std::size_t best = task * options_.starts;
    const auto better = [&](std::size_t a, std::size_t b) {
      if (!scores.empty() && best_[a].excess <= window.aim() && best_[b].excess <= window.aim())
        return scores[a] > scores[b];
      return best_[a].excess < best_[b].excess;
    };
    for (std::size_t s = 1; s < options_.starts; ++s)
      if (better(task * options_.starts + s, best)) best = task * options_.starts + s;
    return best_[best].poses;
  }

 private:
  static constexpr std::size_t check_every = 10;  // iterations

  /// A start's best so far.
  struct Best {
    double excess = 0;
    std::vector<float> poses;  // empty: none yet
  };

  /// Measures all starts; returns the excess of the worst task's best start.
  template <class Measure>
  double keep_best(const Var& made, const Measure& measure) {
    const std::size_t frames = made.dim(0), batch = best_.size(), dof = made.dim(2);
    const std::vector<float> all = made.value().to_host();
    std::vector<double> of_task(tasks_, std::numeric_limits<double>::infinity());
    for (std::size_t b = 0; b < batch; ++b) {
      std::vector<float> poses(frames * dof);
      for (std::size_t f = 0; f < frames; ++f)
        std::copy_n(all.begin() + static_cast<std::ptrdiff_t>((f * batch + b) * dof), dof,
                    poses.begin() + static_cast<std::ptrdiff_t>(f * dof));
      const std::size_t task = b / options_.starts;
      const double excess = measure(task, poses);
      if (best_[b].poses.empty() || excess < best_[b].excess) best_[b] = {excess, std::move(poses)};
      of_task[task] = std::min(of_task[task], best_[b].excess);
    }
    return *std::max_element(of_task.begin(), of_task.end());
  }

  /// Whether half of every task's starts have no larger excess.
  bool enough(double aim) const {
    for (std::size_t i = 0; i < tasks_; ++i) {
      std::size_t met = 0;
      for (std::size_t s = 0; s < options_.starts; ++s) met += best_[i * options_.starts + s].excess <= aim;
      if (2 * met < options_.starts) return false;
    }
    return true;
  }

  const DirectOptions& options_;
  std::size_t tasks_;
  std::vector<Best> best_;
};

/// Samples [frames, dof] as one batch [frames, B, dof].
inline Var batch_of(const Context& context, const std::vector<std::vector<float>>& samples, std::size_t dof) {
  const std::size_t batch = samples.size(), frames = samples.front().size() / dof;
  std::vector<float> all(frames * batch * dof);
  for (std::size_t b = 0; b < batch; ++b)
    for (std::size_t f = 0; f < frames; ++f)
      std::copy_n(samples[b].begin() + static_cast<std::ptrdiff_t>(f * dof), dof,
                  all.begin() + static_cast<std::ptrdiff_t>((f * batch + b) * dof));
  return Var::constant(Tensor::from(context, {frames, batch, dof}, all));
}

}  // namespace motiongan::detail

// How the learning rate falls over a training.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "motiongan/core/fields.hpp"

namespace motiongan {

/// How the learning rate falls during a training.
enum class LearningSchedule { constant, linear, cosine };
constexpr NameTable<LearningSchedule, 3> enum_names(LearningSchedule) {
  return {{{LearningSchedule::constant, "constant"},
           {LearningSchedule::linear, "linear"},
           {LearningSchedule::cosine, "cosine"}}};
}

/// Options of a learning rate that falls.
struct ScheduleOptions {
  LearningSchedule shape = LearningSchedule::constant;  ///< how the rate falls
  std::size_t iterations = 0;  ///< over which the rate falls; 0: those of the training

  /// The rate falls to this share of the learning rate, and stays there in a training that goes on.
  static constexpr double last = 0.01;

  /// The share of the learning rate in iteration `iteration` (counted from 0) of a training of `total`.
  double factor(std::size_t iteration, std::size_t total) const {
    const std::size_t over = iterations > 0 ? iterations : total;
    if (shape == LearningSchedule::constant || over == 0) return 1;
    const double progress = std::min(1.0, static_cast<double>(iteration) / static_cast<double>(over));
    const double left =
        shape == LearningSchedule::linear ? 1 - progress : (1 + std::cos(std::acos(-1.0) * progress)) / 2;
    return last + (1 - last) * left;
  }

  /// Keeps the end of the fall where it is now, for a training that is continued with more iterations.
  void fix(std::size_t total) {
    if (shape != LearningSchedule::constant && iterations == 0) iterations = total;
  }

  void list_fields(FieldList& list) {
    list.add(shape, {.key = "lr_schedule",
                     .help = "how the learning rate falls to a hundredth over --lr-iterations"});
    list.add(iterations, {.key = "lr_iterations",
                          .help = "iterations over which the learning rate falls; 0: --iterations"});
  }
};

}  // namespace motiongan

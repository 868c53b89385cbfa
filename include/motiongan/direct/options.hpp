// How a motion is directed: what all models share.
#pragma once
#include <functional>
#include <vector>

#include "motiongan/autograd/var.hpp"
#include "motiongan/core/fields.hpp"
#include "motiongan/nn/text_encoder.hpp"

namespace motiongan {

/// How far the optimisation is.
struct DirectProgress {
  std::size_t window = 0, windows = 1;  ///< of a motion that is longer than the model's windows
  std::size_t iteration = 0;
  double excess = 0;  ///< of the worst motion, see ConstraintError
};

/// Options of direct().
struct DirectOptions {
  std::size_t frames = 0;  ///< of each motion; 0: the model's N; a model of classes has a schedule instead
  std::size_t starts = 8;  ///< noises that are tried for a motion, side by side
  std::size_t iterations = 300;  ///< at most, for each window
  double learning_rate = 0.1;    ///< of Adam
  double stay = 0.0003;          ///< weight of how far the noise turns away from where it was drawn
  bool exact = false;            ///< correct at last what is a little off, see meet_exactly()
  std::uint64_t seed = 1;        ///< seed of the noises that are tried
  std::size_t first_sample = 0;  ///< motion i of a seed begins with the noise of samples starts * i and more
  /// Scores of normalised motion [N, B, dof] for its texts, [B], such as SavedCritic: of the starts that meet
  /// everything, the one of the highest score is kept. Not set: the one of the smallest error.
  std::function<std::vector<float>(const Var& motion, const Sentences& text)> score = {};
  /// The same for models of classes, such as SavedActionCritic: scores of a second and the next one,
  /// normalised [2T, B, dof], for the classes [B, Y] (one-hot) of the latter.
  std::function<std::vector<float>(const Var& pairs, const Var& classes)> score_pairs = {};
  std::function<void(const DirectProgress&)> report = {};  ///< called after each iteration
  std::function<bool()> should_stop = {};                  ///< ends early, with the best so far

  void list_fields(FieldList& list) {
    list.add(starts, {.key = "starts",
                      .help = "noises that are tried for a motion, side by side",
                      .range = Range::between(1, 4096),
                      .saved = false});
    list.add(iterations, {.key = "direct_iterations",
                          .help = "steps of the optimisation at most, for each window",
                          .range = Range::between(1, 1'000'000),
                          .saved = false});
    list.add(
        learning_rate,
        {.key = "direct_rate", .help = "its step size (Adam)", .range = Range::above(0), .saved = false});
    list.add(exact, {.key = "exact",
                     .help = "correct at last what is a little off, so that constraints are met exactly",
                     .saved = false});
    list.add(stay, {.key = "direct_stay",
                    .help = "weight of how far the noise turns away from where it was drawn",
                    .range = Range::at_least(0),
                    .saved = false});
  }
};

}  // namespace motiongan

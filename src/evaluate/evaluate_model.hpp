// How the evaluation of a generator is shown: what `evaluate model` and comparisons of several share.
#pragma once
#include "evaluate/evaluate_motion.hpp"
#include "motiongan/experiments/model_evaluation.hpp"

namespace motiongan::command {

/// Prints the tables of a generator ("cnn" or "rnn"): the paper's Table 2 with its rows of such generators,
/// and the measures of today beside those of real motion.
void print_model_evaluation(std::string_view generator, const ModelEvaluation& made,
                            const RealEvaluation& real, const ModelEvaluationOptions& options);

/// All that was measured.
nlohmann::json model_evaluation_json(const ModelEvaluation& made, const RealEvaluation& real);

}  // namespace motiongan::command

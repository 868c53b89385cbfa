// Prints the evaluation of a generator.
#pragma once
#include "motiongan/experiments/model_evaluation.hpp"
#include "shared/quality.hpp"

namespace motiongan::command {

/// Prints the tables of a generator ("cnn" or "rnn"): Lin & Amer, Table 2, with the paper's rows for such
/// generators, and current metrics next to those of real motion.
void print_model_evaluation(std::string_view generator, const ModelEvaluation& made,
                            const RealEvaluation& real, const ModelEvaluationOptions& options);

/// All measurements.
nlohmann::json model_evaluation_json(const ModelEvaluation& made, const RealEvaluation& real);

}  // namespace motiongan::command

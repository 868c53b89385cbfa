#include "evaluate/evaluate.hpp"

namespace motiongan::command {

void add_evaluate(CLI::App& app, Job& job) {
  CLI::App* evaluate = app.add_subcommand("evaluate", "Measure models and motion as the papers do");
  evaluate->require_subcommand(1);
  add_evaluate_completion(*evaluate, job);
  add_evaluate_model(*evaluate, job);
  add_evaluate_motion(*evaluate, job);
  add_evaluate_ranker(*evaluate, job);
}

}  // namespace motiongan::command

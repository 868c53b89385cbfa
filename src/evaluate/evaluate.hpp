// motiongan evaluate: what the papers measure, and what is measured today.
#pragma once
#include "command.hpp"

namespace motiongan::command {

void add_evaluate_completion(CLI::App& evaluate, Job& job);
void add_evaluate_model(CLI::App& evaluate, Job& job);
void add_evaluate_motion(CLI::App& evaluate, Job& job);
void add_evaluate_ranker(CLI::App& evaluate, Job& job);

}  // namespace motiongan::command

// Options that all trainings of the command share.
#pragma once
#include "command.hpp"
#include "motiongan/optim/adam.hpp"
#include "motiongan/train/run.hpp"

namespace motiongan::command {

/// Adds --learning-rate, --beta1, --beta2 and --epsilon; `whose` goes on after "Adam's".
inline void add_adam_options(CLI::App& verb, AdamOptions& adam, const std::string& whose,
                             const std::string& group) {
  const CLI::Range below_one(0.0, 0.9999999, "0 .. 1");
  const auto option = [&](const char* name, double& member, const std::string& text) {
    return verb.add_option(name, member, text)->capture_default_str()->group(group);
  };
  option("--learning-rate", adam.learning_rate, "Adam's" + whose)->check(positive());
  option("--beta1", adam.beta1, "Adam's")->check(below_one);
  option("--beta2", adam.beta2, "Adam's")->check(below_one);
  option("--epsilon", adam.epsilon, "Adam's")->check(not_negative());
}

/// Adds --minutes, --save-every and --log-every of a run.
template <class Losses>
void add_run_options(CLI::App& verb, BasicRunOptions<Losses>& run) {
  const auto option = [&](const char* name, auto& member, const char* text) {
    return verb.add_option(name, member, text)->capture_default_str()->group("Run");
  };
  option("--minutes", run.max_minutes, "stop (and save) after that long; 0: no limit")->check(not_negative());
  option("--save-every", run.save_every_minutes, "minutes between two checkpoints; 0: only at the end")
      ->check(not_negative());
  option("--log-every", run.log_every, "iterations between two rows of log.csv")->check(positive());
}

}  // namespace motiongan::command

#include "train/training.hpp"

namespace motiongan::command {

void fill_in_choices(DvganArgs& a) {
  const bool recurrent = a.model.generator == GeneratorKind::rnn;
  // Position and yaw relative to a window's start would grow without bound in long motion.
  fill_in_data(a, recurrent ? motion::RootRotation::velocity : motion::RootRotation::heading);
  a.model.final_cut = a.model.cuts();
  a.model.seed = a.training.seed;
  a.training.adam.schedule.fix(a.training.iterations);
  require(a.training.completion_share == 0 || recurrent,
          "--completions needs --generator rnn: the CNN generator cannot complete a motion");
  require(a.model.leak == 0 || recurrent,
          "--leak needs --generator rnn: the CNN generator adds up no changes");
  if (!recurrent || a.training.critic.critic == CriticKind::cnn)
    levels_of(a.data.frames);
  else
    require(a.data.frames >= 2, "--frames is ", a.data.frames, ", expected at least 2");
}

void print_model(Dvgan& model) {
  const double millions = 1e-6 * static_cast<double>(parameter_count(named_parameters(model)));
  const DvganOptions& options = model.options();
  print_fact("generator",
             fmt::format("{}, {} million parameters (width {}{}{}{})", model.is_recurrent() ? "RNN" : "CNN",
                         brief(millions, 3), options.hidden,
                         model.is_recurrent() ? std::string() : fmt::format(", {} taps", options.taps),
                         options.cuts() ? ", final cut" : "",
                         options.leak > 0 ? fmt::format(", leak {}", options.leak) : std::string()));
  print_fact("device", describe(model.context().device()));
}

}  // namespace motiongan::command

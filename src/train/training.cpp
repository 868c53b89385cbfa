// What a training run is made of: its options, its data, and how it is stopped.
#include "train/training.hpp"

#include "train/run_start.hpp"
#include "train/training_options.hpp"

namespace motiongan::command {
namespace {

/// Calls f(name, member) for all that is kept, by the name of its option.
template <class F>
void each_kept(TrainArgs& a, const F& f) {
  each_kept_of_data(a, f);
  f("--generator", a.generator);
  f("--critic", a.critic);
  f("--hidden", a.model.hidden);
  f("--taps", a.model.taps);
  f("--final-cut", a.final_cut);
  f("--seed", a.training.seed);
  f("--iterations", a.training.iterations);
  f("--critic-steps", a.training.critic_steps);
  f("--batch", a.training.batch);
  f("--lambda", a.training.lambda_gp);
  f("--learning-rate", a.training.adam.learning_rate);
  f("--beta1", a.training.adam.beta1);
  f("--beta2", a.training.adam.beta2);
  f("--epsilon", a.training.adam.epsilon);
  f("--validation", a.validation);
  f("--level-weights", a.level_weights);
  f("--diff-input", a.diff_input);
  f("--shift", a.training.input_shift);
  f("--completions", a.training.completion_share);
}

}  // namespace

void add_shared_dvgan_options(CLI::App& verb, TrainArgs& a) {
  const auto option = [&](const char* group, const char* name, auto& member, const char* text) {
    return verb.add_option(name, member, text)->capture_default_str()->group(group);
  };
  option("Model", "--hidden", a.model.hidden, "width of the networks")->check(positive());
  option("Model", "--taps", a.model.taps, "of the convolutions")->check(CLI::IsMember({3, 5}));
  option("Model", "--level-weights", a.level_weights, "how the scores of the time scales are weighted")
      ->check(CLI::IsMember({"exp", "softmax"}));
  option("Model", "--diff-input", a.diff_input,
         "what the RNN critic judges of changes: its LSTM's states, or them")
      ->check(CLI::IsMember({"hidden", "difference"}));
  DvganTrainOptions& t = a.training;
  option("Training", "--critic-steps", t.critic_steps, "in each iteration")->check(positive());
  option("Training", "--batch", t.batch, "motions in a step")->check(positive());
  option("Training", "--lambda", t.lambda_gp, "weight of the gradient penalty")->check(not_negative());
  add_adam_options(verb, t.adam, ", of both networks", "Training");
}

std::string options_as_note(TrainArgs& args) {
  return note_of([&](const auto& f) { each_kept(args, f); });
}

void take_from_note(TrainArgs& args, const CLI::App& verb, const std::string& note, const fs::path& from) {
  take_note([&](const auto& f) { each_kept(args, f); }, verb, note, from, describes_captioned_clips);
}

void choose_defaults(TrainArgs& a, bool final_cut_given) {
  const bool recurrent = a.generator == "rnn";
  if (!final_cut_given) a.final_cut = !recurrent;
}

void fill_in_choices(TrainArgs& a) {
  // Place and yaw counted from a window's start grow without bound once a generator goes on and on.
  fill_in_data(a, a.generator == "rnn" ? "velocity" : "heading");
  a.model.generator = a.generator == "rnn" ? GeneratorKind::rnn : GeneratorKind::cnn;
  a.model.final_cut = a.final_cut;
  DvganCriticOptions& critic = a.training.critic;
  critic.critic = a.critic == "rnn" ? CriticKind::rnn : CriticKind::cnn;
  critic.validation = a.validation == "mod2"    ? Validation::mod2
                      : a.validation == "final" ? Validation::final
                                                : Validation::dense;
  critic.level_weights = a.level_weights == "softmax" ? LevelWeights::softmax : LevelWeights::exp;
  critic.diff_input = a.diff_input == "difference" ? DiffInput::difference : DiffInput::hidden;
  a.model.seed = a.training.seed;
  require(a.training.completion_share == 0 || a.generator == "rnn",
          "--completions needs --generator rnn: the CNN generator completes nothing");
  if (a.generator == "cnn" || a.critic == "cnn")
    levels_of(a.data.frames);
  else
    require(a.data.frames >= 2, "--frames ", a.data.frames, ": expected at least 2");
}

void print_model(Dvgan& model) {
  const double millions = 1e-6 * static_cast<double>(parameter_count(named_parameters(model)));
  const DvganOptions& options = model.options();
  print_fact("generator",
             fmt::format("{}, {} million parameters (width {}{}{})", model.is_recurrent() ? "RNN" : "CNN",
                         brief(millions, 3), options.hidden,
                         model.is_recurrent() ? std::string() : fmt::format(", {} taps", options.taps),
                         options.cuts() ? ", final cut" : ""));
  print_fact("device", describe(model.context().device()));
}

}  // namespace motiongan::command

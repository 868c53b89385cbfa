// --preset: the options of `train dvgan` and `train attention` that go beyond the papers, together.
#pragma once
#include "motiongan/motion/feet.hpp"
#include "motiongan/train/attention_trainer.hpp"
#include "train/training.hpp"

namespace motiongan::command {

/// What --preset sets where the command line does not.
enum class TrainingPreset {
  steady,  ///< what measures best, see docs/training.md
  paper    ///< as the model's paper has it; the last weights generate
};
constexpr NameTable<TrainingPreset, 2> enum_names(TrainingPreset) {
  return {{{TrainingPreset::steady, "steady"}, {TrainingPreset::paper, "paper"}}};
}

/// `text` says what the presets are.
inline void add_preset_option(CLI::App& verb, TrainingPreset& preset, const std::string& text) {
  FieldList list;
  list.add(preset, {.key = "preset", .help = "what options are where none is given: " + text});
  add_options(verb, list, "Training");
}

inline constexpr const char* dvgan_presets =
    "steady: --root-rotation support, --leak 0.1 for an RNN generator, --critic-sees both, --loss-smooth 1, "
    "--loss-contact 1, --ema 0.999; paper: expmap, 0, rotations, 0, 0, 0";
inline constexpr const char* attention_presets =
    "steady: --exact-bones, --from-last-pose, --critic-directions, --loss-smooth 1, --loss-contact 1, "
    "--ema 0.999; paper: none of them";

/// Sets an option that the command line of `verb` does not give.
template <class T, class U>
void set_default(const CLI::App& verb, const char* option, T& member, U value) {
  if (!given(verb, option)) member = value;
}

/// Sets the options of the preset that the command line of `verb` does not give.
inline void apply(TrainingPreset preset, DvganArgs& args, const CLI::App& verb) {
  const bool steady = preset == TrainingPreset::steady;
  const bool recurrent = args.model.generator == GeneratorKind::rnn;
  set_default(verb, "--root-rotation", args.data.root_rotation,
              std::optional(steady ? motion::RootRotation::support : motion::RootRotation::expmap));
  set_default(verb, "--leak", args.model.leak, steady && recurrent ? 0.1 : 0.0);
  // Velocities need two frames, jerk needs four.
  const bool moves = steady && args.data.frames >= 2, jerks = steady && args.data.frames >= 4;
  set_default(verb, "--critic-sees", args.training.critic.sees,
              moves ? CriticSees::both : CriticSees::rotations);
  set_default(verb, "--loss-smooth", args.training.body.smooth, jerks ? 1.0 : 0.0);
  set_default(verb, "--loss-contact", args.training.body.contact, jerks ? 1.0 : 0.0);
  set_default(verb, "--ema", args.training.ema, steady ? 0.999 : 0.0);
}

/// The same for `train attention`. The LSTM baseline has the paper's form alone.
inline void apply(TrainingPreset preset, const motion::ActionDatasetOptions& data, ActionGanOptions& model,
                  AttentionTrainOptions& training, const CLI::App& verb) {
  if (model.generator == ActionGenerator::lstm) return;
  const bool steady = preset == TrainingPreset::steady;
  set_default(verb, "--exact-bones", model.exact_bones, steady);
  set_default(verb, "--from-last-pose", model.continues, steady);
  set_default(verb, "--critic-directions", training.critic_directions, steady);
  const bool jerks = steady && data.frames >= 2;  // with the frames before the seam
  set_default(verb, "--loss-smooth", training.body.smooth, jerks ? 1.0 : 0.0);
  set_default(verb, "--loss-contact", training.body.contact, jerks && data.root_track ? 1.0 : 0.0);
  set_default(verb, "--ema", training.ema, steady ? 0.999 : 0.0);
}

/// Leaves out the contact loss that the preset asks for where the skeleton has no feet.
inline void without_feet(BodyLossOptions& losses, const motion::Skeleton& skeleton, const CLI::App& verb) {
  if (losses.contact <= 0 || given(verb, "--loss-contact") || motion::has_feet(skeleton)) return;
  losses.contact = 0;
  print_fact("", "no joint is named like a foot: --loss-contact 0");
}

}  // namespace motiongan::command

// --preset: the options of `train dvgan` that go beyond the paper, together.
#pragma once
#include "motiongan/motion/feet.hpp"
#include "train/training.hpp"

namespace motiongan::command {

/// What --preset sets where the command line does not.
enum class TrainingPreset {
  steady,  ///< what measures best, see docs/training.md
  paper    ///< as Lin & Amer: exponential maps, and the critic sees them alone; the last weights generate
};
constexpr NameTable<TrainingPreset, 2> enum_names(TrainingPreset) {
  return {{{TrainingPreset::steady, "steady"}, {TrainingPreset::paper, "paper"}}};
}

inline void add_preset_option(CLI::App& verb, TrainingPreset& preset) {
  std::map<std::string, TrainingPreset> names;
  for (const auto& [value, name] : enum_names(preset)) names.emplace(name, value);
  verb.add_option(
          "--preset", preset,
          "what options are where none is given: steady: --root-rotation support (velocity for an RNN "
          "generator), --critic-sees both, --loss-smooth 1, --loss-contact 1, --ema 0.999; paper: "
          "expmap, rotations, 0, 0, 0 [steady]")
      ->transform(CLI::CheckedTransformer(names))
      ->type_name("steady|paper")
      ->group("Training");
}

/// Sets the options of the preset that the command line of `verb` does not give.
inline void apply(TrainingPreset preset, DvganArgs& args, const CLI::App& verb) {
  const bool steady = preset == TrainingPreset::steady;
  const auto set = [&](const char* option, auto& member, auto value) {
    if (!given(verb, option)) member = value;
  };
  const bool recurrent = args.model.generator == GeneratorKind::rnn;
  set("--root-rotation", args.data.root_rotation,
      std::optional(!steady     ? motion::RootRotation::expmap
                    : recurrent ? motion::RootRotation::velocity
                                : motion::RootRotation::support));
  // Velocities need two frames, jerk needs four.
  const bool moves = steady && args.data.frames >= 2, jerks = steady && args.data.frames >= 4;
  set("--critic-sees", args.training.critic.sees, moves ? CriticSees::both : CriticSees::rotations);
  set("--loss-smooth", args.training.body.smooth, jerks ? 1.0 : 0.0);
  set("--loss-contact", args.training.body.contact, jerks ? 1.0 : 0.0);
  set("--ema", args.training.ema, steady ? 0.999 : 0.0);
}

/// Leaves out the contact loss that the preset asks for where the skeleton has no feet.
inline void without_feet(DvganArgs& args, const motion::Skeleton& skeleton, const CLI::App& verb) {
  if (args.training.body.contact <= 0 || given(verb, "--loss-contact") || motion::has_feet(skeleton)) return;
  args.training.body.contact = 0;
  print_fact("", "no joint is named like a foot: --loss-contact 0");
}

}  // namespace motiongan::command

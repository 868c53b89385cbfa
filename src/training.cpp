// What a training run is made of: its options, its data, and how it is stopped.
#include "training.hpp"

#include "motiongan/motion/procedural.hpp"
#include "run_start.hpp"

namespace motiongan::command {
namespace {

/// Calls f(name, member) for all that is kept, by the name of its option.
template <class F>
void each_kept(TrainArgs& a, F&& f) {
  f("FOLDER", a.folder);
  f("--captions", a.captions);
  f("--procedural", a.procedural);
  f("--frames", a.data.frames);
  f("--rate", a.data.rate);
  f("--root-position", a.data.root_position);
  f("--root-rotation", a.root_rotation);
  f("--first-frame", a.first_frame);
  f("--train-share", a.data.train_share);
  f("--split-seed", a.data.split_seed);
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

std::string options_as_note(TrainArgs& args) {
  return note_of([&](const auto& f) { each_kept(args, f); });
}

void take_from_note(TrainArgs& args, const CLI::App& verb, const std::string& note, const fs::path& from) {
  take_note([&](const auto& f) { each_kept(args, f); }, verb, note, from,
            [](const std::string& name) { return name == "--captions"; });
}

void choose_defaults(TrainArgs& a, bool final_cut_given) {
  const bool recurrent = a.generator == "rnn";
  if (!final_cut_given) a.final_cut = !recurrent;
  // Place and yaw counted from a window's start grow without bound once a generator goes on and on.
  if (a.root_rotation == "auto") a.root_rotation = recurrent ? "velocity" : "heading";
}

void fill_in_choices(TrainArgs& a) {
  a.data.captions = a.captions;
  a.data.first_frame = a.first_frame == "keep"   ? motion::FirstFrame::keep
                       : a.first_frame == "drop" ? motion::FirstFrame::drop
                                                 : motion::FirstFrame::automatic;
  a.data.root_rotation = a.root_rotation == "expmap"     ? motion::RootRotation::expmap
                         : a.root_rotation == "velocity" ? motion::RootRotation::velocity
                                                         : motion::RootRotation::heading;
  a.model.generator = a.generator == "rnn" ? Generator::rnn : Generator::cnn;
  a.model.final_cut = a.final_cut;
  DvganCriticOptions& critic = a.training.critic;
  critic.critic = a.critic == "rnn" ? Critic::rnn : Critic::cnn;
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

motion::Dataset load_data(const TrainArgs& args) {
  if (args.procedural == 0) {
    fmt::print("reading {}\n", shown(args.folder));
    return motion::Dataset::from_bvh(args.folder, args.data);
  }
  // A clip holds a window and a half; its rate is a multiple of the model's, so nothing need be resampled.
  motion::ProceduralOptions options;
  options.clips = args.procedural;
  options.seconds = std::max(10.0, 1.5 * static_cast<double>(args.data.frames) / args.data.rate);
  options.rate = args.data.rate * std::max(1.0, std::ceil(30 / args.data.rate));
  fmt::print("computing {} of built-in motion\n", counted(options.clips, "clip"));
  return motion::Dataset::from_motions(motion::procedural_motions(options), args.data);
}

void print_data(const motion::Dataset& data, const TrainArgs& args) {
  const motion::MotionFormat& format = data.format;
  const double window = static_cast<double>(format.frames) / format.rate;
  const auto windows = [&](const std::vector<motion::DatasetClip>& clips) {
    std::size_t n = 0;
    for (const motion::DatasetClip& clip : clips) n += data.starts(clip);
    return n;
  };
  std::string clips = fmt::format("{} to train on, {} kept for testing", data.train.size(), data.test.size());
  if (!data.skipped.empty())
    clips += fmt::format("; {} left out, shorter than {}", data.skipped.size(), duration(window));
  print_fact("clips", clips);
  print_fact("windows", fmt::format("{} to train on, of {} frames at {} per second ({})", windows(data.train),
                                    format.frames, brief(format.rate), duration(window)));
  const std::size_t used = data.train.size() + data.test.size();
  if (args.procedural > 0)
    print_fact("captions", "those of the built-in motion");
  else if (args.captions.empty())
    print_fact("captions", "made from the names of the files (no captions.tsv in the folder, no --captions)");
  else
    print_fact("captions",
               fmt::format("from {}{}", shown(args.captions),
                           data.named == 0 ? std::string()
                                           : fmt::format("; {} of {} are not in it and are called by "
                                                         "the names of their files",
                                                         data.named, counted(used, "clip"))));
  print_fact("words", fmt::format("{} in the training captions", format.vocabulary.size() - 1));
  print_fact("skeleton",
             fmt::format("{}, root {}; {} of a pose change{}", counted(format.skeleton().size(), "joint"),
                         format.skeleton().joints[format.layout.root()].name, counted(format.dof(), "number"),
                         format.layout.root_position() ? ", the root's position among them" : ""));
  if (data.dropped_frames > 0)
    print_fact("first frame",
               fmt::format("{} at the start of clips left out{}", counted(data.dropped_frames, "frame"),
                           args.first_frame == "auto" ? " (a T-pose before the motion)" : ""));
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

// motiongan generate: generates motion for a text, or for classes.
#include "generate/directing.hpp"
#include "generate/generate_actions.hpp"
#include "generate/streaming.hpp"
#include "motiongan/models/action_gan.hpp"
#include "motiongan/models/dvgan.hpp"
#include "motiongan/motion/motion.hpp"
#include "shared/action_files.hpp"
#include "shared/cleaning.hpp"
#include "shared/outputs.hpp"
#include "shared/prompt.hpp"
#include "shared/ranks.hpp"
#include "shared/sampling.hpp"
#include "shared/show.hpp"
#include "shared/signals.hpp"

namespace motiongan::command {
namespace {

struct GenerateArgs {
  std::string model, prompts, out = ".", html, png, drift;
  std::vector<std::string> texts;
  GenerateOptions options;
  Weights weights;
  Cleaning cleaning;
  Retargeting retargeting;
  Directing directing;
  std::string format = "bvh";
  double rate = 0;
  bool strict = false;
};

/// The texts of --text, then those of the --prompts file, one per line.
std::vector<std::string> all_texts(const GenerateArgs& args) {
  std::vector<std::string> texts = args.texts;
  for (const std::string& text : texts) check_text(text);
  if (!args.prompts.empty())
    for (std::string& text : read_prompts(args.prompts)) texts.push_back(std::move(text));
  require(!texts.empty(), "no text is given; use --text \"walk\" (may be repeated) or --prompts FILE");
  return texts;
}

/// File names for texts: a text that is given again gets a number.
class FileNames {
 public:
  std::string next(const std::string& text) {
    std::string name = slug(text);
    for (std::size_t again = 2; !used_.insert(name).second; ++again)
      name = fmt::format("{}-{}", slug(text), again);
    return name;
  }

 private:
  std::set<std::string> used_;
};

/// Generates all motions of one text and then writes them: for generators that make a whole window at once.
/// Returns the motions.
std::vector<motion::Motion> write_whole(const Dvgan& model, const std::string& text, const GenerateArgs& args,
                                        const std::vector<fs::path>& files, DriftReport* drift,
                                        TargetBody& body) {
  std::vector<motion::Motion> motions;
  for (const std::vector<float>& poses : model.generate_poses(text, args.options)) {
    if (drift != nullptr) {
      DriftMeter meter(model.format());
      meter.add(poses, poses.size() / model.format().dof());
      drift->add(meter);
    }
    motions.push_back(args.cleaning.apply(body.put(model.format().to_motion(poses))));
    write_motion(files[motions.size() - 1], motions.back(), args.rate,
                 body.unit_metres(model.format().space.unit_metres), body.character());
  }
  return motions;
}

/// The same frame by frame, for any length. Returns nothing if a signal requested a stop.
std::optional<std::vector<motion::Motion>> write_long(const Dvgan& model, const std::string& text,
                                                      const GenerateArgs& args, std::size_t frames,
                                                      const std::vector<fs::path>& files, DriftReport* drift,
                                                      TargetBody& body) {
  StreamJob job{.files = files,
                .frames = frames,
                .rate = args.rate,
                .unit_metres = body.unit_metres(model.format().space.unit_metres),
                .body = &body};
  for (std::size_t i = 0; i < files.size(); ++i)
    job.characters.push_back({.text = text,
                              .seed = args.options.seed,
                              .sample = static_cast<std::uint32_t>(args.options.first_sample + i)});
  if (!args.html.empty() || !args.png.empty()) job.kept = shown_frames(model.format().rate, args.rate);
  if (args.cleaning.on()) job.clean = args.cleaning.settings();
  return write_streamed(model, job, drift);
}

/// Writes directed motions, and returns them as written.
std::vector<motion::Motion> write_directed(const std::vector<DirectedMotion>& made, const Dvgan& model,
                                           const GenerateArgs& args, const std::vector<fs::path>& files,
                                           TargetBody& body) {
  std::vector<motion::Motion> motions;
  for (const DirectedMotion& m : made) {
    motions.push_back(body.put(m.motion));
    write_motion(files[motions.size() - 1], motions.back(), args.rate,
                 body.unit_metres(model.format().space.unit_metres), body.character());
  }
  return motions;
}

/// Directs motions of every text. Returns the exit status.
int generate_directed(const GenerateArgs& args, const fs::path& file, const std::vector<std::string>& texts) {
  require(args.drift.empty(), "--drift does not go with the options that direct a motion");
  const Context context;
  Dvgan model = load_with<Dvgan>(context, file, args.model, args.weights);
  const motion::MotionFormat& format = model.format();
  const Direction wanted = read_direction(args.directing, format);
  DirectOptions options = args.directing.options;
  use_critic(options, model, args.model);
  for (const std::string& text : texts) check_words(format, text, args.strict);
  make_folder(args.out);
  TargetBody body(args.retargeting);
  const double rate = args.rate > 0 ? args.rate : format.rate;
  std::vector<view::ViewedMotion> shown;
  FileNames names;
  bool all_met = true;
  std::size_t files_made = 0;
  for (const std::string& text : texts) {
    const std::vector<fs::path> files =
        sample_files(args.out, names.next(text), args.options.first_sample, args.options.count, args.format);
    std::vector<DirectedMotion> made = make_directed(model, text, options, wanted, args.options);
    if (args.cleaning.on())  // what is measured is what is written, but for another skeleton
      for (DirectedMotion& m : made) {
        m.motion = args.cleaning.apply(std::move(m.motion));
        m.errors = constraint_errors(m.motion, format.layout.root(), wanted.constraints);
      }
    const std::vector<motion::Motion> motions = write_directed(made, model, args, files, body);
    files_made += files.size();
    fmt::print("\"{}\": {}, {} at {} per second, {} of optimisation\n", text, named(files),
               counted(motion::resampled_frames(motions.front().frames, format.rate, rate), "frame"),
               brief(rate), counted(made.front().iterations, "step"));
    std::vector<std::vector<ConstraintError>> errors;
    for (const DirectedMotion& m : made) errors.push_back(m.errors);
    all_met = print_constraint_errors(errors, motion::body_unit(format.skeleton())) && all_met;
    for (std::size_t i = 0; i < motions.size(); ++i)
      shown.push_back(
          {args.options.count > 1 ? fmt::format("{} ({})", text, args.options.first_sample + i) : text,
           for_page(motions[i], args.rate), 0,
           args.retargeting.on() ? view::Marks()
                                 : marks_of(wanted.constraints, made[i].motion, format.layout.root())});
    if (stop_requested()) return stopped(files_made);
  }
  fmt::print("space: {}\n", describe(format.space));
  if (!args.html.empty()) show_page(args.html, shown, "generated by " + file.string());
  if (!args.png.empty()) show_strip(args.png, shown);
  return all_met ? 0 : exit_not_met;
}

int generate(const GenerateArgs& args, const fs::path& file) {
  const std::vector<std::string> texts = all_texts(args);
  check_samples(args.options.first_sample, args.options.count);
  require(has_rotations(args.format), "--format ", args.format,
          " writes positions, for class-conditioned models; use bvh, glb, fbx or vrma");
  if (args.directing.on()) return generate_directed(args, file, texts);
  const Context context;
  const Dvgan model = load_with<Dvgan>(context, file, args.model, args.weights);
  const motion::MotionFormat& format = model.format();
  const std::size_t made = args.options.frames > 0 ? args.options.frames : format.frames;
  if (made != format.frames) model.rnn();  // throws Error if there is no RNN generator
  const double rate = args.rate > 0 ? args.rate : format.rate;
  const std::size_t frames = motion::resampled_frames(made, format.rate, rate);
  const bool streamed = model.is_recurrent();
  for (const std::string& text : texts) check_words(format, text, args.strict);
  const fs::path out = args.out;
  make_folder(out);

  TargetBody body(args.retargeting);
  DriftReport drift;
  DriftReport* const measured = !args.drift.empty() || made > 4 * format.frames ? &drift : nullptr;
  if (streamed) catch_signals();
  std::vector<view::ViewedMotion> shown;
  FileNames names;
  std::size_t files_made = 0;
  for (const std::string& text : texts) {
    const std::vector<fs::path> files =
        sample_files(out, names.next(text), args.options.first_sample, args.options.count, args.format);
    const auto motions = streamed ? write_long(model, text, args, made, files, measured, body)
                                  : write_whole(model, text, args, files, measured, body);
    if (!motions) return stopped(files_made);
    files_made += files.size();
    fmt::print("\"{}\": {}\n", text, named(files));
    if (args.html.empty() && args.png.empty()) continue;
    for (std::size_t i = 0; i < motions->size(); ++i)
      shown.push_back(
          {args.options.count > 1 ? fmt::format("{} ({})", text, args.options.first_sample + i) : text,
           for_page((*motions)[i], args.rate)});
  }
  fmt::print("wrote {} of {} at {} per second ({} each), seed {}\n",
             counted(files_made, file_kind(args.format)), counted(frames, "frame"), brief(rate),
             duration(static_cast<double>(frames) / rate), args.options.seed);
  fmt::print("space: {}\n", describe(format.space));
  if (measured != nullptr) drift.print();
  if (!args.drift.empty()) {
    drift.write_csv(args.drift);
    fmt::print("wrote {}: the drift per second\n", args.drift);
  }
  if (!shown.empty() && shown.front().motion.frames < frames)
    fmt::print("only the first {} frames of each motion are shown\n", most_shown);
  if (!args.html.empty()) show_page(args.html, shown, "generated by " + file.string());
  if (!args.png.empty()) show_strip(args.png, shown);
  return 0;
}

/// Generates with either kind of model. Throws Error for options of the other kind.
int generate_either(GenerateArgs args, ActionGenerateArgs actions, const CLI::App& verb) {
  const fs::path file = model_file(args.model);
  const std::shared_ptr<const Communicator> ranks = join_ranks();
  need_one_rank(ranks.get(), verb, {"--html", "--png", "--drift", "--attention-map"});
  std::vector<fs::path> inputs =
      inputs_of(actions.from, {args.prompts, actions.data, args.retargeting.skeleton, args.retargeting.map});
  inputs.push_back(file);
  for (const fs::path& input : args.directing.inputs()) inputs.push_back(input);
  check_output("--html", args.html, page_output, inputs);
  check_output("--png", args.png, picture_output, inputs);
  check_output("--drift", args.drift, table_output, inputs);
  check_output("--attention-map", actions.attention_map, picture_output, inputs);
  if (!holds_model<ActionGan>(io::SafeTensors::read(file))) {
    const std::string wrong = given_action_options(verb);
    require(wrong.empty(), file.string(), " generates motion for a text: it has no classes, and takes no ",
            wrong, "; use --text \"walk\"");
    const Share share = share_of(args.options.count, ranks.get());
    args.options.first_sample += share.first, args.options.count = share.count;
    return share.count > 0 ? generate(args, file) : 0;
  }
  for (const char* name : {"--text", "--prompts", "--drift"})
    require(verb.count(name) == 0, file.string(), " generates motion for classes: it takes no ", name,
            "; use --class NAME");
  actions.model = args.model, actions.out = args.out, actions.html = args.html, actions.png = args.png;
  actions.count = args.options.count, actions.frames = args.options.frames;
  actions.first_sample = args.options.first_sample, actions.seed = args.options.seed,
  actions.rate = args.rate;
  actions.weights = args.weights, actions.cleaning = args.cleaning, actions.format = args.format;
  actions.retargeting = args.retargeting, actions.directing = args.directing;
  return generate_actions(actions, verb, file, ranks.get());
}

const Verb generate_verb{
    "generate",
    [](CLI::App& app, Job& job) {
      CLI::App* verb = app.add_subcommand(
          "generate",
          "Generate motion for a text, or continue a second of motion in given classes, and write it as "
          "files.\n"
          "Files are named after the text and the sample number (walk-slowly_000.bvh); existing files are\n"
          "replaced. The same model, text, seed and sample give the same motion, whatever --count is. A "
          "model\n"
          "with an RNN generator generates any number of frames and writes them as it goes.");
      const auto args = std::make_shared<GenerateArgs>();
      const auto actions = std::make_shared<ActionGenerateArgs>();
      verb->add_option("MODEL", args->model, model_help)->required()->type_name("");
      verb->add_option("--text", args->texts, "description of the motion; may be repeated")
          ->type_name("TEXT")
          ->expected(1)
          ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
      add_strict_option(*verb, args->strict);
      verb->add_option("--prompts", args->prompts, "file with a text on each line; lines with # are comments")
          ->type_name("FILE");
      verb->add_option("--count", args->options.count,
                       "motions for each text, or for the schedule of classes")
          ->check(positive())
          ->capture_default_str();
      add_sampling_options(*verb, args->options.seed, args->options.first_sample, args->rate, args->out,
                           "motions");
      verb->add_option("--frames", args->options.frames,
                       "frames of each motion, at the model's rate; other numbers need an RNN generator [the "
                       "model's]")
          ->check(positive())
          ->type_name("N");
      verb->add_option("--drift", args->drift,
                       "table to write: drift from the training data, second by second")
          ->type_name("FILE.csv");
      verb->add_option("--html", args->html, "also write an HTML page that plays the motions")
          ->type_name("FILE");
      verb->add_option("--png", args->png, "also write a picture of their poses")->type_name("FILE");
      add_weights_option(*verb, args->weights);
      add_clip_format_option(*verb, args->format);
      add_skeleton_options(*verb, args->retargeting);
      add_clean_options(*verb, args->cleaning);
      add_direct_options(*verb, args->directing);
      add_action_options(*verb, *actions);
      verb->callback([&job, args, actions, verb] {
        job = [args, actions, verb] { return generate_either(*args, *actions, *verb); };
      });
    },
    Verb::Runs::on_ranks};

}  // namespace

}  // namespace motiongan::command

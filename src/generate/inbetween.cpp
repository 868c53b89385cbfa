// motiongan inbetween: fills the gap between two clips.
#include "generate/directing.hpp"
#include "generate/streaming.hpp"
#include "motiongan/direct/between.hpp"
#include "shared/cleaning.hpp"
#include "shared/clip_reading.hpp"
#include "shared/motion_files.hpp"
#include "shared/outputs.hpp"
#include "shared/prompt.hpp"
#include "shared/retargeting.hpp"
#include "shared/sampling.hpp"
#include "shared/show.hpp"
#include "shared/signals.hpp"
#include "shared/weights.hpp"

namespace motiongan::command {
namespace {

struct InbetweenArgs {
  std::string model, from, to, text, out = ".", html, png, format = "bvh", place = "keep";
  double seconds = 1, rate = 0;
  std::size_t count = 1, first_sample = 0;
  std::uint64_t seed = 1;
  motion::ClipOptions clips;
  Weights weights;
  Retargeting retargeting;
  DirectOptions options;
  bool strict = false;
};

/// A clip at the model's rate and of its size.
motion::Motion read_side(const std::string& file, const InbetweenArgs& args,
                         const motion::MotionFormat& format) {
  motion::Motion clip = read_clip(file, args.clips, format.space).motion;
  format.require_skeleton(clip.skeleton, "the clip " + file);
  scale_to_model(clip, format.skeleton(), "the clip " + file);
  return motion::resample(clip, format.rate, file);
}

int inbetween(InbetweenArgs args) {
  check_text(args.text);
  check_samples(args.first_sample, args.count);
  const fs::path file = model_file(args.model), out = args.out;
  const std::string name =
      fmt::format("{}_{}_{}", motion::clip_stem(args.from), motion::clip_stem(args.to), slug(args.text));
  const std::vector<fs::path> files = sample_files(out, name, args.first_sample, args.count, args.format);
  const std::vector<fs::path> inputs{file, args.from, args.to, args.retargeting.skeleton,
                                     args.retargeting.map};
  check_output("--html", args.html, page_output, inputs);
  check_output("--png", args.png, picture_output, inputs);
  check_outputs("--out", files, inputs);
  const Context context;
  Dvgan model = load_with<Dvgan>(context, file, args.model, args.weights);
  const motion::MotionFormat& format = model.format();
  check_words(format, args.text, args.strict);
  const Gap gap{.text = args.text,
                .before = read_side(args.from, args, format),
                .after = read_side(args.to, args, format),
                .seconds = args.seconds,
                .placed = args.place == "keep"};
  make_folder(out);
  TargetBody body(args.retargeting);
  use_critic(args.options, model, args.model);
  args.options.seed = args.seed, args.options.first_sample = args.first_sample;
  std::vector<InBetween> made;
  {
    const ShownProgress shown(args.options);
    made = fill_gaps(model, std::vector(args.count, gap), args.options);
  }
  std::vector<view::ViewedMotion> shown;
  bool all_met = true;
  for (std::size_t i = 0; i < made.size(); ++i) {
    const motion::Motion written = body.put(made[i].motion);
    write_motion(files[i], written, args.rate, body.unit_metres(format.space.unit_metres), body.character());
    shown.push_back({args.count > 1 ? fmt::format("{} ({})", args.text, args.first_sample + i) : args.text,
                     for_page(written, args.rate)});
    all_met = all_met && made[i].error.met();
  }
  const InBetween& first = made.front();
  fmt::print("\"{}\": {}\n", args.text, named(files));
  fmt::print("wrote {}: {} of {}, {} between ({}), {} of {}, at {} per second\n",
             counted(args.count, file_kind(args.format)), counted(first.first, "frame"),
             motion::clip_stem(args.from), first.count, duration(args.seconds),
             counted(first.motion.frames - first.first - first.count, "frame"), motion::clip_stem(args.to),
             brief(format.rate));
  double mean = 0, worst = 0;
  for (const InBetween& m : made) {
    mean += m.error.mean / static_cast<double>(made.size());
    worst = std::max(worst, m.error.worst);
  }
  const double leg = motion::body_unit(format.skeleton());
  fmt::print(
      "before the last correction the poses after the gap were off by {} leg lengths in the mean, {} at "
      "most, {} allowed{}\n",
      brief(mean / leg, 3), brief(worst / leg, 3), brief(first.error.tolerance / leg, 3),
      all_met ? "" : ": NOT MET, the way there may look forced; try more --starts or more time");
  fmt::print("space: {}\n", describe(format.space));
  if (!args.html.empty()) show_page(args.html, shown, "between " + args.from + " and " + args.to);
  if (!args.png.empty()) show_strip(args.png, shown);
  if (stop_requested()) return stopped(files.size());
  return all_met ? 0 : exit_not_met;
}

const Verb inbetween_verb{
    "inbetween", [](CLI::App& app, Job& job) {
      CLI::App* verb = app.add_subcommand(
          "inbetween",
          "Fill the gap between two clips, guided by a text.\n"
          "Each file (A_B_walk_000.bvh) contains the first clip, the frames between and the second clip, at "
          "the\n"
          "model's rate and with the first clip's bone lengths; existing files are replaced. The clips stay "
          "as they\n"
          "are. The exit status is 4 if the model did not get near enough by itself.");
      const auto args = std::make_shared<InbetweenArgs>();
      const auto option = [&](const char* name, auto& member, const char* text) {
        return verb->add_option(name, member, text);
      };
      option("MODEL", args->model, model_help)->required()->type_name("");
      option("--from", args->from, "clip before the gap, with the model's skeleton")
          ->required()
          ->type_name("CLIP");
      option("--to", args->to, "clip after it")->required()->type_name("CLIP");
      option("--text", args->text, "description of what comes between")->required()->type_name("TEXT");
      add_strict_option(*verb, args->strict);
      option("--seconds", args->seconds, "from the last frame of one clip to the first of the other")
          ->check(positive())
          ->capture_default_str();
      option("--place", args->place,
             "keep: the second clip is where its file has it; free: it begins where the motion gets to")
          ->check(CLI::IsMember({"keep", "free"}))
          ->capture_default_str();
      option("--count", args->count, "number of different motions")->check(positive())->capture_default_str();
      add_sampling_options(*verb, args->seed, args->first_sample, args->rate, args->out, "motions");
      add_reading_options(*verb, args->clips, false);
      option("--html", args->html, "also write an HTML page that plays the motions")->type_name("FILE");
      option("--png", args->png, "also write a picture of their poses")->type_name("FILE");
      add_weights_option(*verb, args->weights);
      add_format_option(*verb, args->format);
      add_skeleton_options(*verb, args->retargeting);
      add_optimiser_options(*verb, args->options, false);
      verb->callback([&job, args] { job = [args] { return inbetween(*args); }; });
    }};

}  // namespace

}  // namespace motiongan::command

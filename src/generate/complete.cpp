// motiongan complete: continues a clip, guided by a text.
#include <cmath>

#include "generate/streaming.hpp"
#include "motiongan/io/read_number.hpp"
#include "motiongan/metrics/euler_error.hpp"
#include "motiongan/models/dvgan.hpp"
#include "motiongan/motion/motion.hpp"
#include "shared/cleaning.hpp"
#include "shared/clip_reading.hpp"
#include "shared/motion_files.hpp"
#include "shared/outputs.hpp"
#include "shared/prompt.hpp"
#include "shared/sampling.hpp"
#include "shared/show.hpp"
#include "shared/signals.hpp"
#include "shared/weights.hpp"

namespace motiongan::command {
namespace {

struct CompleteArgs {
  std::string model, prior, text, from, out = ".", html, png;
  std::size_t seed_frames = 25, frames = 39, count = 1, first_sample = 0;
  std::uint64_t seed = 1;
  double rate = 0;
  Weights weights;
  Cleaning cleaning;
  Retargeting retargeting;
  std::string format = "bvh";
  motion::ClipOptions clips;
  bool strict = false;
};

/// The clip at the model's rate, from the first seed frame on.
struct Prior {
  motion::Motion seed, truth;  // truth: the clip's own continuation, as far as it goes
  std::string from;            // where the seed begins, for messages
  double scale = 1;            // of the clip's lengths to the model's
};

/// The frame of the file that --from names: "240", or "2.5s".
std::size_t first_frame(const std::string& from, double rate) {
  const bool seconds = from.ends_with('s');
  const char *begin = from.data(), *end = begin + from.size() - (seconds ? 1 : 0);
  double value = -1;
  const auto [stop, problem] = io::read_number(begin, end, value);
  require(problem == std::errc() && stop == end && value >= 0 && value < 1e9 &&
              (seconds || value == std::floor(value)),
          "--from ", from, ": expected a frame of the prior, such as 240, or seconds, such as 2.5s");
  return static_cast<std::size_t>(std::lround(seconds ? value * rate : value));
}

Prior read_prior(const CompleteArgs& args, const motion::MotionFormat& format) {
  motion::LoadedMotion loaded = read_clip(args.prior, args.clips, format.space);
  format.require_skeleton(loaded.motion.skeleton, "the prior " + args.prior);
  const double size = scale_to_model(loaded.motion, format.skeleton(), "the prior " + args.prior);
  const std::size_t posed = loaded.dropped, in_file = posed + loaded.motion.frames;
  const motion::Motion& whole = loaded.motion;
  const std::size_t from = std::max(posed, args.from.empty() ? 0 : first_frame(args.from, whole.rate));
  require(from < in_file, "--from ", args.from, " is frame ", from, " of ", args.prior, ", which has ",
          in_file, " frames at ", brief(whole.rate), " per second (",
          duration(static_cast<double>(in_file) / whole.rate), ")");
  const motion::Motion rest =
      motion::resample(slice(whole, from - posed, in_file - from), format.rate, args.prior);
  require(rest.frames >= args.seed_frames, "the prior ", args.prior, " has ",
          counted(in_file - from, "frame"), " from frame ", from, " on, ",
          duration(static_cast<double>(in_file - from) / whole.rate), " at ", brief(whole.rate),
          " per second; at the model's ", brief(format.rate), " per second that makes ", rest.frames,
          ", but --seed-frames is ", args.seed_frames, " (",
          duration(static_cast<double>(args.seed_frames) / format.rate), "): give a longer clip",
          args.from.empty() ? "" : ", an earlier --from", ", or --seed-frames ", rest.frames, " at most");
  const std::size_t after = std::min(args.frames, rest.frames - args.seed_frames);
  return {
      slice(rest, 0, args.seed_frames), slice(rest, args.seed_frames, after),
      fmt::format("frame {}{}", from, posed > 0 && from == posed ? " (after the T-pose at its start)" : ""),
      size};
}

/// The times in ms at which the motion-prediction papers measure, each with the nearest frame after the seed,
/// counted from 1. Times that no frame matches within a fifth are left out.
std::vector<std::pair<int, std::size_t>> measured_frames(double rate, std::size_t frames) {
  std::vector<std::pair<int, std::size_t>> out;
  for (const int ms : {80, 160, 320, 400, 560, 1000}) {
    const auto frame = static_cast<std::size_t>(std::lround(ms * 1e-3 * rate));
    if (frame == 0 || frame > frames) continue;
    const double true_ms = 1e3 * static_cast<double>(frame) / rate;
    if (std::abs(true_ms / ms - 1) <= 0.2 && (out.empty() || out.back().second != frame))
      out.emplace_back(ms, frame);
  }
  return out;
}

/// The number of frames that errors are computed over: at most a second of the clip's own continuation.
std::size_t measured_length(const Prior& prior) {
  const auto second = static_cast<std::size_t>(std::max(1L, std::lround(prior.seed.rate)));
  return std::min(prior.truth.frames, second);
}

/// The last frame of the seed, held.
motion::Motion held(const motion::Motion& seed, std::size_t frames) {
  motion::Motion out = slice(seed, seed.frames - 1, 1);
  while (out.frames < frames) out = join(std::move(out), slice(seed, seed.frames - 1, 1));
  return out;
}

/// Prints the errors of the continuations against the clip's own; `made` holds seed and continuation.
void print_errors(const Prior& prior, const std::vector<motion::Motion>& made, std::size_t root) {
  const std::size_t frames = measured_length(prior), count = made.size();
  const auto times = measured_frames(prior.seed.rate, frames);
  if (times.empty()) {
    fmt::print("no error against the clip: {}\n",
               prior.truth.frames == 0
                   ? "it ends with the seed"
                   : "it ends too soon, or the model's rate is too low for the times that are measured");
    return;
  }
  const motion::Motion truth = slice(prior.truth, 0, frames);
  const std::vector<double> still = euler_errors(truth, held(prior.seed, frames), root);
  std::vector<double> mean(frames, 0.0), best(frames, std::numeric_limits<double>::infinity());
  for (const motion::Motion& motion : made) {
    const std::vector<double> errors = euler_errors(truth, slice(motion, prior.seed.frames, frames), root);
    for (std::size_t f = 0; f < frames; ++f) {
      mean[f] += errors[f] / static_cast<double>(count);
      best[f] = std::min(best[f], errors[f]);
    }
  }
  std::vector<std::string> head{"ms"};
  std::vector<std::vector<std::string>> rows{{"true ms"}, {"zero velocity"}, {"model"}};
  if (count > 1)
    rows[2][0] = fmt::format("mean of {}", count), rows.push_back({fmt::format("best of {}", count)});
  for (const auto& [ms, frame] : times) {
    head.push_back(fmt::format("{}", ms));
    rows[0].push_back(fmt::format("{:.0f}", 1e3 * static_cast<double>(frame) / prior.seed.rate));
    rows[1].push_back(fmt::format("{:.2f}", still[frame - 1]));
    rows[2].push_back(fmt::format("{:.2f}", mean[frame - 1]));
    if (count > 1) rows[3].push_back(fmt::format("{:.2f}", best[frame - 1]));
  }
  fmt::print(
      "error against the clip's own continuation (Euler angles as in the motion-prediction papers, over "
      "{}):\n",
      counted(frames, "frame"));
  print_table(head, rows, "l" + std::string(times.size(), 'r'), "  ");
}

/// A motion that begins with the seed, for the page and the picture.
view::ViewedMotion viewed(const std::string& title, const motion::Motion& motion, std::size_t seed_frames,
                          double rate) {
  const double model_rate = motion.rate;
  view::ViewedMotion out{title, for_page(motion, rate), seed_frames};
  if (rate > 0)  // the frames up to the seed's last one
    out.seed_frames = motion::resampled_frames(seed_frames, model_rate, rate);
  return out;
}

int complete(const CompleteArgs& args) {
  check_text(args.text);
  check_samples(args.first_sample, args.count);
  const fs::path file = model_file(args.model), out = args.out;
  const std::string clip = motion::clip_stem(args.prior);
  const std::vector<fs::path> files =
      sample_files(out, clip + "_" + slug(args.text), args.first_sample, args.count, args.format);
  const std::vector<fs::path> inputs{file, args.prior, args.clips.bones, args.retargeting.skeleton,
                                     args.retargeting.map};
  check_output("--html", args.html, page_output, inputs);
  check_output("--png", args.png, picture_output, inputs);
  check_outputs("--out", files, inputs);
  const Context context;
  const Dvgan model = load_with<Dvgan>(context, file, args.model, args.weights);
  model.rnn();  // throws Error if there is no RNN generator
  const motion::MotionFormat& format = model.format();
  const Prior prior = read_prior(args, format);
  check_words(format, args.text, args.strict);
  make_folder(out);
  const bool shows = !args.html.empty() || !args.png.empty();
  StreamJob job{.files = files,
                .before = prior.seed,
                .frames = args.frames,
                .rate = args.rate,
                .scale = args.retargeting.on() ? 1 : 1 / prior.scale,
                .kept = prior.seed.frames + measured_length(prior)};
  if (shows) job.kept = std::max(job.kept, shown_frames(format.rate, args.rate));
  for (std::size_t i = 0; i < args.count; ++i)
    job.characters.push_back({.text = args.text,
                              .seed = args.seed,
                              .sample = static_cast<std::uint32_t>(args.first_sample + i),
                              .prior = &prior.seed});
  TargetBody body(args.retargeting);
  job.body = &body;
  if (args.cleaning.on()) job.clean = args.cleaning.settings(prior.seed.frames);
  catch_signals();
  const auto made = write_streamed(model, job);
  if (!made) return stopped(0);

  const double seconds = static_cast<double>(args.frames) / format.rate;
  fmt::print("\"{}\": {}\n", args.text, named(job.files));
  fmt::print("wrote {}: {} of {} from {} on, then {} generated frames ({}), seed {}\n",
             counted(args.count, file_kind(args.format)), counted(prior.seed.frames, "frame"), clip,
             prior.from, args.frames, duration(seconds), args.seed);
  fmt::print("space: {}\n", prior.scale == 1 ? describe(format.space) : "y up, in the prior's own unit");
  if (!args.retargeting.on()) print_errors(prior, *made, format.layout.root());
  if (!shows) return 0;
  std::vector<view::ViewedMotion> shown;
  if (prior.truth.frames > 0)
    shown.push_back(
        viewed(clip + ", ground truth", join(prior.seed, prior.truth), prior.seed.frames, args.rate));
  for (std::size_t i = 0; i < made->size(); ++i)
    shown.push_back(
        viewed(args.count > 1 ? fmt::format("{} ({})", args.text, args.first_sample + i) : args.text,
               (*made)[i], prior.seed.frames, args.rate));
  if (prior.seed.frames + args.frames > shown_frames(format.rate, args.rate))
    fmt::print("only the first {} frames of each motion are shown\n", most_shown);
  if (!args.html.empty()) show_page(args.html, shown, clip + " completed by " + file.string());
  if (!args.png.empty()) show_strip(args.png, shown);
  return 0;
}

const Verb complete_verb{
    "complete", [](CLI::App& app, Job& job) {
      CLI::App* verb = app.add_subcommand(
          "complete",
          "Continue the first frames of a clip, guided by a text.\n"
          "Each file (CLIP_walk-slowly_000.bvh) contains the seed frames, at the model's rate and with the\n"
          "clip's bone lengths, then the generated frames; existing files are replaced. While the clip "
          "itself\n"
          "continues, errors against it are printed. Needs a model with an RNN generator.");
      const auto args = std::make_shared<CompleteArgs>();
      const auto option = [&](const char* name, auto& member, const char* text) {
        return verb->add_option(name, member, text);
      };
      option("MODEL", args->model, model_help)->required()->type_name("");
      option("--prior", args->prior, "clip to continue, with the model's skeleton")
          ->required()
          ->type_name("CLIP.bvh");
      option("--text", args->text, "description of what comes next")->required()->type_name("TEXT");
      add_strict_option(*verb, args->strict);
      option("--seed-frames", args->seed_frames, "frames of the clip to start with, at the model's rate")
          ->check(positive())
          ->capture_default_str();
      option("--frames", args->frames, "frames to generate after them; any number")
          ->check(positive())
          ->capture_default_str();
      option("--from", args->from,
             "where in the clip the seed starts: a frame (240) or seconds (2.5s) [its start]")
          ->type_name("FRAME");
      option("--count", args->count, "number of different continuations")
          ->check(positive())
          ->capture_default_str();
      add_sampling_options(*verb, args->seed, args->first_sample, args->rate, args->out, "continuations");
      add_reading_options(*verb, args->clips, false);
      option("--html", args->html, "also write an HTML page: the clip next to its continuations")
          ->type_name("FILE");
      option("--png", args->png, "also write a picture of their poses")->type_name("FILE");
      add_weights_option(*verb, args->weights);
      add_format_option(*verb, args->format);
      add_skeleton_options(*verb, args->retargeting);
      add_clean_options(*verb, args->cleaning);
      verb->callback([&job, args] { job = [args] { return complete(*args); }; });
    }};

}  // namespace

}  // namespace motiongan::command

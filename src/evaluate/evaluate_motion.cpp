// motiongan evaluate motion: compares files of generated and real motion by metrics that need no model.
#include "shared/quality.hpp"

#include <map>

#include "motiongan/formats/text_file.hpp"
#include "motiongan/metrics/npss.hpp"
#include "motiongan/motion/motion.hpp"
#include "motiongan/motion/root_joint.hpp"
#include "motiongan/motion/skeleton_match.hpp"
#include "shared/clip_reading.hpp"
#include "shared/outputs.hpp"

namespace motiongan::command {
namespace {

struct EvaluateMotionArgs {
  std::string generated, real, json;
  double rate = 0;
  FootSkateOptions feet;
  motion::ClipOptions clips;
};

/// Motions by their id: the file's path below the folder, without its extension.
using NamedMotions = std::map<std::string, motion::Motion>;

/// Loads the clips of a folder or a file at one rate, without T-poses; clips of fewer than four frames are
/// left out.
NamedMotions load(const fs::path& where, double rate, const motion::ClipOptions& options) {
  NamedMotions out;
  std::size_t short_ones = 0;
  for_each_clip(where, options,
                [&](const fs::path& file, const std::string& id, motion::LoadedMotion&& loaded) {
                  motion::Motion motion = std::move(loaded.motion);
                  if (rate > 0) motion = motion::resample(motion, rate, file.string());
                  if (!out.empty())
                    motion::require_same_joints(out.begin()->second.skeleton, motion.skeleton, file.string());
                  motion.frames < 4 ? void(++short_ones) : void(out.emplace(id, std::move(motion)));
                });
  if (short_ones > 0)
    fmt::print(stderr, "motiongan: {} of {} with fewer than four frames left out\n",
               counted(short_ones, "clip"), where.string());
  require(!out.empty(), where.string(), " holds no clip of four frames",
          rate > 0 ? concat(" at ", brief(rate), " per second") : std::string(), "; nothing to measure");
  return out;
}

std::vector<motion::Motion> all_of(const NamedMotions& named) {
  std::vector<motion::Motion> out;
  for (const auto& [id, motion] : named) out.push_back(motion);
  return out;
}

double seconds_of(const NamedMotions& named) {
  double seconds = 0;
  for (const auto& [id, motion] : named) seconds += static_cast<double>(motion.frames - 1) / motion.rate;
  return seconds;
}

/// NPSS over files of equal names, which are taken as prediction and ground truth.
struct Pairs {
  Npss npss;
  std::size_t shortest = 0, longest = 0;  ///< frames
};

Pairs compare_pairs(const NamedMotions& generated, const NamedMotions& real) {
  Pairs out;
  for (const auto& [id, made] : generated) {
    const auto at = real.find(id);
    if (at == real.end()) continue;
    const motion::Motion& truth = at->second;
    motion::require_same_joints(truth.skeleton, made.skeleton, "the generated clip " + id);
    const std::size_t frames = std::min(truth.frames, made.frames);
    const auto root = static_cast<std::size_t>(motion::moving_root(truth));
    out.npss.add(prediction_angles(motion::slice(truth, 0, frames), root),
                 prediction_angles(motion::slice(made, 0, frames), root), frames);
    out.shortest = out.npss.sequences() == 1 ? frames : std::min(out.shortest, frames);
    out.longest = std::max(out.longest, frames);
  }
  return out;
}

int evaluate_motion(const EvaluateMotionArgs& args) {
  check_output("--json", args.json, json_output, {args.generated, args.real});
  const NamedMotions generated = load(args.generated, args.rate, args.clips);
  // Speeds and jerk depend on the rate, so both sets are resampled to that of the generated one.
  const double rate = args.rate > 0 ? args.rate : generated.begin()->second.rate;
  for (const auto& [id, motion] : generated)
    require(motion.rate == rate, "the generated clips have different rates (", brief(rate), " and ",
            brief(motion.rate), " per second); choose one with --rate");
  const NamedMotions real = load(args.real, rate, args.clips);
  const MotionQuality made = measure_quality(all_of(generated), args.feet),
                      truth = measure_quality(all_of(real), args.feet);
  const Pairs pairs = compare_pairs(generated, real);

  std::vector<std::vector<std::string>> rows{
      {"clips", std::to_string(made.motions), std::to_string(truth.motions)},
      {"seconds", cell(seconds_of(generated), 1), cell(seconds_of(real), 1)}};
  for (auto& row : quality_rows(made, truth)) rows.push_back(std::move(row));
  const std::size_t count = pairs.npss.sequences();
  if (count > 0) rows.push_back({"NPSS", cell(pairs.npss.value(), 4), "0"});
  fmt::print("at {} frames per second\n\n", brief(rate));
  print_table({"", "generated", "real"}, rows, "lrr");
  fmt::print("\n");
  print_quality_notes(truth, args.feet);
  if (count > 0)
    fmt::print("NPSS: {} of files with equal names, over {} frames; lower is better\n",
               counted(count, "pair"),
               pairs.shortest == pairs.longest ? std::to_string(pairs.longest)
                                               : fmt::format("{} to {}", pairs.shortest, pairs.longest));
  else
    fmt::print("NPSS is not measured: no files of the two folders have equal names\n");
  fmt::print("`{} compare` prints spread, speed and range of each joint\n", program());
  if (args.json.empty()) return 0;
  nlohmann::json out{{"rate", rate}, {"generated", quality_json(made)}, {"real", quality_json(truth)}};
  if (count > 0) out["npss"] = {{"value", pairs.npss.value()}, {"pairs", count}, {"frames", pairs.longest}};
  make_folder_of(args.json);
  motion::write_text_atomically(args.json, out.dump(2) + "\n");
  fmt::print("wrote {}\n", shown(args.json));
  return 0;
}

const Verb evaluate_motion_verb{
    "evaluate motion", [](CLI::App& evaluate, Job& job) {
      CLI::App* verb =
          evaluate.add_subcommand("motion",
                                  "Compare generated with real clips without any model: foot "
                                  "skating, jerk, bone-length error; and NPSS\n"
                                  "over files of equal names, taken as prediction and ground truth.");
      const auto args = std::make_shared<EvaluateMotionArgs>();
      verb->add_option("--generated", args->generated, "motion file, or folder of them")
          ->required()
          ->type_name("DIR");
      verb->add_option("--real", args->real, "motion file, or folder of them")->required()->type_name("DIR");
      verb->add_option("--rate", args->rate, "frames per second to measure at [the generated clips']")
          ->check(CLI::Range(1e-3, 1e4))
          ->type_name("HZ");
      add_quality_options(*verb, args->feet);
      add_reading_options(*verb, args->clips, true);
      verb->add_option("--json", args->json, "also write all results as JSON")->type_name("FILE");
      verb->callback([&job, args] { job = [args] { return evaluate_motion(*args); }; });
    }};

}  // namespace

}  // namespace motiongan::command

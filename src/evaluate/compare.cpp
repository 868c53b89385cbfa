// motiongan compare: statistics of generated clips next to those of real ones.
#include "motiongan/formats/text_file.hpp"
#include "motiongan/metrics/statistics.hpp"
#include "motiongan/motion/motion.hpp"
#include "shared/clip_reading.hpp"
#include "shared/outputs.hpp"

namespace motiongan::command {
namespace {

struct CompareArgs {
  std::vector<std::string> generated, real;
  double rate = 0, margin = 0.05;
  std::string csv;
  motion::ClipOptions clips;
};

/// Loads the clips of files and folders at one rate, without T-poses; clips of fewer than two frames are left
/// out.
std::vector<motion::Motion> load(const std::vector<std::string>& where, double rate,
                                 const motion::ClipOptions& options) {
  std::vector<motion::Motion> out;
  std::size_t short_ones = 0;
  for (const std::string& given : where)
    for_each_clip(given, options,
                  [&](const fs::path& file, const std::string&, motion::LoadedMotion&& loaded) {
                    motion::Motion motion = std::move(loaded.motion);
                    if (rate > 0) motion = motion::resample(motion, rate, file.string());
                    motion.frames < 2 ? void(++short_ones) : out.push_back(std::move(motion));
                  });
  if (short_ones > 0)
    fmt::print(stderr, "motiongan: {} with fewer than two frames left out\n", counted(short_ones, "clip"));
  return out;
}

int compare_sets(const CompareArgs& args) {
  check_output("--csv", args.csv, table_output, inputs_of(args.generated, args.real));
  const std::vector<motion::Motion> generated = load(args.generated, args.rate, args.clips);
  require(!generated.empty(), "no generated clip has at least two frames; nothing to compare");
  // Speeds depend on the rate, so both sets are resampled to that of the generated one.
  const double rate = args.rate > 0 ? args.rate : generated.front().rate;
  for (const motion::Motion& motion : generated)
    require(motion.rate == rate, "the generated clips have different rates (", brief(rate), " and ",
            brief(motion.rate), " per second); choose one with --rate");
  std::vector<motion::Motion> real = load(args.real, rate, args.clips);
  require(!real.empty(), "no real clip has at least two frames at ", brief(rate),
          " per second; nothing to compare with");
  scale_all_to(generated.front().skeleton, real, "the real clips");
  const motion::StatisticsComparison result =
      motion::compare(motion::measure(generated), motion::measure(real), args.margin);
  fmt::print("at {} frames per second; ratios are generated / real\n\n{}", brief(rate),
             motion::to_table(result));
  if (!args.csv.empty()) {
    make_folder_of(args.csv);
    motion::write_text_atomically(args.csv, motion::to_csv(result));
    fmt::print("wrote {}\n", args.csv);
  }
  return 0;
}

const Verb compare_verb{
    "compare", [](CLI::App& app, Job& job) {
      CLI::App* verb = app.add_subcommand(
          "compare", "Compare statistics of generated and real clips: spread, speed and range of each joint");
      const auto args = std::make_shared<CompareArgs>();
      verb->add_option("--generated", args->generated, "motion files, or folders of them")
          ->required()
          ->type_name("FILES");
      verb->add_option("--real", args->real, "motion files, or folders of them")
          ->required()
          ->type_name("FILES");
      verb->add_option("--rate", args->rate, "frames per second to compare at [the generated clips']")
          ->check(CLI::Range(1e-3, 1e4))
          ->type_name("HZ");
      verb->add_option("--margin", args->margin, "widen the real range by this fraction of it at either end")
          ->check(not_negative())
          ->capture_default_str();
      verb->add_option("--csv", args->csv, "also write the table as CSV, a line for each joint")
          ->type_name("FILE");
      add_reading_options(*verb, args->clips, true);
      verb->callback([&job, args] { job = [args] { return compare_sets(*args); }; });
    }};

}  // namespace

}  // namespace motiongan::command

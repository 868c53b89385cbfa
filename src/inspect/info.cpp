// motiongan info: shows what a file or a folder contains.
#include "inspect/info.hpp"

#include "inspect/plot_log.hpp"
#include "motiongan/data/first_frame.hpp"
#include "motiongan/data/pose.hpp"
#include "motiongan/formats/bvh.hpp"
#include "motiongan/io/safetensors.hpp"
#include "motiongan/motion/motion.hpp"
#include "motiongan/train/csv_log.hpp"
#include "shared/write_png.hpp"

namespace motiongan::command {
namespace {

struct InfoArgs {
  std::string path, captions, png;
};

std::string vector_text(const motion::Vec3& v) {
  return fmt::format("({}, {}, {})", brief(v[0]), brief(v[1]), brief(v[2]));
}

void print_clip(const fs::path& file) {
  const motion::Clip clip = motion::read_bvh(file);
  const motion::Motion motion = motion::to_motion(clip);
  fmt::print("{}: a BVH clip\n", file.string());
  print_fact("frames", fmt::format("{} at {} per second ({})", clip.frames, brief(motion.rate),
                                   duration(static_cast<double>(clip.frames) / motion.rate)));
  std::size_t ends = 0;
  for (const motion::Joint& joint : clip.skeleton.joints) ends += joint.end_site.has_value();
  print_fact(
      "skeleton",
      fmt::format("{}, {}, {}; root {}", counted(clip.skeleton.size(), "joint"), counted(ends, "end site"),
                  counted(clip.skeleton.channel_count(), "channel"), clip.skeleton.joints.front().name));
  std::string names;
  for (const motion::Joint& joint : clip.skeleton.joints) names += (names.empty() ? "" : " ") + joint.name;
  print_fact("joints", names);
  if (clip.frames == 0) return;
  const std::size_t posed = motion::t_pose_frames(clip);
  print_fact("first frame", posed > 0 ? fmt::format("T-pose: {} before the motion", counted(posed, "frame"))
                                      : "part of the motion (no T-pose)");
  const auto root = static_cast<std::size_t>(motion::moving_root(motion));
  double travelled = 0;
  for (std::size_t f = posed + 1; f < clip.frames; ++f)
    travelled += motion::length(motion::subtract(motion.position(f, root), motion.position(f - 1, root)));
  print_fact("travel", fmt::format("{} moves {} units, from {} to {}", clip.skeleton.joints[root].name,
                                   brief(travelled), vector_text(motion.position(posed, root)),
                                   vector_text(motion.position(clip.frames - 1, root))));
}

void print_log(const fs::path& file, const std::string& png) {
  const CsvTable log = read_csv_log(file);
  fmt::print("{}: a log of {}\n", file.string(), counted(log.rows.size(), "row"));
  if (log.rows.empty()) return;
  for (std::size_t c = 0; c < log.columns.size(); ++c)
    fmt::print("  {:<22} {}\n", log.columns[c], brief(log.rows.back()[c], 6));
  if (std::find(log.columns.begin(), log.columns.end(), "wasserstein") != log.columns.end()) {
    const CurveSummary w = summarise(log.column("wasserstein"));
    fmt::print("the Wasserstein estimate peaked at iteration {:.0f} ({}) and ended at {} (running means)\n",
               log.column("iteration")[w.peak_at], brief(w.peak), brief(w.last));
  }
  if (png.empty()) return;
  make_folder_of(png);
  write_png(png, plot_log(log, file.string()));
  fmt::print("wrote {}: the curves\n", png);
}

int info(const InfoArgs& args) {
  const fs::path path = args.path;
  require(fs::exists(path), path.string(), " does not exist");
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (fs::is_directory(path)) {
    if (fs::exists(path / "checkpoint.safetensors"))
      print_run(path);
    else
      print_folder(path, args.captions);
  } else if (extension == ".safetensors") {
    print_tensors(path);
  } else if (extension == ".csv") {
    print_log(path, args.png);
    return 0;
  } else {
    print_clip(path);
  }
  require(args.png.empty(), "--png draws the curves of a log.csv; for clips use `motiongan view --png`");
  return 0;
}

const Verb info_verb{
    "info", [](CLI::App& app, Job& job) {
      CLI::App* verb =
          app.add_subcommand("info",
                             "Show what a file or a folder contains: a model or checkpoint "
                             "(.safetensors), the folder of a run, a BVH\n"
                             "clip, a folder of clips with their captions, the log.csv of a run.");
      const auto args = std::make_shared<InfoArgs>();
      verb->add_option("PATH", args->path, "file or folder")->required()->type_name("");
      verb->add_option("--captions", args->captions, "captions of a folder of clips [captions.tsv in it]")
          ->type_name("FILE");
      verb->add_option("--png", args->png, "picture to write: the curves of a log.csv")->type_name("FILE");
      verb->callback([&job, args] { job = [args] { return info(*args); }; });
    }};

}  // namespace

}  // namespace motiongan::command

// motiongan info: shows what a file or a folder contains.
#include "inspect/info.hpp"

#include "inspect/plot_log.hpp"
#include "motiongan/io/safetensors.hpp"
#include "motiongan/models/shipped_models.hpp"
#include "motiongan/motion/motion.hpp"
#include "motiongan/motion/root_joint.hpp"
#include "motiongan/train/csv_log.hpp"
#include "shared/clip_reading.hpp"
#include "shared/outputs.hpp"
#include "shared/write_png.hpp"

namespace motiongan::command {
namespace {

struct InfoArgs {
  std::string path, captions, png;
  motion::ClipOptions clips;
};

std::string vector_text(const motion::Vec3& v) {
  return fmt::format("({}, {}, {})", brief(v[0]), brief(v[1]), brief(v[2]));
}

const char* format_name(const fs::path& file) {
  const std::string extension = motion::extension_of(file);
  return extension == ".amc"                          ? "an AMC clip"
         : motion::holds_scene(file)                  ? "an animated skeleton"
         : extension == ".npz"                        ? "an AMASS clip"
         : extension == ".npy" || extension == ".csv" ? "a clip of joint positions"
                                                      : "a BVH clip";
}

/// Prints size and axes of the body, and how far it travels.
void print_body(const motion::LoadedMotion& loaded) {
  const motion::Motion& motion = loaded.motion;
  const double height = motion::body_height(motion.skeleton), legs = motion::leg_length(motion.skeleton);
  const double unit = loaded.unit_metres > 0 ? loaded.unit_metres : motion::likely_unit_metres(height);
  print_fact("body", fmt::format("{} units high at rest{}{}", brief(height),
                                 legs > 0 ? fmt::format(", legs {}", brief(legs)) : std::string(),
                                 unit > 0 ? fmt::format("; {} m at {} m per unit{}", brief(height * unit, 3),
                                                        brief(unit),
                                                        loaded.unit_metres > 0 ? "" : ", which is a guess")
                                          : std::string()));
  print_fact("up axis", !loaded.up                        ? "not sure, taken to be y; --up tells"
                        : *loaded.up == motion::UpAxis::y ? "y"
                                                          : "z, turned to y here");
  const auto root = static_cast<std::size_t>(motion::moving_root(motion));
  double travelled = 0;
  for (std::size_t f = 1; f < motion.frames; ++f)
    travelled += motion::length(motion::subtract(motion.position(f, root), motion.position(f - 1, root)));
  print_fact("travel", fmt::format("{} moves {} units, from {} to {}", motion.skeleton.joints[root].name,
                                   brief(travelled), vector_text(motion.position(0, root)),
                                   vector_text(motion.position(motion.frames - 1, root))));
}

/// Prints a file of joint positions that has no bone list.
void print_positions(const fs::path& file, const motion::ClipOptions& options) {
  const std::string text = motion::read_text(file, "file of joint positions");
  const bool npy = motion::extension_of(file) == ".npy";
  const motion::Skeleton joints = motion::joints_without_bones(text, npy, file.string());
  const double rate = options.fps > 0 ? options.fps : npy ? 1 : 0;
  const motion::PositionClip clip = npy ? motion::parse_position_npy(text, joints, rate, file.string())
                                        : motion::parse_position_csv(text, joints, rate, file.string());
  fmt::print("{}: {}\n", file.string(), format_name(file));
  const bool timed = !npy || options.fps > 0;
  print_fact("frames", timed ? fmt::format("{} at {} per second ({})", clip.frames, brief(clip.rate),
                                           duration(static_cast<double>(clip.frames) / clip.rate))
                             : fmt::format("{}; the file holds no rate, --fps tells", clip.frames));
  std::string names;
  for (const motion::Joint& joint : joints.joints) names += (names.empty() ? "" : " ") + joint.name;
  print_fact("joints", fmt::format("{}: {}", joints.size(), npy ? "without names" : names));
  print_fact("hierarchy",
             "none: no bones.tsv next to the file, no --bones; to view or train, write one\n"
             "              (lines of joint <TAB> parent, - for the root)");
}

void print_clip(const fs::path& file, const motion::ClipOptions& options) {
  const motion::LoadedMotion loaded = motion::read_motion(file, options);
  const motion::Motion& motion = loaded.motion;
  const motion::Skeleton& skeleton = motion.skeleton;
  fmt::print("{}: {}\n", file.string(), format_name(file));
  const std::size_t frames = motion.frames + loaded.dropped;
  print_fact("frames", fmt::format("{} at {} per second ({})", frames, brief(motion.rate),
                                   duration(static_cast<double>(frames) / motion.rate)));
  std::size_t ends = 0;
  for (const motion::Joint& joint : skeleton.joints) ends += joint.end_site.has_value();
  print_fact("skeleton",
             fmt::format("{}, {}, {}; root {}", counted(skeleton.size(), "joint"), counted(ends, "end site"),
                         counted(skeleton.channel_count(), "channel"), skeleton.joints.front().name));
  std::string names;
  for (const motion::Joint& joint : skeleton.joints) names += (names.empty() ? "" : " ") + joint.name;
  print_fact("joints", names);
  for (const std::string& note : loaded.notes) print_fact("note", note);
  if (motion.frames == 0) return;
  print_fact("first frame", loaded.dropped > 0 ? fmt::format("T-pose: {} before the motion",
                                                             counted(loaded.dropped, "frame"))
                                               : "part of the motion (no T-pose)");
  print_body(loaded);
}

void print_file(const fs::path& file, const motion::ClipOptions& options) {
  double rate = options.fps;
  const std::string extension = motion::extension_of(file);
  const bool positions = extension == ".csv" || extension == ".npy";
  const bool has_bones =
      !positions || !motion::bone_list_of(file, options.bones).empty() ||
      (extension == ".npy" &&
       motion::known_skeleton_of(motion::read_text(file, "array"), file.string(), rate).has_value());
  has_bones ? print_clip(file, options) : print_positions(file, options);
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
  // A name that is no file may be a shipped model's.
  const fs::path path =
      fs::exists(motion::ClipPath(args.path).file) ? fs::path(args.path) : find_model(args.path);
  require(fs::exists(motion::ClipPath(path).file), path.string(), " does not exist");
  check_output("--png", args.png, picture_output, {path, args.captions});
  const std::string extension = motion::extension_of(path);
  if (fs::is_directory(path)) {
    if (fs::exists(path / "checkpoint.safetensors"))
      print_run(path);
    else
      print_folder(path, args.captions, args.clips);
  } else if (extension == ".safetensors") {
    print_tensors(path);
  } else if (extension == ".csv" && !motion::is_position_csv(motion::read_text(path, "CSV file"))) {
    print_log(path, args.png);
    return 0;
  } else {
    print_file(path, args.clips);
  }
  require(args.png.empty(), "--png draws the curves of a log.csv; for clips use `motiongan view --png`");
  return 0;
}

const Verb info_verb{
    "info", [](CLI::App& app, Job& job) {
      CLI::App* verb = app.add_subcommand(
          "info",
          "Show what a file or a folder contains: a model or checkpoint "
          "(.safetensors), the folder of a run, a clip\n"
          "(BVH, GLB, FBX, AMC, NPZ, NPY, CSV), a folder of clips with their captions, the log.csv of "
          "a run.");
      const auto args = std::make_shared<InfoArgs>();
      verb->add_option("PATH", args->path, "file or folder, or the name of a shipped model")
          ->required()
          ->type_name("");
      verb->add_option("--captions", args->captions,
                       "captions of a folder of clips [captions.tsv, .csv or .json in it, else .txt files]")
          ->type_name("FILE");
      verb->add_option("--png", args->png, "picture to write: the curves of a log.csv")->type_name("FILE");
      add_reading_options(*verb, args->clips, false);
      verb->callback([&job, args] { job = [args] { return info(*args); }; });
    }};

}  // namespace

}  // namespace motiongan::command

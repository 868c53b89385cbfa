#include "shared/action_data.hpp"

#include <cmath>

#include "motiongan/procedural/procedural.hpp"
#include "shared/clip_reading.hpp"
#include "train/run_start.hpp"

namespace motiongan::command {

void add_action_data_options(CLI::App& verb, ActionDataArgs& a, bool windows) {
  verb.add_option("FOLDER", a.folder,
                  "folder of motion files (BVH, GLB, FBX, AMC, NPZ, NPY, CSV; searched recursively)")
      ->type_name("");
  std::vector<std::string_view> without{"folder"};
  if (!windows) without.insert(without.end(), {"frames", "rate", "root_track"});
  add_options(verb, fields_of(a), "Data", {.without = without});
  verb.get_option("--procedural")->expected(0, 1)->default_str("68")->group("Options");
}

void fill_in_choices(ActionDataArgs& a) {
  motion::ActionDatasetOptions& o = a.options;
  const auto absolute = [](fs::path& path) {
    if (!path.empty()) path = fs::absolute(path).lexically_normal();
  };
  const bool labelled = !o.labels.empty() || o.folders || o.pattern.find("{label}") != std::string::npos;
  if (a.procedural > 0) {
    require(!labelled && o.clips.bones.empty(),
            "--procedural has labels of its own: leave out --labels, --folders, --pattern and --bones");
  } else if (!labelled && fs::is_regular_file(fs::path(a.folder) / "labels.tsv")) {
    o.labels = fs::path(a.folder) / "labels.tsv";
  }
  if (!a.folder.empty()) a.folder = fs::absolute(a.folder).lexically_normal().string();
  absolute(o.labels);
  absolute(o.clips.bones);
  absolute(o.clips.skeleton_of);
}

void take_data_of_run(ActionDataArgs& args, const CLI::App& verb, const fs::path& run, const char* remedy) {
  const fs::path checkpoint = RunFiles{run}.checkpoint();
  if (const std::string note = options_note(checkpoint); !note.empty())
    take_note(fields_of(args), verb, note, checkpoint, options_of_action_clips);
  require(!args.folder.empty() || args.procedural > 0, run.string(),
          " does not say what the model was trained on; ", remedy);
}

std::vector<motion::LabelledMotion> procedural_clips(const ActionDataArgs& args) {
  // Windows have 2T frames; clips have at least 3T.
  motion::ProceduralOptions options;
  options.clips = args.procedural;
  options.seconds = std::max(10.0, 3 * static_cast<double>(args.options.frames) / args.options.rate);
  options.rate = args.options.rate * std::max(1.0, std::ceil(30 / args.options.rate));
  return motion::procedural_motions(options);
}

motion::ActionDataset load_data(const ActionDataArgs& args) {
  if (args.procedural == 0) {
    fmt::print("reading {}\n", shown(args.folder));
    return motion::ActionDataset::from_folder(args.folder, args.options);
  }
  fmt::print("computing {} of built-in motion\n", counted(args.procedural, "clip"));
  motion::ActionDatasetOptions options = args.options;
  options.pattern = "{label}_*";
  return motion::ActionDataset::from_motions(procedural_clips(args), options);
}

std::string quoted_list(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "'" : ", '") + name + "'";
  return out;
}

void print_data(const motion::ActionDataset& data, const ActionDataArgs& args) {
  const motion::PositionFormat& format = data.format;
  const double window = 2 * static_cast<double>(format.frames) / format.rate;
  std::size_t windows = 0;
  for (const motion::ActionClip& clip : data.train) windows += data.starts(clip);
  std::string clips =
      fmt::format("{} for training, {} held out for testing", data.train.size(), data.test.size());
  const auto left_out = [&](std::size_t n, const std::string& why) {
    if (n > 0) clips += fmt::format("; {} left out, {}", n, why);
  };
  left_out(data.skipped.size(), "shorter than " + duration(window));
  left_out(data.bad.size(), "that cannot be read");
  left_out(data.other_skeletons.size(), "of other skeletons");
  left_out(data.unlabelled, "without a label");
  left_out(data.other_classes, "of other classes");
  print_fact("clips", clips);
  print_fact("windows", fmt::format("{} for training, of 2 x {} frames at {} per second ({})", windows,
                                    format.frames, brief(format.rate), duration(window)));
  std::string classes;
  for (std::size_t c = 0; c < format.classes.size(); ++c) {
    const auto of = [&](const std::vector<motion::ActionClip>& part) {
      return std::count_if(part.begin(), part.end(),
                           [&](const motion::ActionClip& clip) { return clip.label == c; });
    };
    classes += fmt::format("{}{} {}+{}", c > 0 ? ", " : "", format.classes[c], of(data.train), of(data.test));
  }
  print_fact("classes", classes + " (training + test clips)");
  print_fact("labels", args.procedural > 0            ? "the built-in actions"
                       : !args.options.labels.empty() ? "from " + shown(args.options.labels)
                       : args.options.folders         ? "from the folders' names"
                                              : "from file names, by the pattern " + args.options.pattern);
  print_fact("skeleton",
             fmt::format("{}, root {}; {} per pose vary{}", counted(format.skeleton().size(), "joint"),
                         format.skeleton().joints.front().name, counted(format.dof(), "value"),
                         format.layout.root_track() ? ", including the root's steps, turns and height"
                                                    : "; the root stays in place"));
  print_fact("space", describe(format.space));
  if (data.dropped_frames > 0)
    print_fact("first frame", counted(data.dropped_frames, "frame") + " dropped at the start of clips");
  print_skipped(data.bad);
  print_notes(data.notes);
}

}  // namespace motiongan::command

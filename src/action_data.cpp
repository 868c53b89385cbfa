// Clips with classes, as several verbs are told of them.
#include "action_data.hpp"

#include <cmath>

#include "motiongan/procedural/procedural.hpp"
#include "train/run_start.hpp"

namespace motiongan::command {

bool describes_clips(const std::string& name) {
  return name == "--labels" || name == "--folders" || name == "--pattern" || name == "--bones" ||
         name == "--test-subjects" || name == "--classes";
}

void add_action_data_options(CLI::App& verb, ActionDataArgs& a, bool windows) {
  const auto option = [&](const char* name, auto& member, const char* text) {
    return verb.add_option(name, member, text)->group("Data");
  };
  verb.add_option("FOLDER", a.folder, "folder of BVH, CSV or NPY clips (and folders in it)")->type_name("");
  verb.add_option(
          "--procedural", a.procedural,
          "instead of FOLDER: so many clips of built-in motion, of the class that their name begins with")
      ->expected(0, 1)
      ->default_str("68")
      ->type_name("CLIPS");
  option("--labels", a.labels, "file of lines `clip id <TAB> label` [FOLDER/labels.tsv]")->type_name("FILE");
  verb.add_flag("--folders", a.options.folders, "a clip's label is the folder below FOLDER that it lies in")
      ->group("Data");
  option("--pattern", a.options.pattern,
         "of file names without extension: {label}, {subject}, * and text, such as *_{label}_*")
      ->type_name("PATTERN");
  option("--classes", a.options.classes, "keep only clips of these labels [all]")
      ->delimiter(',')
      ->type_name("A,B");
  option("--bones", a.bones, "lines `joint <TAB> parent` for CSV and NPY files [bones.tsv beside them]")
      ->type_name("FILE");
  option("--first-frame", a.first_frame,
         "auto: drop T-poses put before the motion; keep; drop: the first frame")
      ->check(CLI::IsMember({"auto", "keep", "drop"}))
      ->capture_default_str();
  verb.add_flag("--subjects", a.options.by_subject,
                "all clips of a subject go to the same part (subject: by --pattern, else the name up to its "
                "first _)")
      ->group("Data");
  option("--test-subjects", a.options.test_subjects, "these, and only these, are for testing")
      ->delimiter(',')
      ->type_name("A,B");
  option("--train-share", a.options.train_share, "share of the clips to train on; the rest is for testing")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  option("--split-seed", a.options.split_seed, "which clips those are")
      ->check(not_negative())
      ->capture_default_str();
  if (!windows) return;
  option("--frames", a.options.frames, "T: frames that are given, and that are made at once")
      ->check(positive())
      ->capture_default_str();
  option("--rate", a.options.rate, "frames per second")->check(positive())->capture_default_str();
  verb.add_flag("--root,!--no-root", a.options.root_track,
                "learn steps, turns and height of the root, so that characters travel [on]")
      ->group("Data");
}

void default_procedural(const CLI::App& verb, ActionDataArgs& args) {
  if (verb.count("--procedural") > 0 && verb.get_option("--procedural")->results().front().empty())
    args.procedural = 68;
}

void fill_in_choices(ActionDataArgs& a) {
  const auto absolute = [](std::string& path) {
    if (!path.empty()) path = fs::absolute(path).lexically_normal().string();
  };
  const bool told =
      !a.labels.empty() || a.options.folders || a.options.pattern.find("{label}") != std::string::npos;
  if (a.procedural > 0) {
    require(!told && a.bones.empty(),
            "--procedural has labels of its own: leave --labels, --folders, --pattern and "
            "--bones out");
  } else if (!told && fs::is_regular_file(fs::path(a.folder) / "labels.tsv")) {
    a.labels = (fs::path(a.folder) / "labels.tsv").string();
  }
  absolute(a.folder);
  absolute(a.labels);
  absolute(a.bones);
  a.options.labels = a.labels;
  a.options.bones = a.bones;
  a.options.first_frame = a.first_frame == "keep"   ? motion::FirstFrame::keep
                          : a.first_frame == "drop" ? motion::FirstFrame::drop
                                                    : motion::FirstFrame::automatic;
}

void take_data_of_run(ActionDataArgs& args, const CLI::App& verb, const fs::path& run, const char* remedy) {
  const fs::path checkpoint = RunFiles{run}.checkpoint();
  std::string note;
  if (fs::exists(checkpoint)) {
    const RunRecord record = read_run_record(checkpoint);
    if (const auto found = record.notes.find("options"); found != record.notes.end()) note = found->second;
  }
  if (!note.empty())
    take_note([&](const auto& f) { each_kept(args, f); }, verb, note, checkpoint, describes_clips);
  require(!args.folder.empty() || args.procedural > 0, run.string(),
          " does not say what the model was trained on; ", remedy);
}

std::vector<motion::LabelledMotion> procedural_clips(const ActionDataArgs& args) {
  // Windows are two times T frames; a clip holds three.
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
  std::string clips = fmt::format("{} to train on, {} kept for testing", data.train.size(), data.test.size());
  const auto left_out = [&](std::size_t n, const std::string& why) {
    if (n > 0) clips += fmt::format("; {} left out, {}", n, why);
  };
  left_out(data.skipped.size(), "shorter than " + duration(window));
  left_out(data.unlabelled, "without a label");
  left_out(data.other_classes, "of other classes");
  print_fact("clips", clips);
  print_fact("windows", fmt::format("{} to train on, of 2 x {} frames at {} per second ({})", windows,
                                    format.frames, brief(format.rate), duration(window)));
  std::string classes;
  for (std::size_t c = 0; c < format.classes.size(); ++c) {
    const auto of = [&](const std::vector<motion::ActionClip>& part) {
      return std::count_if(part.begin(), part.end(),
                           [&](const motion::ActionClip& clip) { return clip.label == c; });
    };
    classes += fmt::format("{}{} {}+{}", c > 0 ? ", " : "", format.classes[c], of(data.train), of(data.test));
  }
  print_fact("classes", classes + " (clips to train on + for testing)");
  print_fact("labels", args.procedural > 0    ? "the built-in actions"
                       : !args.labels.empty() ? "from " + shown(args.labels)
                       : args.options.folders ? "from the folders' names"
                                              : "from file names, by " + args.options.pattern);
  print_fact("skeleton",
             fmt::format("{}, root {}; {} of a pose change{}", counted(format.skeleton().size(), "joint"),
                         format.skeleton().joints.front().name, counted(format.dof(), "number"),
                         format.layout.root_track() ? ", steps, turns and height of the root among them"
                                                    : "; the root stays where it is"));
  if (data.dropped_frames > 0)
    print_fact("first frame", counted(data.dropped_frames, "frame") + " at the start of clips left out");
}

}  // namespace motiongan::command

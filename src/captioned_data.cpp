#include "captioned_data.hpp"

#include "motiongan/procedural/procedural.hpp"

namespace motiongan::command {
namespace {

/// What says which clips, and what is said of them.
void add_clip_options(CLI::App& verb, CaptionedDataArgs& a, const char* folder, const char* procedural) {
  verb.add_option("FOLDER", a.folder, folder)->type_name("");
  verb.add_option("--captions", a.captions,
                  "file of lines `clip id <TAB> description` [FOLDER/captions.tsv, else from file names]")
      ->type_name("FILE");
  verb.add_option("--procedural", a.procedural, procedural)
      ->expected(0, 1)
      ->default_str("68")
      ->type_name("CLIPS");
}

}  // namespace

void add_test_clip_options(CLI::App& verb, CaptionedDataArgs& a) {
  add_clip_options(verb, a, "other clips than those kept for testing by the run",
                   "built-in motion: so many clips");
  verb.add_option("--train-share", a.data.train_share, "share of the clips that is not looked at [the run's]")
      ->capture_default_str();
  verb.add_option("--split-seed", a.data.split_seed, "which clips those are [the run's]")
      ->check(not_negative())
      ->capture_default_str();
}

void add_captioned_data_options(CLI::App& verb, CaptionedDataArgs& a) {
  const auto option = [&](const char* name, auto& member, const char* text) {
    return verb.add_option(name, member, text)->capture_default_str();
  };
  add_clip_options(verb, a, "folder of BVH clips (and folders in it), or one clip",
                   "instead of FOLDER: train on so many clips of built-in motion");

  option("--frames", a.data.frames, "frames of a motion; a power of two where a network is a CNN")
      ->check(positive())
      ->group("Data");
  option("--rate", a.data.rate, "frames per second")->check(positive())->group("Data");
  verb.add_flag("--root-position,!--no-root-position", a.data.root_position,
                "learn where the root is, not only how it turns [on]")
      ->group("Data");
  option("--root-rotation", a.root_rotation,
         "heading: place and turn, every motion starts facing the same way; velocity: steps and turns, for "
         "motion without end; expmap: as the papers [auto: velocity for the RNN generator, else heading]")
      ->check(CLI::IsMember({"auto", "heading", "velocity", "expmap"}))
      ->group("Data");
  option("--first-frame", a.first_frame,
         "auto: drop T-poses put before the motion; keep; drop: the first frame")
      ->check(CLI::IsMember({"auto", "keep", "drop"}))
      ->group("Data");
  option("--train-share", a.data.train_share, "share of the clips to train on; the rest is for testing")
      ->group("Data");
  option("--split-seed", a.data.split_seed, "which clips those are")->check(not_negative())->group("Data");
}

void fill_in_procedural(const CLI::App& verb, CaptionedDataArgs& args) {
  if (verb.count("--procedural") > 0 && verb.get_option("--procedural")->results().front().empty())
    args.procedural = 68;
}

void fill_in_data(CaptionedDataArgs& a, const std::string& root_rotation) {
  if (!a.folder.empty()) {
    a.captions = captions_for(a.folder, a.captions).string();
    a.folder = fs::absolute(a.folder).lexically_normal().string();
    if (!a.captions.empty()) a.captions = fs::absolute(a.captions).lexically_normal().string();
  }
  if (a.root_rotation == "auto") a.root_rotation = root_rotation;
  a.data.captions = a.captions;
  a.data.first_frame = a.first_frame == "keep"   ? motion::FirstFrame::keep
                       : a.first_frame == "drop" ? motion::FirstFrame::drop
                                                 : motion::FirstFrame::automatic;
  a.data.root_rotation = a.root_rotation == "expmap"     ? motion::RootRotation::expmap
                         : a.root_rotation == "velocity" ? motion::RootRotation::velocity
                                                         : motion::RootRotation::heading;
}

motion::Dataset load_data(const CaptionedDataArgs& args) {
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

void print_data(const motion::Dataset& data, const CaptionedDataArgs& args) {
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

}  // namespace motiongan::command

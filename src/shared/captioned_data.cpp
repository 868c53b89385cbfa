#include "shared/captioned_data.hpp"

#include "motiongan/procedural/procedural.hpp"
#include "train/run_start.hpp"

namespace motiongan::command {
namespace {

constexpr std::size_t default_clips = 68;  // four of each built-in action

/// FOLDER, --procedural and --captions.
void add_clip_options(CLI::App& verb, CaptionedDataArgs& a, const char* folder) {
  verb.add_option("FOLDER", a.folder, folder)->type_name("");
  add_options(verb, fields_of(a), "Options", {.only = {"procedural", "captions"}});
  verb.get_option("--procedural")->expected(0, 1)->default_str(std::to_string(default_clips));
}

}  // namespace

void add_test_clip_options(CLI::App& verb, CaptionedDataArgs& a) {
  add_clip_options(verb, a, "folder of BVH clips to use instead of those of the run");
  add_options(verb, fields_of(a), "Options", {.only = {"train_share", "split_seed"}});
}

void add_captioned_data_options(CLI::App& verb, CaptionedDataArgs& a) {
  add_clip_options(verb, a, "folder of BVH clips (searched recursively), or one clip");
  add_options(verb, fields_of(a), "Data", {.without = {"folder", "procedural", "captions"}});
}

void fill_in_procedural(const CLI::App& verb, std::size_t& procedural) {
  if (verb.count("--procedural") > 0 && verb.get_option("--procedural")->results().front().empty())
    procedural = default_clips;
}

void fill_in_data(CaptionedDataArgs& a, motion::RootRotation root_rotation) {
  if (!a.folder.empty()) {
    const fs::path captions = captions_for(a.folder, a.data.captions);
    a.folder = fs::absolute(a.folder).lexically_normal().string();
    if (!captions.empty()) a.data.captions = fs::absolute(captions).lexically_normal();
  }
  if (!a.data.root_rotation) a.data.root_rotation = root_rotation;
}

void take_captioned_data(CaptionedDataArgs& args, const CLI::App& verb, const fs::path& checkpoint,
                         const fs::path& file) {
  if (const std::string note = options_note(checkpoint); !note.empty())
    take_note(fields_of(args), verb, note, checkpoint, options_of_captioned_clips);
  require(!args.folder.empty() || args.procedural > 0, file.string(),
          " does not say what it was trained on; give the folder of clips, and their --captions");
}

motion::Dataset load_data(const CaptionedDataArgs& args) {
  if (args.procedural == 0) {
    fmt::print("reading {}\n", shown(args.folder));
    return motion::Dataset::from_bvh(args.folder, args.data);
  }
  // A clip holds one and a half windows; its rate is a multiple of the model's, so no frame is interpolated.
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
  std::string clips =
      fmt::format("{} for training, {} held out for testing", data.train.size(), data.test.size());
  if (!data.skipped.empty())
    clips += fmt::format("; {} left out, shorter than {}", data.skipped.size(), duration(window));
  print_fact("clips", clips);
  print_fact("windows",
             fmt::format("{} for training, of {} frames at {} per second ({})", windows(data.train),
                         format.frames, brief(format.rate), duration(window)));
  const std::size_t used = data.train.size() + data.test.size();
  if (args.procedural > 0)
    print_fact("captions", "those of the built-in motion");
  else if (args.data.captions.empty())
    print_fact("captions", "taken from file names (no captions.tsv in the folder, no --captions)");
  else
    print_fact("captions",
               fmt::format("from {}{}", shown(args.data.captions),
                           data.named == 0 ? std::string()
                                           : fmt::format("; {} of {} are not in it and are captioned by "
                                                         "their file names",
                                                         data.named, counted(used, "clip"))));
  print_fact("words", fmt::format("{} in the training captions", format.vocabulary.size() - 1));
  print_fact("skeleton",
             fmt::format("{}, root {}; {} per pose vary{}", counted(format.skeleton().size(), "joint"),
                         format.skeleton().joints[format.layout.root()].name, counted(format.dof(), "value"),
                         format.layout.root_position() ? ", including the root's position" : ""));
  if (data.dropped_frames > 0)
    print_fact(
        "first frame",
        fmt::format(
            "{} dropped at the start of clips{}", counted(data.dropped_frames, "frame"),
            args.data.first_frame == motion::FirstFrame::automatic ? " (a T-pose before the motion)" : ""));
}

}  // namespace motiongan::command

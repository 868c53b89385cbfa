#include "shared/captioned_data.hpp"

#include "motiongan/procedural/procedural.hpp"
#include "shared/caption_report.hpp"
#include "shared/clip_reading.hpp"
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

void print_captions(const motion::Dataset& data, const CaptionedDataArgs& args) {
  const std::size_t used = data.recorded() + data.test.size();
  const bool from_file = !args.data.captions.empty();
  if (args.procedural > 0 && !from_file)
    print_fact("captions", "those of the built-in motion");
  else if (data.captions.source.empty())
    print_fact("captions", fmt::format("taken from file names ({})", no_captions_found));
  else
    print_fact("captions",
               fmt::format("from {}{}", from_file ? shown(args.data.captions) : data.captions.source,
                           data.named == 0 ? std::string()
                                           : fmt::format("; {} of {} captioned by file names", data.named,
                                                         counted(used, "clip"))));
  for (const std::string& remark : caption_remarks(data.captions)) print_fact("", remark);
  if (data.parts == 0) return;
  std::string text = counted(data.parts, "part") + " with captions of their own";
  if (data.described_in_parts > 0)
    text +=
        fmt::format("; {} left out, covered by such parts", counted(data.described_in_parts, "whole clip"));
  print_fact("", text);
}

}  // namespace

void add_test_clip_options(CLI::App& verb, CaptionedDataArgs& a) {
  add_clip_options(verb, a, "folder of clips to use instead of those of the run");
  add_options(verb, fields_of(a), "Options",
              {.only = {"up", "scale", "fps", "first_frame", "bones", "skip_bad", "skeleton_of",
                        "normalise_height", "train_share", "split_seed"}});
}

void add_captioned_data_options(CLI::App& verb, CaptionedDataArgs& a) {
  add_clip_options(verb, a, "folder of motion files (searched recursively), or one clip");
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
  for (fs::path* path : {&a.data.clips.bones, &a.data.clips.skeleton_of})
    if (!path->empty()) *path = fs::absolute(*path).lexically_normal();
  if (!a.data.root_rotation) a.data.root_rotation = root_rotation;
}

void take_captioned_data(CaptionedDataArgs& args, const CLI::App& verb, const fs::path& checkpoint,
                         const fs::path& file) {
  if (const std::string note = options_note(checkpoint); !note.empty())
    take_note(fields_of(args), verb, note, checkpoint, options_of_captioned_clips);
  args.data.mirror = false;  // what is derived from clips serves training alone
  args.data.stretch = 0;
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
      fmt::format("{} for training, {} held out for testing", data.recorded(), data.test.size());
  if (const std::size_t derived = data.train.size() - data.recorded(); derived > 0)
    clips += fmt::format("; {} derived from those for training", derived);
  if (!data.skipped.empty())
    clips += fmt::format("; {} left out, shorter than {}", data.skipped.size(), duration(window));
  if (!data.bad.empty()) clips += fmt::format("; {} that cannot be read", data.bad.size());
  if (!data.other_skeletons.empty())
    clips += fmt::format("; {} of other skeletons", data.other_skeletons.size());
  print_fact("clips", clips);
  print_fact("windows",
             fmt::format("{} for training, of {} frames at {} per second ({})", windows(data.train),
                         format.frames, brief(format.rate), duration(window)));
  print_captions(data, args);
  print_fact("words", fmt::format("{} in the training captions", format.vocabulary.size() - 1));
  print_fact("skeleton",
             fmt::format("{}, root {}; {} per pose vary{}", counted(format.skeleton().size(), "joint"),
                         format.skeleton().joints[format.layout.root()].name, counted(format.dof(), "value"),
                         format.layout.root_position() ? ", including the root's position" : ""));
  print_fact("space", describe(format.space));
  if (data.dropped_frames > 0)
    print_fact("first frame",
               fmt::format("{} dropped at the start of clips{}", counted(data.dropped_frames, "frame"),
                           args.data.clips.first_frame == motion::FirstFrame::automatic
                               ? " (a T-pose before the motion)"
                               : ""));
  print_skipped(data.bad);
  print_notes(data.notes);
}

}  // namespace motiongan::command

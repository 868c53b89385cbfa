// motiongan view: shows clips as stick figures on an HTML page or in a picture.
#include "motiongan/formats/glb.hpp"
#include "motiongan/io/safetensors.hpp"
#include "motiongan/motion/motion.hpp"
#include "shared/clip_reading.hpp"
#include "shared/outputs.hpp"
#include "shared/shell.hpp"
#include "shared/show.hpp"

namespace motiongan::command {
namespace {

struct ViewArgs {
  std::vector<std::string> files;
  std::string html, png, glb;
  double rate = 0;
  motion::ClipOptions clips{.first_frame = motion::FirstFrame::keep};
};

int view_clips(ViewArgs args) {
  const std::vector<fs::path> inputs = inputs_of(args.files, {args.clips.bones.string()});
  check_output("--html", args.html, page_output, inputs);
  check_output("--png", args.png, picture_output, inputs);
  check_output("--glb", args.glb, glb_output, inputs);
  std::vector<view::ViewedMotion> motions;
  double unit_metres = 0;  // that of the last file which says so
  for (const std::string& given : args.files) {
    require(motion::extension_of(given) != ".safetensors", given,
            " is a model; generate motion with it first: ", program(), " generate ", shell_word(given),
            " --text TEXT (or --class NAME) --html page.html");
    for_each_clip(
        given, args.clips, [&](const fs::path& file, const std::string&, motion::LoadedMotion&& loaded) {
          motion::Motion motion = std::move(loaded.motion);
          if (loaded.unit_metres > 0) unit_metres = loaded.unit_metres;
          if (args.rate > 0) motion = motion::resample(motion, args.rate, file.string());
          fmt::print("{}: {} at {} per second, {}\n", file.string(), counted(motion.frames, "frame"),
                     brief(motion.rate), duration(static_cast<double>(motion.frames) / motion.rate));
          motions.push_back({motion::clip_stem(file), std::move(motion)});
        });
  }
  if (args.html.empty() && args.png.empty() && args.glb.empty()) args.html = "view.html";
  if (!args.html.empty())
    show_page(args.html, motions,
              motions.size() == 1 ? motions.front().title : counted(motions.size(), "clip"));
  if (!args.png.empty()) show_strip(args.png, motions);
  if (!args.glb.empty()) {
    make_folder_of(args.glb);
    std::vector<motion::NamedMotion> named;
    for (const view::ViewedMotion& shown : motions) named.push_back({shown.title, shown.motion});
    motion::write_glb(args.glb, named, {.unit_metres = unit_metres});
    fmt::print("wrote {}: {}; open it in any viewer of glTF\n", args.glb, counted(named.size(), "animation"));
  }
  return 0;
}

const Verb view_verb{
    "view", [](CLI::App& app, Job& job) {
      CLI::App* verb = app.add_subcommand("view", "Show clips side by side as stick figures");
      const auto args = std::make_shared<ViewArgs>();
      verb->add_option("FILES", args->files, clip_files_help)->required()->type_name("");
      verb->add_option("--html", args->html, "HTML page to write [view.html, unless --png or --glb is given]")
          ->type_name("FILE");
      verb->add_option("--glb", args->glb,
                       "glTF file to write: an animation for each clip, with a simple body")
          ->type_name("FILE");
      verb->add_option("--png", args->png, "picture to write: a row of poses for each clip")
          ->type_name("FILE");
      verb->add_option("--rate", args->rate, "frames per second to show [each clip's own]")
          ->type_name("HZ")
          ->check(CLI::Range(1e-3, 1e4));
      add_reading_options(*verb, args->clips, true);
      verb->callback([&job, args] { job = [args] { return view_clips(*args); }; });
    }};

}  // namespace

}  // namespace motiongan::command

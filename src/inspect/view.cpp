// motiongan view: shows clips as stick figures on an HTML page or in a picture.
#include "motiongan/data/clip_source.hpp"
#include "motiongan/formats/bvh.hpp"
#include "motiongan/motion/motion.hpp"
#include "shared/show.hpp"

namespace motiongan::command {
namespace {

struct ViewArgs {
  std::vector<std::string> files;
  std::string html, png;
  double rate = 0;
};

int view_clips(ViewArgs args) {
  std::vector<view::ViewedMotion> motions;
  for (const std::string& given : args.files) {
    const std::vector<fs::path> found = motion::find_clip_files(given);
    for (const fs::path& file : found) {
      motion::Motion motion = motion::to_motion(motion::read_bvh(file));
      if (args.rate > 0) motion = motion::resample(motion, args.rate);
      fmt::print("{}: {} at {} per second, {}\n", file.string(), counted(motion.frames, "frame"),
                 brief(motion.rate), duration(static_cast<double>(motion.frames) / motion.rate));
      motions.push_back({file.stem().string(), std::move(motion)});
    }
  }
  if (args.html.empty() && args.png.empty()) args.html = "view.html";
  if (!args.html.empty())
    show_page(args.html, motions,
              motions.size() == 1 ? motions.front().title : counted(motions.size(), "clip"));
  if (!args.png.empty()) show_strip(args.png, motions);
  return 0;
}

const Verb view_verb{
    "view", [](CLI::App& app, Job& job) {
      CLI::App* verb = app.add_subcommand("view", "Show BVH clips side by side as stick figures");
      const auto args = std::make_shared<ViewArgs>();
      verb->add_option("FILES", args->files, "BVH files, or folders of them")->required()->type_name("");
      verb->add_option("--html", args->html, "HTML page to write [view.html, unless --png is given]")
          ->type_name("FILE");
      verb->add_option("--png", args->png, "picture to write: a row of poses for each clip")
          ->type_name("FILE");
      verb->add_option("--rate", args->rate, "frames per second to show [each clip's own]")
          ->type_name("HZ")
          ->check(CLI::Range(1e-3, 1e4));
      verb->callback([&job, args] { job = [args] { return view_clips(*args); }; });
    }};

}  // namespace

}  // namespace motiongan::command

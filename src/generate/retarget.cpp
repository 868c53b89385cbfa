// motiongan retarget: puts clips on another skeleton.
#include "motiongan/motion/retarget.hpp"
#include "shared/cleaning.hpp"
#include "shared/clip_reading.hpp"
#include "shared/motion_files.hpp"
#include "shared/outputs.hpp"
#include "shared/retargeting.hpp"
#include "shared/show.hpp"

namespace motiongan::command {
namespace {

struct RetargetArgs {
  std::vector<std::string> files;
  std::string out, html, format = "bvh";
  Retargeting retargeting;
  Cleaning cleaning;
  motion::ClipOptions clips{.first_frame = motion::FirstFrame::keep};
};

int retarget_clips(const RetargetArgs& args) {
  const std::vector<fs::path> inputs =
      inputs_of(args.files, {args.retargeting.skeleton, args.retargeting.map, args.clips.bones.string()});
  const fs::path out = args.out;
  check_output_folder("--out", out, inputs);
  check_output("--html", args.html, page_output, inputs);
  check_output("--save-map", args.retargeting.save_map, table_output, inputs);
  TargetBody body(args.retargeting);
  std::vector<view::ViewedMotion> shown;
  std::vector<fs::path> files;
  std::vector<motion::Motion> made;
  for (const std::string& given : args.files)
    for_each_clip(given, args.clips,
                  [&](const fs::path&, const std::string& id, motion::LoadedMotion&& loaded) {
                    files.push_back(out / (id + "." + args.format));
                    made.push_back(args.cleaning.apply(body.put(loaded.motion)));
                    if (args.html.empty()) return;
                    shown.push_back({id, for_page(loaded.motion, 0)});
                    shown.push_back({id + ", retargeted", for_page(made.back(), 0)});
                  });
  check_outputs("--out", files, inputs);
  for (std::size_t i = 0; i < files.size(); ++i) {
    make_folder(files[i].parent_path());
    write_motion(files[i], made[i], 0, body.unit_metres(0), body.character());
  }
  fmt::print("wrote {} to {}\n", counted(files.size(), "clip"), out.string());
  if (!args.html.empty()) show_page(args.html, shown, "before and after retargeting", 2);
  return 0;
}

const Verb retarget_verb{
    "retarget", [](CLI::App& app, Job& job) {
      CLI::App* verb = app.add_subcommand(
          "retarget", "Put clips on another skeleton, whatever its joint names, proportions and rest pose");
      const auto args = std::make_shared<RetargetArgs>();
      verb->add_option("FILES", args->files, clip_files_help)->required()->type_name("");
      verb->add_option("--to", args->retargeting.skeleton,
                       "a motion file with the skeleton that the clips are put on")
          ->required()
          ->type_name("FILE");
      add_map_options(*verb, args->retargeting);
      verb->add_option("--out", args->out, "folder for the clips, as BVH; created if missing")
          ->required()
          ->type_name("DIR");
      verb->add_option("--html", args->html, "also write an HTML page: each clip before and after")
          ->type_name("FILE");
      add_format_option(*verb, args->format);
      add_clean_options(*verb, args->cleaning);
      add_reading_options(*verb, args->clips, true);
      verb->callback([&job, args] { job = [args] { return retarget_clips(*args); }; });
    }};

}  // namespace

}  // namespace motiongan::command

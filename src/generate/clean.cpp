// motiongan clean: cleans up clips that exist.
#include "motiongan/formats/bvh.hpp"
#include "motiongan/motion/untwist.hpp"
#include "shared/cleaning.hpp"
#include "shared/clip_reading.hpp"
#include "shared/outputs.hpp"
#include "shared/quality.hpp"
#include "shared/show.hpp"

namespace motiongan::command {
namespace {

struct CleanArgs {
  std::vector<std::string> files;
  std::string out, html;
  Cleaning cleaning;
  bool untwist = false;
  motion::ClipOptions clips{.first_frame = motion::FirstFrame::keep};
};

/// What `evaluate motion` measures, before and after.
void print_change(const std::vector<motion::Motion>& before, const std::vector<motion::Motion>& after,
                  const Cleaning& cleaning) {
  FootSkateOptions options;
  options.feet = cleaning.options.foot_joints, options.unit_metres = cleaning.options.unit_metres;
  const MotionQuality was = measure_quality(before, options);
  print_table({"", "before", "after"}, quality_rows(was, measure_quality(after, options)), "lrr");
  print_quality_notes(was, options);
}

int clean_clips(CleanArgs args) {
  if (!args.cleaning.on() && !args.untwist) args.cleaning.parts = {"feet", "smooth"};
  const std::vector<fs::path> inputs = inputs_of(args.files, {args.clips.bones.string()});
  const fs::path out = args.out;
  check_output_folder("--out", out, inputs);
  check_output("--html", args.html, page_output, inputs);
  std::vector<motion::Motion> before, after;
  std::vector<view::ViewedMotion> shown;
  std::vector<fs::path> files;
  for (const std::string& given : args.files)
    for_each_clip(
        given, args.clips, [&](const fs::path&, const std::string& id, motion::LoadedMotion&& loaded) {
          files.push_back(out / (id + ".bvh"));
          after.push_back(args.cleaning.apply(args.untwist ? untwisted(loaded.motion) : loaded.motion));
          before.push_back(std::move(loaded.motion));
          shown.push_back({id, for_page(before.back(), 0)});
          shown.push_back({id + ", cleaned", for_page(after.back(), 0)});
        });
  check_outputs("--out", files, inputs);
  for (std::size_t i = 0; i < files.size(); ++i) {
    make_folder(files[i].parent_path());
    motion::write_bvh(files[i], after[i]);
  }
  fmt::print("wrote {} to {}\n", counted(files.size(), "clip"), out.string());
  const auto long_enough = [](const motion::Motion& motion) { return motion.frames >= 4; };
  if (std::all_of(before.begin(), before.end(), long_enough)) print_change(before, after, args.cleaning);
  if (!args.html.empty()) show_page(args.html, shown, "before and after cleaning up", 2);
  return 0;
}

const Verb clean_verb{
    "clean", [](CLI::App& app, Job& job) {
      CLI::App* verb = app.add_subcommand(
          "clean",
          "Clean up clips: filter trembling, put floating bodies on the floor, hold standing feet still");
      const auto args = std::make_shared<CleanArgs>();
      verb->add_option("FILES", args->files, clip_files_help)->required()->type_name("");
      verb->add_option("--out", args->out, "folder for the cleaned clips, as BVH; created if missing")
          ->required()
          ->type_name("DIR");
      verb->add_option("--html", args->html, "also write an HTML page: each clip before and after")
          ->type_name("FILE");
      add_clean_options(*verb, args->cleaning, "both, without --untwist");
      verb->add_flag(
              "--untwist", args->untwist,
              "find all rotations anew from the places of the joints, as those of class models are, so "
              "that one ranker can judge both")
          ->group("Clean-up");
      add_reading_options(*verb, args->clips, true);
      verb->callback([&job, args] { job = [args] { return clean_clips(*args); }; });
    }};

}  // namespace

}  // namespace motiongan::command

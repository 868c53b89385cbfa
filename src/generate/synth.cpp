// motiongan synth: writes the built-in procedural motion as files.
#include "motiongan/formats/bvh.hpp"
#include "motiongan/formats/text_file.hpp"
#include "motiongan/procedural/procedural.hpp"
#include "shared/command.hpp"
#include "shared/outputs.hpp"

namespace motiongan::command {
namespace {

struct SynthArgs {
  std::string folder;
  motion::ProceduralOptions options;
};

int synthesise(const SynthArgs& args) {
  const fs::path folder = args.folder;
  require(args.options.clips > 0, "--clips is 0, expected at least 1");
  std::string captions = "# clip id <TAB> description; a clip may have several lines\n";
  check_own_list(folder / "captions.tsv", captions);
  make_folder(folder);
  std::size_t lines = 0;
  for (std::size_t i = 0; i < args.options.clips; ++i) {
    const motion::LabelledMotion clip = motion::procedural_motion(i, args.options);
    motion::write_bvh(folder / (clip.id + ".bvh"), clip.motion);
    for (const std::string& caption : clip.captions) captions += clip.id + "\t" + caption + "\n";
    lines += clip.captions.size();
  }
  motion::write_text_atomically(folder / "captions.tsv", captions);
  std::string actions;
  for (const std::string& name : motion::procedural_actions())
    actions += (actions.empty() ? "" : ", ") + name;
  fmt::print("wrote {} of {} each at {} frames per second, and captions.tsv with {}, to {}\n",
             counted(args.options.clips, "clip"), duration(args.options.seconds), brief(args.options.rate),
             counted(lines, "caption"), folder.string());
  fmt::print("actions, in turn: {}\n", actions);
  return 0;
}

const Verb synth_verb{
    "synth", [](CLI::App& app, Job& job) {
      CLI::App* verb =
          app.add_subcommand("synth", "Write the built-in procedural motion as BVH files with captions");
      const auto args = std::make_shared<SynthArgs>();
      verb->add_option("DIR", args->folder,
                       "folder to write to; created if missing, files of the same names are replaced")
          ->required()
          ->type_name("");
      verb->add_option("--clips", args->options.clips, "number of clips, cycling through the actions")
          ->check(not_negative())
          ->capture_default_str();
      verb->add_option("--seconds", args->options.seconds, "length of each clip")
          ->check(positive())
          ->capture_default_str();
      verb->add_option("--rate", args->options.rate, "frames per second")
          ->check(positive())
          ->capture_default_str();
      verb->add_option("--seed", args->options.seed, "random seed; another one gives other performers")
          ->check(not_negative())
          ->capture_default_str();
      verb->callback([&job, args] { job = [args] { return synthesise(*args); }; });
    }};

}  // namespace

}  // namespace motiongan::command

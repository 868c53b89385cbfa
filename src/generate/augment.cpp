// motiongan augment: generates a synthetic clip for each training clip, and tests whether they help.
#include "generate/augment.hpp"

#include <algorithm>
#include <map>

#include "generate/action_priors.hpp"
#include "motiongan/data/clip_source.hpp"
#include "shared/action_files.hpp"
#include "shared/outputs.hpp"
#include "shared/prompt.hpp"

namespace motiongan::command {
namespace {

struct AugmentArgs {
  std::string model, out, format = "bvh";
  std::uint64_t seed = 1;
  bool study = false;
  ActionDataArgs data;
  StudyArgs studied;
};

bool gives_split(const CLI::App& verb) {
  for (const char* name : {"--subjects", "--test-subjects", "--train-share", "--split-seed"})
    if (verb.count(name) > 0) return true;
  return false;
}

/// Moves clips into the part, training or test, that they had in the model's run; unknown clips stay. If the
/// command line asks for another split, only prints how many held-out clips the model was trained on.
void follow_split(motion::ActionDataset& data, const fs::path& split, bool other_split) {
  if (!fs::exists(split)) {
    fmt::print("there is no {}: the split may differ from the one that the model was trained with\n",
               split.string());
    return;
  }
  std::map<std::string, bool> trained;
  for (const SplitLine& line : read_split(split)) trained[line.id] = line.train;
  if (other_split) {
    const auto seen = std::count_if(data.test.begin(), data.test.end(), [&](const motion::ActionClip& clip) {
      return trained.contains(clip.id) && trained.at(clip.id);
    });
    if (seen > 0)
      fmt::print("note: the model was trained on {} of the {} held out\n", seen,
                 counted(data.test.size(), "clip"));
    return;
  }
  std::vector<motion::ActionClip> train, test;
  for (auto* part : {&data.train, &data.test})
    for (motion::ActionClip& clip : *part) {
      const auto found = trained.find(clip.id);
      const bool is_train = found != trained.end() ? found->second : part == &data.train;
      (is_train ? train : test).push_back(std::move(clip));
    }
  data.train = std::move(train);
  data.test = std::move(test);
  require(!data.train.empty(), "the model was trained on none of these clips (", split.string(), ")");
}

constexpr const char* labels_head = "# clip id\tlabel; synthetic clips\n";

/// The name of the synthetic clip for the clip `id`, without extension.
std::string synthetic_name(std::string id) {
  std::replace(id.begin(), id.end(), '/', '-');
  return id + "_synthetic";
}

/// The clips' folder would get their labels replaced, and synthetic clips among those it is read for.
void check_augment_outputs(const AugmentArgs& args, const motion::ActionDataset& data) {
  const std::vector<fs::path> inputs{args.data.folder, args.data.options.labels,
                                     args.data.options.clips.bones};
  if (args.study) check_output("--csv", args.studied.csv, table_output, inputs);
  if (args.out.empty()) return;
  const fs::path out = args.out;
  check_output_folder("--out", out, inputs);
  check_own_list(out / "labels.tsv", labels_head);
  std::vector<fs::path> files{out / "labels.tsv"};
  if (!has_rotations(args.format)) files.push_back(out / motion::bone_list_name);
  for (const motion::ActionClip& clip : data.train)
    files.push_back(out / (synthetic_name(clip.id) + "." + args.format));
  check_outputs("--out", files, inputs);
}

/// Writes the clips, and labels.tsv to train on them.
void write_clips(const AugmentArgs& args, const ActionGan& model, const std::vector<SyntheticClip>& clips) {
  const fs::path out = args.out;
  make_folder(out);
  std::vector<std::string> names;
  std::string labels = labels_head;
  for (const SyntheticClip& s : clips) {
    names.push_back(synthetic_name(s.clip.id));
    labels += names.back() + "\t" + model.format().classes[s.label] + "\n";
  }
  motion::in_two_threads(clips.size(), [&](std::size_t i) {
    const motion::PositionClip& clip = clips[i].clip;
    write_action_clip(out / (names[i] + "." + args.format), clip,
                      has_rotations(args.format) ? motion_from_positions(clip) : motion::Motion{}, 0);
  });
  if (!has_rotations(args.format)) write_bones_beside(out, model.format().skeleton());
  motion::write_text_atomically(out / "labels.tsv", labels);
  fmt::print("wrote {}: {} and labels.tsv; the first {} of each are the real clip's\n", out.string(),
             counted(clips.size(), "clip"), counted(model.format().frames, "frame"));
  fmt::print("space: {}\n", describe(model.format().space));
}

int augment(AugmentArgs args, const CLI::App& verb) {
  require(args.study || !args.out.empty(), "give --out DIR for the clips, or --study, or both");
  const fs::path file = model_file(args.model);
  const Context context;
  const ActionGan model = ActionGan::load(context, file);
  const motion::PositionFormat& format = model.format();
  const fs::path run = fs::is_directory(args.model) ? fs::path(args.model) : file.parent_path();
  take_data_of_run(args.data, verb, run, "give the folder of clips and their labels");
  fill_in_choices(args.data);
  check_augment_outputs(args, {});
  motion::ActionDatasetOptions& options = args.data.options;
  options.frames = format.frames;
  options.rate = format.rate;
  options.root_track = format.layout.root_track();
  if (options.classes.empty()) options.classes = format.classes;
  motion::ActionDataset data = load_data(args.data);
  follow_split(data, RunFiles{run}.split(), gives_split(verb));
  print_data(data, args.data);
  check_augment_outputs(args, data);
  const std::vector<SyntheticClip> clips = synthesise(model, data, data.train, args.seed);
  if (!args.out.empty()) write_clips(args, model, clips);
  return args.study ? run_study(args.studied, model, data, clips) : 0;
}

const Verb augment_verb{
    "augment", [](CLI::App& app, Job& job) {
      CLI::App* verb =
          app.add_subcommand("augment",
                             "Generate one synthetic clip for each training clip, with the same "
                             "first second, class and length, by a\n"
                             "model of `motiongan train attention`. Clips and labels are those of "
                             "its run unless others are given.\n"
                             "--study trains classifiers with and without the synthetic clips, and "
                             "tests them on the held-out clips.");
      const auto args = std::make_shared<AugmentArgs>();
      verb->add_option("MODEL", args->model, model_help)->required()->type_name("");
      add_action_data_options(*verb, args->data, false);
      verb->add_option("--out", args->out, "folder for the clips and labels.tsv; created if missing")
          ->type_name("DIR");
      add_clip_format_option(*verb, args->format);
      verb->add_option("--seed", args->seed, "seed of the noise, if the model has any")
          ->check(not_negative())
          ->capture_default_str();
      verb->add_flag("--study", args->study, "train and compare classifiers");
      add_study_options(*verb, args->studied);
      verb->callback([&job, args, verb] {
        fill_in_procedural(*verb, args->data.procedural);
        job = [args, verb] { return augment(*args, *verb); };
      });
    }};

}  // namespace

}  // namespace motiongan::command

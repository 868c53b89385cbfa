// motiongan demo: shows what the shipped models make; trains a small model on the built-in motion for a few
// minutes and shows what it learnt.
#include <algorithm>
#include <fstream>

#include "inspect/plot_log.hpp"
#include "motiongan/formats/bvh.hpp"
#include "motiongan/metrics/statistics.hpp"
#include "motiongan/motion/motion.hpp"
#include "motiongan/procedural/procedural.hpp"
#include "motiongan/train/progress.hpp"
#include "shared/shell.hpp"
#include "shared/show.hpp"
#include "shared/signals.hpp"
#include "shipped_motions.hpp"
#include "train/training.hpp"

namespace motiongan::command {
namespace {

struct DemoArgs {
  double minutes = 2;
  std::string out = "demo-out";
};

constexpr const char* marker = "made by `motiongan demo`";

/// Makes `out` an empty folder. Throws Error if it has files that no earlier demo wrote.
void renew(const fs::path& out) {
  const fs::path note = out / "README.txt";
  if (fs::exists(out) && !(fs::is_directory(out) && fs::is_empty(out))) {
    std::string first;
    std::ifstream in(note);
    std::getline(in, first);
    require(first.starts_with(marker), out.string(),
            " already exists and was not made by the demo; choose another --out");
    if (fs::is_directory(out / "save")) const io::FolderLock no_demo_is_running(out / "save");
    for (const auto& entry : fs::directory_iterator(out))
      if (entry.path() != note) fs::remove_all(entry.path());
  }
  make_folder(out);
  motion::write_text_atomically(note, concat(marker, R"(, which empties this folder when it runs again

shipped.html   motion of the models that come with motiongan; open it in a browser
shipped.png    the same as rows of poses
shipped/       the same as BVH files
motions.html   real and generated motion side by side, of a model trained here
poses.png      the same as rows of poses
training.png   the Wasserstein estimate and the gradient penalty during training
bvh/           the motions as BVH files
save/          the run: model, checkpoint, log.csv
)"));
}

DvganArgs demo_options() {
  DvganArgs args;
  args.procedural = 68;
  args.data.frames = 32;
  args.data.rate = 8;
  args.data.root_rotation = motion::RootRotation::support;
  args.training.critic.sees = CriticSees::both;
  args.model.hidden = 64;
  args.training.batch = 32;
  args.training.critic_steps = 5;
  args.training.adam.learning_rate = 5e-4;
  fill_in_choices(args);
  return args;
}

RunResult train_for(double minutes, Dvgan& model, const motion::Dataset& data, DvganArgs& args,
                    const fs::path& save) {
  ProgressBar bar;
  bar.start(0);
  RunOptions run;
  run.save_dir = save;
  run.save_every_minutes = 0;
  run.max_minutes = minutes;
  run.notes = {{"options", note_of(fields_of(args))}};
  run.interrupted = [] { return stop_requested(); };
  const auto start = std::chrono::steady_clock::now();
  run.report = [&](std::size_t iteration, std::span<const NamedLoss> losses) {
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
    const double left = std::max(0.0, std::round(60 * minutes - passed.count()));
    bar.update(iteration, {{"wasserstein", loss_of(losses, "wasserstein")},
                           {"penalty", loss_of(losses, "penalty")},
                           {"seconds left", left}});
  };
  catch_signals();
  const RunResult result = train(model, data, args.training, run);
  bar.finish();
  return result;
}

motion::Motion first_window(const motion::Dataset& data, const motion::DatasetClip& clip,
                            std::size_t start = 0) {
  std::vector<float> poses(data.format.frames * data.format.dof());
  data.window(clip, start, poses);
  return data.to_motion(poses);
}

/// One clip each of a few actions that look different from one another.
std::vector<const motion::DatasetClip*> clips_to_show(const motion::Dataset& data) {
  std::vector<const motion::DatasetClip*> out;
  for (const std::string action : {"walk_", "run_", "jump_", "squat_", "kick_", "wave_"})
    for (const motion::DatasetClip& clip : data.train)
      if (clip.id.starts_with(action)) {
        out.push_back(&clip);
        break;
      }
  return out;
}

/// Writes BVH files, a page and a picture: for each caption the real clip and two generated motions.
void write_motions(const Dvgan& model, const motion::Dataset& data, const fs::path& out) {
  constexpr double rate = 30;
  make_folder(out / "bvh");
  std::vector<view::ViewedMotion> page, strip;
  for (const motion::DatasetClip* clip : clips_to_show(data)) {
    const std::string& caption = clip->captions.front();
    const std::string name = clip->id.substr(0, clip->id.find('_'));
    const auto add = [&](const std::string& kind, const motion::Motion& motion, bool in_strip) {
      const motion::Motion smooth = motion::resample(motion, rate);
      motion::write_bvh(out / "bvh" / fmt::format("{}_{}.bvh", name, kind), smooth);
      page.push_back({kind.substr(0, kind.find('_')) + ": " + caption, smooth});
      if (in_strip) strip.push_back(page.back());
    };
    add("real", first_window(data, *clip), true);
    const std::vector<motion::Motion> made = model.generate(caption, {.count = 2, .seed = 1});
    for (std::size_t i = 0; i < made.size(); ++i) add(fmt::format("generated_{}", i + 1), made[i], i == 0);
  }
  fmt::print("wrote {}: {} BVH files\n", (out / "bvh").string(), page.size());
  show_page(out / "motions.html", page, "motiongan demo: real and generated motion");
  show_strip(out / "poses.png", strip);
}

motion::StatisticsComparison compare_with_real(const Dvgan& model, const motion::Dataset& data) {
  std::vector<motion::Motion> real, made;
  for (const auto* part : {&data.train, &data.test})
    for (const motion::DatasetClip& clip : *part)
      for (std::size_t start = 0; start < data.starts(clip); start += data.stride * data.format.frames / 2)
        real.push_back(first_window(data, clip, start));
  for (const motion::DatasetClip& clip : data.train)
    for (motion::Motion& motion : model.generate(clip.captions.front(), {.count = 2, .seed = 2}))
      made.push_back(std::move(motion));
  return motion::compare(motion::measure(made), motion::measure(real));
}

/// Prints an assessment of the training in plain language.
void judge(const CsvTable& log, const motion::StatisticsComparison& c) {
  const std::vector<double> wasserstein = log.column("wasserstein"), iteration = log.column("iteration");
  const CurveSummary w = summarise(wasserstein);
  fmt::print("\nassessment\n");
  fmt::print("  The Wasserstein estimate rose to {} by iteration {:.0f}, and ended at {}", brief(w.peak, 3),
             iteration[w.peak_at], brief(w.last, 3));
  const bool fell = w.last < 0.9 * w.peak;
  fmt::print("{}\n", fell ? ", as it should: up quickly, then down slowly." : ": it has not fallen yet.");
  fmt::print("  Spread of the joint angles, generated / real: {} (ideally 1).\n",
             brief(c.median_spread_ratio, 3));
  fmt::print("  Speed of the joints, generated / real: {}.\n", brief(c.mean_speed_ratio, 3));
  fmt::print("  {}% of the generated angles lie outside the range of the real clips.\n",
             brief(100 * c.values_outside, 3));
  std::vector<std::string> doubts;
  if (!fell) doubts.emplace_back("the estimate has not fallen");
  if (!(c.median_spread_ratio > 0.5)) doubts.emplace_back("the motion varies too little");
  if (!(c.median_spread_ratio < 1.6)) doubts.emplace_back("the motion varies too much");
  if (!(c.mean_speed_ratio > 0.5)) doubts.emplace_back("it moves too slowly");
  if (!(c.mean_speed_ratio < 1.8)) doubts.emplace_back("it moves too fast, which looks like jitter");
  if (!(c.values_outside < 0.1)) doubts.emplace_back("many poses are unlike real ones");
  if (doubts.empty()) {
    fmt::print("  That looks healthy for such a short training run. Longer training improves the motion.\n");
  } else {
    std::string list;
    for (const std::string& doubt : doubts) list += (list.empty() ? "" : "; ") + doubt;
    fmt::print("  Not there yet: {}. Longer training should help (--minutes 10).\n", list);
  }
}

int run_demo(const DemoArgs& demo) {
  const fs::path out = demo.out;
  const Context context;  // first, so that nothing is touched without a device
  renew(out);
  fmt::print("1. motion of the models that come with motiongan\n");
  show_shipped_motions(context, out);
  fmt::print("\n2. data, to train a model on: built-in motion\n");
  DvganArgs args = demo_options();
  const motion::Dataset data = load_data(args);
  print_data(data, args);
  fmt::print("\n3. training for {} (Ctrl-C stops early and continues with step 4)\n",
             duration(60 * demo.minutes));
  Dvgan model(context, data.format, args.model);
  print_model(model);
  const RunResult result = train_for(demo.minutes, model, data, args, out / "save");

  fmt::print("\n4. new motion after {}\n", counted(result.iterations, "iteration"));
  write_motions(model, data, out);
  const CsvTable log = read_csv_log(RunFiles{out / "save"}.log());
  write_png(out / "training.png", plot_log(log, "motiongan demo"));
  fmt::print("wrote {}: the training curves\n", (out / "training.png").string());
  judge(log, compare_with_real(model, data));

  const std::string save = shell_word((out / "save").string());
  fmt::print("\nto open in a browser\n");
  for (const char* page : {"shipped.html", "motions.html"})
    if (fs::exists(out / page)) fmt::print("  {}\n", fs::absolute(out / page).lexically_normal().string());
  fmt::print("\nmore from this model\n");
  fmt::print("  {} generate {} --text {} --count 4 --rate 30 --html more.html\n", program(), save,
             shell_quoted(clips_to_show(data).front()->captions.front()));
  fmt::print("  {} train dvgan --resume --save {}\n", program(), save);
  fmt::print("the same with your own clips (captions.tsv: a line `clip id <TAB> description` for each)\n");
  fmt::print("  {} train dvgan my-clips --captions captions.tsv --save save/mine\n", program());
  fmt::print("  {} generate save/mine --text \"walk\" --count 4 --rate 30 --html mine.html\n", program());
  return 0;
}

const Verb demo_verb{
    "demo", [](CLI::App& app, Job& job) {
      CLI::App* verb = app.add_subcommand(
          "demo",
          "Show what the shipped models make, train a small model on built-in motion, and show the result:\n"
          "BVH files, HTML pages, pictures");
      const auto args = std::make_shared<DemoArgs>();
      verb->add_option("--minutes", args->minutes, "training time in minutes")
          ->capture_default_str()
          ->check(CLI::Range(0.001, 1e5));
      verb->add_option("--out", args->out, "folder to write to; emptied first if an earlier demo made it")
          ->capture_default_str()
          ->type_name("DIR");
      verb->callback([&job, args] { job = [args] { return run_demo(*args); }; });
    }};

}  // namespace

}  // namespace motiongan::command

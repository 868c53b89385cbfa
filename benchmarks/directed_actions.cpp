// Directed motion of class-conditioned models: how well paths, poses and loops are met, how long that takes,
// and what it costs in quality.
//   bench_directed_actions [--rounds 20] RUN CLIPS LABELS [CLASS]
// RUN is the folder of a `train attention` run on CLIPS. Motions continue held-out clips of the class (the
// first one without CLASS). Paths are random ones of 8 seconds; poses are those of held-out clips of the
// class, after 2 seconds; loops last 4 seconds. Lengths are in leg lengths. The run's classifier says how
// many of the seconds that were made still are of the class.
#include <motiongan/data/action_dataset.hpp>
#include <motiongan/direct/action_direct.hpp>
#include <motiongan/direct/pace.hpp>
#include <motiongan/train/run.hpp>
#include <motiongan/train/saved_critic.hpp>
#include <numeric>

#include "directed_help.hpp"

using namespace motiongan;

namespace {

class Study {
 public:
  Study(ActionGan& model, const io::SafeTensors& checkpoint, const motion::ActionDataset& data,
        const std::string& label, std::size_t rounds, DirectOptions options)
      : model_(model),
        format_(model.format()),
        label_(format_.class_index(label)),
        leg_(motion::body_unit(format_.skeleton())),
        options_(std::move(options)),
        classifier_(Initializer(model.context(), 1), {.dof = format_.dof(),
                                                      .classes = format_.classes.size(),
                                                      .hidden = model.options().hidden,
                                                      .attention = model.options().attention}) {
    io::load_parameters(named_parameters(classifier_), checkpoint, "RUN", "classifier.");
    std::vector<const motion::ActionClip*> clips;
    for (const motion::ActionClip& clip : data.test)
      if (clip.label == label_ && clip.frames >= 2 * format_.frames) clips.push_back(&clip);
    require(!clips.empty(), "no held-out clip of class ", label, " lasts two seconds");
    for (std::size_t i = 0; i < rounds; ++i) {
      const motion::ActionClip& clip = *clips[i % clips.size()];
      const std::size_t first = (i / clips.size()) * 7 % (clip.frames - format_.frames);
      priors_.push_back(data.prior(clip, first));
      others_.push_back(data.prior(*clips[(i + 1) % clips.size()], 0));
    }
  }

  void paths() {
    const double way = 8 * pace_of(model_, priors_, label_);
    const ActionSchedule schedule{{label_, static_cast<std::size_t>(8 * format_.rate)}};
    std::vector<ActionDirectTask> tasks;
    for (std::size_t i = 0; i < priors_.size(); ++i) {
      const std::vector<PathPoint> points = random_path(i, way);
      tasks.push_back({.prior = priors_[i],
                       .constraints = {PathConstraint{.points = points}},
                       .start = TimedPath(points, 8).start()});
    }
    std::printf("paths of %.1f legs, 8 s\n", way / leg_);
    report("paths", tasks, schedule);
    const std::vector<motion::PositionClip> free = model_.generate(priors_, schedule);
    print_quality("  free", motions_of(free));
    std::printf("  free: %.1f %% of the seconds of the class\n", 100 * of_class(free));
  }

  void poses() {
    std::vector<ActionDirectTask> tasks;
    for (std::size_t i = 0; i < priors_.size(); ++i) {
      const ActionPrior& other = others_[i];
      const motion::Motion pose = motion::motion_from_positions(
          {other.id, other.skeleton, format_.rate, format_.frames, other.positions});
      tasks.push_back(
          {.prior = priors_[i],
           .constraints = {PoseConstraint{.time = 2, .pose = slice(pose, format_.frames / 2, 1)}}});
    }
    report("poses", tasks, {{label_, static_cast<std::size_t>(3 * format_.rate)}});
  }

  void loops() {
    std::vector<ActionDirectTask> tasks;
    for (const ActionPrior& prior : priors_)
      tasks.push_back({.prior = prior, .constraints = {LoopConstraint{}}});
    report("loops", tasks, {{label_, static_cast<std::size_t>(4 * format_.rate)}});
  }

 private:
  void report(const char* name, const std::vector<ActionDirectTask>& tasks, const ActionSchedule& schedule) {
    direct(model_, {tasks.front()}, schedule, options_);  // compiles kernels
    double begin = now();
    direct(model_, {tasks.front()}, schedule, options_);
    const double one = now() - begin;
    begin = now();
    const std::vector<DirectedAction> made = direct(model_, tasks, schedule, options_);
    const double all = now() - begin;
    double mean = 0, worst = 0, met = 0;
    std::vector<motion::PositionClip> clips;
    for (const DirectedAction& m : made) {
      mean += m.errors.front().mean / leg_ / static_cast<double>(made.size());
      worst = std::max(worst, m.errors.front().worst / leg_);
      met += m.met() ? 1 : 0;
      clips.push_back(m.clip);
    }
    std::printf(
        "%s: met %.0f of %zu; error mean %.4f, worst %.4f legs; %zu iterations; %.2f s alone, %.2f s a "
        "motion together\n",
        name, met, made.size(), mean, worst, made.front().iterations, one,
        all / static_cast<double>(made.size()));
    print_quality("  directed", motions_of(clips));
    std::printf("  directed: %.1f %% of the seconds of the class\n", 100 * of_class(clips));
  }

  /// Without the given second.
  std::vector<motion::Motion> motions_of(const std::vector<motion::PositionClip>& clips) const {
    std::vector<motion::Motion> out;
    for (const motion::PositionClip& clip : clips) {
      const motion::Motion all = motion::motion_from_positions(clip);
      out.push_back(slice(all, format_.frames, all.frames - format_.frames));
    }
    return out;
  }

  /// The share of the seconds that were made that the classifier takes for the class.
  double of_class(const std::vector<motion::PositionClip>& clips) const {
    const NoGrad values_only;
    std::vector<std::vector<float>> seconds;
    const std::size_t values = format_.frames * format_.dof();
    for (const motion::PositionClip& clip : clips) {
      const std::vector<float> poses = format_.encode(clip.positions);
      for (std::size_t at = values; at + values <= poses.size(); at += values)
        seconds.emplace_back(poses.begin() + static_cast<std::ptrdiff_t>(at),
                             poses.begin() + static_cast<std::ptrdiff_t>(at + values));
    }
    const Var all = detail::batch_of(model_.context(), seconds, format_.dof());
    return accuracy_of(classifier_(all).value(), std::vector<std::size_t>(seconds.size(), label_));
  }

  ActionGan& model_;
  const motion::PositionFormat& format_;
  std::size_t label_;
  double leg_;
  DirectOptions options_;
  AttentionClassifier classifier_;
  std::vector<ActionPrior> priors_, others_;
};

}  // namespace

int main(int count, char** arguments) {
  const auto [rounds, given] = given_arguments(count, arguments, 1);
  if (given.size() < 3) {
    std::fprintf(stderr, "usage: bench_directed_actions [--rounds 20] RUN CLIPS LABELS [CLASS]\n");
    return 1;
  }
  try {
    const Context context;
    ActionGan model = ActionGan::load(context, model_file(given[0]));
    const std::filesystem::path checkpoint = RunFiles{given[0]}.checkpoint();
    const SavedActionCritic critic(model, checkpoint);
    const motion::PositionFormat& format = model.format();
    const motion::ActionDataset data = motion::ActionDataset::from_folder(
        given[1], {.frames = format.frames, .rate = format.rate, .labels = given[2]});
    require(data.format.dof() == format.dof() && data.format.classes == format.classes,
            "RUN was trained on other clips than CLIPS");
    DirectOptions options;
    options.score_pairs = [&](const Var& pairs, const Var& classes) { return critic(pairs, classes); };
    std::printf("device: %s; noise of %zu\n", context.device().name.c_str(), model.options().noise_dim);
    Study study(model, io::SafeTensors::read(checkpoint), data,
                given.size() > 3 ? given[3] : format.classes.front(), rounds, options);
    study.paths();
    study.poses();
    study.loops();
  } catch (const Error& error) {
    std::fprintf(stderr, "bench_directed_actions: %s\n", error.what());
    return 1;
  }
  return 0;
}

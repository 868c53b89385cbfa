// Directed motion: how well paths, gaps and loops are met, how long that takes, and what it costs in quality.
//   bench_directed [--rounds 20] RUN CLIPS CAPTIONS [RANKER]
// RUN is the folder of a `train dvgan` run on CLIPS, RANKER a ranker file. Paths are 20 random ones of 8
// seconds, gaps are cut from windows of held-out clips (6 frames on either side), loops last a window.
// Lengths are in leg lengths. The peer of a gap is slerp between its ends. With a ranker, motions of the test
// descriptions are directed (to a pose of another motion of their description; along the way of another, bent
// by 45 degrees) and measured as `evaluate model` does, beside undirected ones.
#include <cmath>
#include <cstdio>
#include <motiongan/data/dataset.hpp>
#include <motiongan/direct/between.hpp>
#include <motiongan/direct/pace.hpp>
#include <motiongan/experiments/model_evaluation.hpp>
#include <motiongan/metrics/npss.hpp>
#include <motiongan/train/run.hpp>
#include <motiongan/train/saved_critic.hpp>
#include <numeric>

#include "directed_help.hpp"

using namespace motiongan;
using motion::Motion;

namespace {

class Study {
 public:
  Study(Dvgan& model, const SavedCritic& critic, std::size_t rounds)
      : model_(model),
        rounds_(rounds),
        root_(model.format().layout.root()),
        leg_(motion::body_unit(model.format().skeleton())) {
    options_.score = [&critic](const Var& motion, const Sentences& text) { return critic(motion, text); };
  }

  void paths() {
    const double way = 8 * pace_of(model_, "walk");
    DirectOptions options = options_;
    options.frames = frames_for_way(model_, "walk", way);
    std::vector<DirectTask> tasks;
    for (std::size_t i = 0; i < rounds_; ++i) {
      DirectTask task{.text = "walk", .constraints = {PathConstraint{.points = random_path(i, way)}}};
      const auto& points = std::get<PathConstraint>(task.constraints.front()).points;
      task.start = TimedPath(points, static_cast<double>(options.frames - 1) / model_.format().rate).start();
      tasks.push_back(std::move(task));
    }
    const std::vector<DirectedMotion> made = timed("paths", tasks, options);
    double mean = 0, worst = 0, met = 0;
    std::vector<Motion> motions;
    for (const DirectedMotion& m : made) {
      mean += m.errors.front().mean / leg_ / static_cast<double>(made.size());
      worst = std::max(worst, m.errors.front().worst / leg_);
      met += m.met() ? 1 : 0;
      motions.push_back(m.motion);
    }
    std::printf("paths: %zu of %.1f legs, %zu frames; met %.0f; distance mean %.4f, worst %.4f legs\n",
                made.size(), way / leg_, options.frames, met, mean, worst);
    print_quality("  directed", motions);
    print_quality("  free", model_.generate("walk", {.count = rounds_, .first_sample = 5000}));
  }

  void gaps(const motion::Dataset& data) {
    constexpr std::size_t side = 6;
    const std::size_t frames = model_.format().frames, between = frames - 2 * side;
    std::vector<Gap> gaps;
    std::vector<Motion> truths;
    for (std::size_t i = 0; i < rounds_; ++i) {
      const motion::DatasetClip& clip = data.test[i % data.test.size()];
      std::vector<float> window(frames * model_.format().dof());
      const std::size_t starts = data.starts(clip);
      data.window(clip, starts / 2, window);
      truths.push_back(model_.format().to_motion(window));
      const Motion& truth = truths.back();
      gaps.push_back({.text = clip.captions.front(),
                      .before = slice(truth, 0, side),
                      .after = slice(truth, side + between, side),
                      .seconds = static_cast<double>(between + 1) / truth.rate});
    }
    const double begin = now();
    fill_gaps(model_, {gaps.front()}, options_);
    const double one = now() - begin;
    fill_gaps(model_, std::vector<Gap>(gaps.begin(), gaps.begin() + 16), options_);
    const double sixteen = now() - begin - one;
    const std::vector<InBetween> made = fill_gaps(model_, gaps, options_);
    double error = 0, met = 0, ours = 0, slerp = 0, iterations = 0;
    Npss npss_ours, npss_slerp;
    std::vector<Motion> motions;
    for (std::size_t i = 0; i < made.size(); ++i) {
      const Motion truth = slice(truths[i], side, between), mine = slice(made[i].motion, side, between),
                   straight = straight_way(slice(truths[i], side - 1, 1), slice(truths[i], side + between, 1),
                                           between);
      error += made[i].error.mean / leg_, met += made[i].error.met() ? 1 : 0;
      iterations += static_cast<double>(made[i].iterations);
      ours += apart(mine, truth), slerp += apart(straight, truth);
      const auto angles = [&](const Motion& m) { return motion_angles(m); };
      const std::vector<double> t = angles(truth), a = angles(mine), b = angles(straight);
      npss_ours.add(t, a, between), npss_slerp.add(t, b, between);
      motions.push_back(made[i].motion);
    }
    const double n = static_cast<double>(made.size());
    std::printf(
        "gaps: %zu of %zu frames (%.2f s); met %.0f before the correction, error there %.4f legs; %.0f "
        "iterations; %.0f ms alone, %.0f ms a motion of 16\n",
        made.size(), between, static_cast<double>(between + 1) / model_.format().rate, met, error / n,
        iterations / n, 1e3 * one, 1e3 * sixteen / 16);
    std::printf("  joints to the truth: ours %.4f, slerp %.4f legs; NPSS ours %.4f, slerp %.4f\n", ours / n,
                slerp / n, npss_ours.value(), npss_slerp.value());
    print_quality("  ours", motions);
    print_quality("  truth", truths);
  }

  void loops() {
    std::vector<DirectTask> tasks(rounds_, {.text = "walk", .constraints = {LoopConstraint{}}});
    const std::vector<DirectedMotion> made = timed("loops", tasks, options_);
    double seam = 0, ordinary = 0, met = 0;
    std::vector<Motion> motions;
    for (const DirectedMotion& m : made) {
      const std::size_t last = m.motion.frames - 1;
      seam += body_step(world_pose(m.motion, last, root_), world_pose(m.motion, 0, root_)) / leg_;
      for (std::size_t f = 0; f < last; ++f)
        ordinary += body_step(world_pose(m.motion, f, root_), world_pose(m.motion, f + 1, root_)) / leg_ /
                    static_cast<double>(last);
      met += m.met() ? 1 : 0;
      motions.push_back(m.motion);
    }
    const double n = static_cast<double>(made.size());
    std::printf("loops: %zu; met %.0f; seam %.4f legs, an ordinary step %.4f\n", made.size(), met, seam / n,
                ordinary / n);
    print_quality("  directed", motions);
  }

  void loss(const motion::Dataset& data, const Ranker& ranker) {
    ModelEvaluationOptions options;
    const RealEvaluation real = evaluate_real(ranker, data, options);
    const auto row = [&](const char* name) {
      const ModelEvaluation made = evaluate_model(model_, ranker, real, options);
      std::printf("  %-22s R@1 %.1f %%, inception score %.2f, FID %.3f, jerk %.0f, skate %.1f %%\n", name,
                  made.measures.retrieval.recall[0], made.measures.inception_score, made.distance.distance,
                  made.measures.quality.jerk, 100 * made.measures.quality.feet->ratio());
    };
    row("undirected");
    options.make = [&](const std::string& text, const GenerateOptions& wanted) {
      return directed(text, wanted, [&](const Motion& other) {
        const std::size_t f = other.frames / 2;
        return PoseConstraint{.time = static_cast<double>(f) / other.rate, .pose = slice(other, f, 1)};
      });
    };
    row("to a pose");
    options.make = [&](const std::string& text, const GenerateOptions& wanted) {
      return directed(text, wanted, [&](const Motion& other) { return bent_way(other); });
    };
    row("along a bent way");
    std::printf("  %-22s R@1 %.1f %%, inception score %.2f\n", "real", real.measures.retrieval.recall[0],
                real.measures.inception_score);
  }

 private:
  /// Runs them alone, 16 at a time, and all.
  std::vector<DirectedMotion> timed(const char* name, const std::vector<DirectTask>& tasks,
                                    const DirectOptions& options) {
    direct(model_, {tasks.front()}, options);  // compiles kernels
    const double begin = now();
    const std::size_t alone = direct(model_, {tasks.front()}, options).front().iterations;
    const double one = now() - begin;
    const std::vector<DirectTask> some(tasks.begin(), tasks.begin() + 16);
    const std::size_t together = direct(model_, some, options).front().iterations;
    const double sixteen = now() - begin - one;
    std::printf("%s: %.0f ms and %zu iterations alone; %.0f ms a motion and %zu iterations, 16 together\n",
                name, 1e3 * one, alone, 1e3 * sixteen / 16, together);
    return direct(model_, tasks, options);
  }

  /// The mean distance of the joints, in legs.
  double apart(const Motion& a, const Motion& b) const {
    const std::vector<motion::Vec3> p = motion::joint_positions(a), q = motion::joint_positions(b);
    double sum = 0;
    for (std::size_t i = 0; i < p.size(); ++i) sum += motion::length(motion::subtract(p[i], q[i]));
    return sum / static_cast<double>(p.size()) / leg_;
  }

  std::vector<double> motion_angles(const Motion& m) const { return prediction_angles(m, root_); }

  template <class ConstraintOf>
  std::vector<Motion> directed(const std::string& text, const GenerateOptions& wanted,
                               const ConstraintOf& constraint_of) {
    const std::vector<Motion> free = model_.generate(text, wanted);
    std::vector<DirectTask> tasks;
    for (std::size_t i = 0; i < free.size(); ++i) {
      const Motion other = motion::placed_at(free[(i + 1) % free.size()], root_, {}, true);
      tasks.push_back({.text = text, .constraints = {constraint_of(other)}});
    }
    DirectOptions options = options_;
    options.first_sample = wanted.first_sample, options.seed = wanted.seed, options.starts = 4;
    std::vector<Motion> out;
    for (DirectedMotion& m : direct(model_, tasks, options)) out.push_back(std::move(m.motion));
    return out;
  }

  /// The way of a motion's root, turned more and more, by 45 degrees in all; a motion that stays gives a
  /// pose.
  Constraint bent_way(const Motion& other) const {
    std::vector<PathPoint> points{{0, 0, 0.0}};
    double way = 0;
    for (std::size_t f = 1; f < other.frames; ++f) {
      const double share = static_cast<double>(f) / static_cast<double>(other.frames - 1);
      double x = other.position(f, root_)[0] - other.position(f - 1, root_)[0],
             z = other.position(f, root_)[2] - other.position(f - 1, root_)[2];
      way += std::hypot(x, z);
      motion::turn_ground(x, z, share * motion::pi / 4);
      points.push_back({points.back().x + x, points.back().z + z, static_cast<double>(f) / other.rate});
    }
    if (way < 0.5 * leg_) return PoseConstraint{.time = 1, .pose = slice(other, other.frames / 2, 1)};
    return PathConstraint{.points = points};
  }

  Dvgan& model_;
  std::size_t rounds_, root_;
  double leg_;
  DirectOptions options_;
};

}  // namespace

int main(int count, char** arguments) {
  const auto [rounds, given] = given_arguments(count, arguments, 16);
  if (given.size() < 3) {
    std::fprintf(stderr, "usage: bench_directed [--rounds 20] RUN CLIPS CAPTIONS [RANKER]\n");
    return 1;
  }
  try {
    const Context context;
    Dvgan model = Dvgan::load(context, model_file(given[0]));
    const SavedCritic critic(model, RunFiles{given[0]}.checkpoint());
    const motion::MotionFormat& format = model.format();
    const motion::Dataset data =
        motion::Dataset::from_bvh(given[1], {.frames = format.frames,
                                             .rate = format.rate,
                                             .captions = given[2],
                                             .root_rotation = format.layout.root_rotation()});
    require(data.format.dof() == format.dof(), "RUN was trained on other clips than CLIPS");
    std::printf("device: %s\n", context.device().name.c_str());
    Study study(model, critic, rounds);
    study.paths();
    study.gaps(data);
    study.loops();
    if (given.size() > 3) study.loss(data, Ranker::load(context, given[3]));
  } catch (const Error& error) {
    std::fprintf(stderr, "bench_directed: %s\n", error.what());
    return 1;
  }
  return 0;
}

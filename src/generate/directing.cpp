// The options that direct a motion, and what they say.
#include "generate/directing.hpp"

#include <algorithm>
#include <cmath>

#include "motiongan/direct/pace.hpp"
#include "motiongan/direct/path_file.hpp"
#include "motiongan/motion/body_parts.hpp"
#include "motiongan/train/saved_critic.hpp"
#include "shared/clip_reading.hpp"
#include "shared/numbers.hpp"
#include "shared/options.hpp"
#include "shared/signals.hpp"

namespace motiongan::command {
namespace {

constexpr const char* group = "Directing";

/// "1.2", or "1.2-2": seconds.
std::pair<double, double> read_times(std::string_view text, const std::string& whole) {
  const std::size_t dash = text.find('-');
  const std::optional<double> from = finite_number(text.substr(0, dash)),
                              to = dash == text.npos ? from : finite_number(text.substr(dash + 1));
  require(from && to && *from >= 0 && *to >= *from, whole, ": found '", text,
          "' as its time, expected seconds, such as 1.2, or from and to, such as 1.2-2");
  return {*from, *to};
}

/// NAME@TIME[:REST].
struct Spec {
  std::string name, rest;
  double from = 0, to = 0;
};
Spec read_spec(const std::string& option, const std::string& text, bool with_rest, const char* example) {
  const std::string whole = option + " " + text;
  const std::size_t at = text.find('@'), colon = with_rest ? text.find(':', at) : text.npos;
  require(at != text.npos && at > 0 && (colon != text.npos) == with_rest, whole, ": expected ", example);
  Spec out{text.substr(0, at), with_rest ? text.substr(colon + 1) : std::string(), 0, 0};
  std::tie(out.from, out.to) =
      read_times(std::string_view(text).substr(at + 1, with_rest ? colon - at - 1 : text.npos), whole);
  return out;
}

motion::Vec3 read_point(const std::string& text, const std::string& whole) {
  motion::Vec3 out{};
  std::string_view left = text;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t end = k < 2 ? left.find(',') : left.size();
    const std::optional<double> value =
        end == left.npos ? std::nullopt : finite_number(motion::trimmed(left.substr(0, end)));
    require(value.has_value(), whole, ": found '", text, "' as its point, expected x,y,z");
    out[k] = *value;
    if (k < 2) left.remove_prefix(end + 1);
  }
  return out;
}

/// The joint that `name` means: one of the skeleton's, or left or right for one of two parts of the body.
std::size_t joint_called(const std::string& name, const motion::Skeleton& skeleton, motion::BodyPart left,
                         motion::BodyPart right, const std::string& whole) {
  if (name == "left" || name == "right") {
    const motion::BodyParts body = motion::find_body(skeleton);
    const motion::BodyPart part = name == "left" ? left : right;
    require(body.contains(part), whole, ": the skeleton's ", name_of(part),
            " is not known by its name; give the joint's own name with --joint or --stand");
    return motion::joint_of(body, part);
  }
  try {
    return find_joint(skeleton, name);
  } catch (const Error& error) {
    throw Error(whole, ": ", error.what());
  }
}

/// The joints of a clip that a model knows.
motion::Motion of_model(motion::Motion clip, const motion::MotionFormat&) { return clip; }
motion::Motion of_model(motion::Motion clip, const motion::PositionFormat& format) {
  const int root = clip.skeleton.find(format.skeleton().joints.front().name);
  return root > 0 ? motion::fold_into_root(clip, root) : std::move(clip);
}

/// "1.2:pose.bvh", or "1.2:clip.bvh@3.5" for the pose at a time of a clip.
template <class Format>
PoseConstraint read_keyframe(const std::string& text, const Format& format) {
  const std::string whole = "--keyframe " + text;
  const std::size_t colon = text.find(':');
  const std::optional<double> time = finite_number(std::string_view(text).substr(0, colon));
  require(colon != text.npos && time && *time >= 0, whole,
          ": expected TIME:FILE, such as 1.2:pose.bvh, or TIME:FILE@SECONDS");
  std::string file = text.substr(colon + 1);
  double at = 0;
  if (const std::size_t mark = file.rfind('@'); mark != file.npos)
    if (const std::optional<double> seconds = finite_number(std::string_view(file).substr(mark + 1))) {
      at = *seconds;
      file.resize(mark);
    }
  motion::LoadedMotion loaded = read_clip(file, {}, format.space);
  motion::Motion clip = of_model(std::move(loaded.motion), format);
  format.require_skeleton(clip.skeleton, file);
  scale_to_model(clip, format.skeleton(), file);
  const std::size_t frame = frame_at(at, clip.rate);
  require(at >= 0 && frame < clip.frames, whole, ": ", file, " lasts ",
          duration(static_cast<double>(clip.frames) / clip.rate), ", expected a time in it");
  PoseConstraint out{.time = *time, .pose = slice(clip, frame, 1)};
  out.pose.rate = format.rate;
  return out;
}

template <class Format>
Direction read_for(const Directing& directing, const Format& format) {
  using enum motion::BodyPart;
  Direction out;
  if (!directing.path.empty()) {
    out.points = read_path(directing.path);
    for (const PathPoint& p : out.points) out.last = std::max(out.last, p.time.value_or(0));
    out.constraints.push_back(PathConstraint{.points = out.points});
  }
  for (const std::string& text : directing.keyframes) {
    out.constraints.push_back(read_keyframe(text, format));
    out.last = std::max(out.last, std::get<PoseConstraint>(out.constraints.back()).time);
  }
  const auto point = [&](const std::string& option, const std::string& text, const char* example) {
    const Spec spec = read_spec(option, text, true, example);
    const std::string whole = option + " " + text;
    out.constraints.push_back(
        JointConstraint{.joint = joint_called(spec.name, format.skeleton(), left_hand, right_hand, whole),
                        .from = spec.from,
                        .to = spec.to,
                        .position = read_point(spec.rest, whole)});
    out.last = std::max(out.last, spec.to);
  };
  for (const std::string& text : directing.hands) {
    require(text.starts_with("left@") || text.starts_with("right@"), "--hand ", text,
            ": expected left or right, such as left@2:0.3,1.4,0.5");
    point("--hand", text, "left@TIME:X,Y,Z, such as left@2:0.3,1.4,0.5");
  }
  for (const std::string& text : directing.joints)
    point("--joint", text, "NAME@TIME:X,Y,Z, such as Head@1.5:0,1.2,3");
  for (const std::string& text : directing.stands) {
    const Spec spec = read_spec("--stand", text, false, "left@FROM-TO, such as left@0.4-0.8");
    out.constraints.push_back(ContactConstraint{
        .joint = joint_called(spec.name, format.skeleton(), left_foot, right_foot, "--stand " + text),
        .from = spec.from,
        .to = spec.to});
    out.last = std::max(out.last, spec.to);
  }
  if (directing.loop) {
    out.constraints.push_back(LoopConstraint{.seconds = *directing.loop});
    out.last = std::max(out.last, *directing.loop);
  }
  return out;
}

/// The critic of a run, if `given` is a run's folder.
template <class Critic, class Model>
std::shared_ptr<const Critic> critic_of_run(const Model& model, const fs::path& given) {
  const fs::path file = RunFiles{given}.checkpoint();
  if (!fs::is_directory(given) || !fs::exists(file)) return {};
  return std::make_shared<const Critic>(model, file);
}

/// Whether a path leaves the pace to the model.
bool free_pace(const Direction& wanted) {
  return !wanted.points.empty() && std::none_of(wanted.points.begin(), wanted.points.end(),
                                                [](const PathPoint& p) { return p.time.has_value(); });
}

/// Where a motion begins that has nothing before it.
motion::RootTrack start_of(const Direction& wanted, double seconds) {
  if (!wanted.points.empty()) return TimedPath(wanted.points, seconds).start();
  return {.started = true};
}

}  // namespace

std::vector<fs::path> Directing::inputs() const {
  std::vector<fs::path> out{path};
  for (const std::string& text : keyframes) {
    const std::string file = text.substr(std::min(text.find(':'), text.size() - 1) + 1);
    out.emplace_back(file);
    out.emplace_back(file.substr(0, file.rfind('@')));
  }
  return out;
}

void add_optimiser_options(CLI::App& verb, DirectOptions& options, bool with_exact) {
  OptionFilter filter;
  if (!with_exact) filter.without = {"exact"};
  add_options(verb, fields_of(options), group, filter);
}

void add_direct_options(CLI::App& verb, Directing& directing) {
  const auto option = [&](const char* name, auto& member, const char* text, const char* type) {
    CLI::Option* const added = verb.add_option(name, member, text)->group(group)->type_name(type);
    if constexpr (!std::is_same_v<std::decay_t<decltype(member)>, std::string>)
      added->expected(1)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  };
  option("--path", directing.path,
         "the root goes along these points: lines of x,z or x,z,time or x,z,time,heading (seconds, degrees "
         "from +z); without --frames and times, as fast as the model does",
         "FILE.csv");
  option(
      "--keyframe", directing.keyframes,
      "the pose at a time is that of a file's first frame, or of its frame at some seconds; may be repeated",
      "TIME:FILE[@SECONDS]");
  option("--hand", directing.hands, "the left or right hand is at a point at a time; may be repeated",
         "left|right@TIME[-TIME]:X,Y,Z");
  option("--joint", directing.joints, "the same for any joint, by its name", "NAME@TIME[-TIME]:X,Y,Z");
  option("--stand", directing.stands, "the left or right foot, or a joint, stands still; may be repeated",
         "left|right|NAME@TIME-TIME");
  verb.add_option("--loop", directing.loop, "the motion ends as it begins, after these seconds [all of it]")
      ->expected(0, 1)
      ->default_str("0")
      ->check(not_negative())
      ->group(group)
      ->type_name("[SECONDS]");
  add_optimiser_options(verb, directing.options);
}

Direction read_direction(const Directing& directing, const motion::MotionFormat& format) {
  return read_for(directing, format);
}
Direction read_direction(const Directing& directing, const motion::PositionFormat& format) {
  return read_for(directing, format);
}

void use_critic(DirectOptions& options, const Dvgan& model, const fs::path& given) {
  if (const auto critic = critic_of_run<SavedCritic>(model, given))
    options.score = [critic](const Var& motion, const Sentences& text) { return (*critic)(motion, text); };
}
void use_critic(DirectOptions& options, const ActionGan& model, const fs::path& given) {
  if (model.is_baseline()) return;  // it was trained without one
  if (const auto critic = critic_of_run<SavedActionCritic>(model, given))
    options.score_pairs = [critic](const Var& pairs, const Var& classes) {
      return (*critic)(pairs, classes);
    };
}

std::vector<DirectedMotion> make_directed(Dvgan& model, const std::string& text, DirectOptions options,
                                          const Direction& wanted, const GenerateOptions& how) {
  const motion::MotionFormat& format = model.format();
  options.seed = how.seed, options.first_sample = how.first_sample, options.frames = how.frames;
  if (options.frames == 0) {
    options.frames = std::max(format.frames, frame_at(wanted.last, format.rate) + 1);
    if (free_pace(wanted))
      options.frames = std::max(frame_at(wanted.last, format.rate) + 1,
                                frames_for_way(model, text, TimedPath(wanted.points, 1).length(), how.seed));
  }
  DirectTask task{.text = text, .constraints = wanted.constraints};
  task.start = start_of(wanted, static_cast<double>(options.frames - 1) / format.rate);
  const ShownProgress shown(options);
  return direct(model, std::vector(how.count, task), options);
}

std::size_t frames_needed(const ActionGan& model, const std::vector<ActionPrior>& priors, std::size_t label,
                          const Direction& wanted, std::uint64_t seed) {
  const std::size_t last = frame_at(wanted.last, model.format().rate);
  if (!free_pace(wanted)) return std::max(last, 4 * model.format().frames);
  return std::max(last, frames_for_way(model, priors, label, TimedPath(wanted.points, 1).length(), seed));
}

std::vector<DirectedAction> make_directed(ActionGan& model, const std::vector<ActionPrior>& priors,
                                          const ActionSchedule& schedule, DirectOptions options,
                                          const Direction& wanted) {
  const double seconds = static_cast<double>(frames_of(schedule)) / model.format().rate;
  std::vector<ActionDirectTask> tasks;
  for (const ActionPrior& prior : priors)
    tasks.push_back({.prior = prior, .constraints = wanted.constraints, .start = start_of(wanted, seconds)});
  const ShownProgress shown(options);
  return direct(model, tasks, schedule, options);
}

ShownProgress::ShownProgress(DirectOptions& options) {
  const auto bar = std::make_shared<ProgressBar>(0, ProgressOptions{.label = "step"});
  const std::size_t each = options.iterations;
  options.report = [bar, each, started = false](const DirectProgress& p) mutable {
    if (!started) bar->start(p.windows * each);
    started = true;
    bar->update(p.window * each + p.iteration, {{"error / allowed", p.excess}});
  };
  options.should_stop = [] { return stop_requested(); };
  catch_signals();
  bar_ = bar;
}
ShownProgress::~ShownProgress() { bar_->finish(); }

bool print_constraint_errors(const std::vector<std::vector<ConstraintError>>& made, double leg) {
  std::vector<std::vector<std::string>> rows;
  std::size_t met = 0;
  for (std::size_t c = 0; c < made.front().size(); ++c) {
    double mean = 0, worst = 0, angle = 0;
    std::size_t good = 0;
    for (const std::vector<ConstraintError>& errors : made) {
      const ConstraintError& e = errors[c];
      mean += e.mean / static_cast<double>(made.size());
      worst = std::max(worst, e.worst), angle = std::max(angle, e.angle);
      good += e.met();
    }
    const ConstraintError& e = made.front()[c];
    const bool turns = e.angle_tolerance > 0;
    rows.push_back(
        {e.name, e.tolerance > 0 ? brief(mean, 3) : "-", e.tolerance > 0 ? brief(worst, 3) : "-",
         e.tolerance > 0 ? brief(worst / leg, 3) : "-", e.tolerance > 0 ? brief(e.tolerance, 3) : "-",
         turns ? fmt::format("{:.1f} of {:.0f}", motion::degrees(angle), motion::degrees(e.angle_tolerance))
               : "-",
         fmt::format("{} of {}", good, made.size())});
  }
  for (const std::vector<ConstraintError>& errors : made) met += largest_excess(errors) <= 1;
  print_table({"asked for", "mean error", "worst", "in legs", "allowed", "degrees", "met"}, rows, "lrrrrrr",
              "  ");
  if (met < made.size())
    fmt::print(
        "NOT MET by {}: try more --starts or --direct-iterations, another --seed or text, more time, or "
        "--exact\n",
        made.size() == 1 ? "the motion" : fmt::format("{} of {} motions", made.size() - met, made.size()));
  return met == made.size();
}

view::Marks marks_of(const std::vector<Constraint>& constraints, const motion::Motion& motion,
                     std::size_t root, double begin) {
  view::Marks out;
  for (const Constraint& c : constraints) {
    if (const auto* path = std::get_if<PathConstraint>(&c))
      for (const PathPoint& p : path->points) out.path.push_back({p.x, 0, p.z});
    if (const auto* joint = std::get_if<JointConstraint>(&c); joint != nullptr && joint->position)
      out.targets.push_back({*joint->position, begin + joint->from, begin + joint->to});
    if (const auto* pose = std::get_if<PoseConstraint>(&c)) {
      motion::Motion ghost = slice(pose->pose, 0, 1);
      const std::size_t f = std::min(frame_at(begin + pose->time, motion.rate), motion.frames - 1);
      if (!pose->placed) {
        const WorldPose at = world_pose(motion, f, root);
        ghost = motion::placed_at(std::move(ghost), root, {at.x, at.z, at.yaw, true}, true);
      }
      ghost.skeleton = motion.skeleton;
      out.ghosts.push_back(std::move(ghost));
    }
  }
  return out;
}

}  // namespace motiongan::command

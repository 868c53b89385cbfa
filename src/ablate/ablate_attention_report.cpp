// motiongan ablate attention: measures the variants and draws their motion.
#include <algorithm>

#include "ablate/ablate_attention.hpp"
#include "motiongan/view/line_plot.hpp"
#include "motiongan/view/pose_strip.hpp"
#include "shared/write_png.hpp"

namespace motiongan::command {
namespace {

constexpr double long_seconds = 30;

/// Positions as a motion that draws exactly these points: nothing is fitted, so stretched bones show. End
/// sites, whose positions are unknown, are left out.
motion::Motion as_drawn(const motion::Skeleton& skeleton, double rate,
                        std::span<const motion::Vec3> positions) {
  motion::Motion out;
  out.skeleton = skeleton;
  for (motion::Joint& joint : out.skeleton.joints) joint.end_site.reset();
  const std::size_t joints = skeleton.size();
  out.rate = rate;
  out.frames = positions.size() / joints;
  out.rotations.assign(positions.size(), motion::Quat{1, 0, 0, 0});
  for (std::size_t f = 0; f < out.frames; ++f)
    for (std::size_t j = 0; j < joints; ++j) {
      const int parent = skeleton.joints[j].parent;
      const motion::Vec3& p = positions[f * joints + j];
      out.positions.push_back(
          parent < 0 ? p : motion::subtract(p, positions[f * joints + static_cast<std::size_t>(parent)]));
    }
  return out;
}

/// Clamps positions that are far from any plausible body, and returns whether there were any: a model that
/// diverges makes limbs of a hundred metres, which no picture can show.
bool bring_near(const motion::Skeleton& skeleton, std::size_t prior_frames,
                std::vector<motion::Vec3>& positions) {
  const std::size_t joints = skeleton.size();
  const double height = view::detail::standing_height(skeleton, 0);
  double floor = positions.front()[1];
  for (std::size_t i = 0; i < prior_frames * joints; ++i) floor = std::min(floor, positions[i][1]);
  bool any = false;
  const auto bring = [&](double& value, double low, double high) {
    const double near = value >= low ? std::min(value, high) : low;  // NaN counts as low
    any = any || near != value;
    value = near;
  };
  for (std::size_t f = prior_frames * joints; f < positions.size(); f += joints) {
    const motion::Vec3 before = positions[f - joints];
    for (const std::size_t a : {0u, 2u}) bring(positions[f][a], before[a] - height, before[a] + height);
    for (std::size_t j = 0; j < joints; ++j) {
      motion::Vec3& p = positions[f + j];
      bring(p[1], floor - 0.25 * height, floor + 1.75 * height);
      for (const std::size_t a : {0u, 2u}) bring(p[a], positions[f][a] - height, positions[f][a] + height);
    }
  }
  return any;
}

/// Rows of poses for both pictures: for each class, the window followed by the most real frames.
class Strips {
 public:
  Strips(const motion::ActionDataset& data, const ActionEvaluation& evaluation) : data_(data) {
    for (std::size_t c = 0; c < data.format.classes.size(); ++c) {
      std::optional<std::size_t> best;
      std::size_t most = 0;
      for (std::size_t i = 0; i < evaluation.windows().windows.size(); ++i) {
        const EvaluationWindow& w = evaluation.windows().windows[i];
        const std::size_t left = data.test[w.clip].frames - w.start;
        if (w.label == c && left > most) best = i, most = left;
      }
      if (!best) continue;
      const EvaluationWindow& w = evaluation.windows().windows[*best];
      const motion::ActionClip& clip = data.test[w.clip];
      windows_.push_back(*best);
      titles_.push_back(data.format.classes[c]);
      rows_.emplace_back();
      add(rows_.size() - 1, "real clip " + clip.id,
          data.format.restore(std::span<const float>(clip.poses).subspan(w.start * data.format.dof()),
                              std::span(clip.places).subspan(w.start)));
    }
  }

  /// Adds the motion that a variant generated for all windows.
  void add(std::string_view title, const std::vector<std::vector<motion::Vec3>>& all) {
    for (std::size_t i = 0; i < windows_.size(); ++i) add(i, title, all[windows_[i]]);
  }

  /// Draws the prior and `seconds` after it; a real clip that ends sooner is drawn to its end.
  void write(const fs::path& path, double seconds) const {
    const auto frames =
        data_.format.frames + static_cast<std::size_t>(std::lround(seconds * data_.format.rate));
    std::vector<view::ViewedMotion> shown;
    for (const auto& rows : rows_)
      for (const view::ViewedMotion& row : rows) {
        shown.push_back(row);
        motion::Motion& m = shown.back().motion;
        const std::size_t kept = std::min(m.frames, frames);
        if (kept < frames)
          shown.back().title +=
              fmt::format(", which ends after {}", duration(static_cast<double>(kept) / m.rate));
        m.frames = kept;
        m.rotations.resize(kept * m.skeleton.size());
        m.positions.resize(kept * m.skeleton.size());
      }
    write_png(path, view::pose_strip(shown, {.poses = 14, .figure_height = 84}));
  }

 private:
  void add(std::size_t row, std::string_view title, std::vector<motion::Vec3> positions) {
    const bool left = bring_near(data_.format.skeleton(), data_.format.frames, positions);
    rows_[row].push_back(
        {fmt::format("{}: {}{}", titles_[row], title, left ? ", clamped to the picture" : ""),
         as_drawn(data_.format.skeleton(), data_.format.rate, positions), data_.format.frames});
  }

  const motion::ActionDataset& data_;
  std::vector<std::size_t> windows_;
  std::vector<std::string> titles_;                    // classes
  std::vector<std::vector<view::ViewedMotion>> rows_;  // [classes][rows]
};

void print_windows(const ActionEvaluation& evaluation) {
  const EvaluationWindows& w = evaluation.windows();
  const std::vector<std::string>& classes = evaluation.format().classes;
  const std::size_t length = evaluation.format().frames + w.future;
  std::string each, none;
  for (std::size_t c = 0; c < classes.size(); ++c) {
    each += fmt::format("{}{} ({} of {})", c > 0 ? ", " : "", classes[c], counted(w.per_class[c], "window"),
                        counted(w.clips_per_class[c], "clip"));
    if (w.per_class[c] == 0) none += (none.empty() ? "" : ", ") + classes[c];
  }
  fmt::print("\nmeasured on test clips: {}\n{} of {} have the {} frames that a prior and its future need\n",
             each, w.long_clips, counted(w.clips, "test clip"), length);
  if (!none.empty()) fmt::print("no test clip of {} is that long: not measured\n", none);
}

/// Three significant digits, with the spread over seeds if there are several.
std::string text_of(const MeanStd& m, double factor = 1) {
  return cell(m, [&](double v) { return fmt::format("{:.3g}", factor * v); });
}

void print_tables(const ActionEvaluation& evaluation, std::span<const AblationResult> results, bool metres) {
  using M = ActionMeasures;
  const double millimetres = metres ? 1000 : 1;
  std::vector<std::vector<std::string>> angles, motions;
  const auto add = [&](const AblationResult& r, std::string_view paper) {
    if (r.name != "truth") {
      const std::size_t iterations = r.runs.front().iterations;
      angles.push_back(
          {r.name, std::to_string(r.runs.size()), iterations > 0 ? std::to_string(iterations) : "",
           text_of(r.over_seeds(&M::curve_error)), text_of(r.over_seeds(&M::curve_error_first)),
           text_of(r.over_seeds(&M::curve_error_last)), text_of(r.over_seeds(&M::window_error)),
           fmt::format("{:.3g}", r.over_seeds(&M::window_error_deviation).mean), std::string(paper)});
    }
    std::vector<std::string> row{r.name,
                                 text_of(r.over_seeds(&M::bone_error)),
                                 text_of(r.over_seeds(&M::seam), millimetres),
                                 text_of(r.over_seeds(&M::seam_body), millimetres),
                                 text_of(r.over_seeds(&M::step), millimetres),
                                 text_of(r.over_seeds(&M::speed))};
    if (r.over_long_runs(&M::step).count > 0)
      row.insert(row.end(),
                 {text_of(r.over_long_runs(&M::bone_error)), text_of(r.over_long_runs(&M::step), millimetres),
                  text_of(r.over_long_runs(&M::speed)), text_of(r.over_long_runs(&M::distance)),
                  fmt::format("{:.0f}%", 100 * r.over_long_runs(&M::broken).mean)});
    else
      row.insert(row.end(), 5, "");
    motions.push_back(row);
  };
  add({"truth", {{.measures = evaluation.truth()}}}, "");
  for (const AblationResult& r : results)
    add(r, r.name == "still" ? "(not in the paper: the last pose, held)" : ablation_variant(r.name).paper);
  fmt::print(
      "\nangle between adjacent bones over the {} frames after the prior, in degrees: error of the mean\n"
      "curve (all frames, first second, last second), and of each window against its own ground truth,\n"
      "with its standard deviation between windows\n",
      evaluation.truth().angles.size());
  print_table(
      {"", "seeds", "iterations", "curve", "first s", "last s", "window", "deviation", "the paper says"},
      angles, "lrrrrrrrl", "  ");
  const std::string small = metres ? " mm" : "", large = metres ? " m" : "";
  fmt::print(
      "\nmotion{}: error of the bone lengths against the prior; mean step of the joints between seconds\n"
      "(seam; body: without the root's step), median step anywhere, speed of the root. The same over {} s,\n"
      "with the distance of the root from its start, and broken: percentage of motions whose bones are off\n"
      "by more than 100% in the last second\n",
      metres ? "" : " (lengths in the file's unit; --unit-metres gives metres)", brief(long_seconds));
  print_table({"", "bones %", "seam" + small, "body" + small, "step" + small, "speed" + large + "/s",
               "30 s: bones %", "step" + small, "speed" + large + "/s", "from start" + large, "broken"},
              motions, "lrrrrrrrrrr", "  ");
}

/// Iterations that a run's model was trained for; 0 if there is no checkpoint.
std::size_t iterations_of(const RunFiles& files) {
  return fs::exists(files.checkpoint()) ? read_run_record(files.checkpoint()).iteration : 0;
}

}  // namespace

void report_variants(const Context& context, const motion::ActionDataset& data, const fs::path& save,
                     const std::vector<const AblationVariant*>& variants,
                     const std::vector<std::uint64_t>& seeds, const AblationReport& options) {
  const bool metres = options.unit_metres > 0;
  EvaluationOptions wanted = options.evaluation;
  wanted.unit_metres = metres ? options.unit_metres : 1;
  const ActionEvaluation evaluation(data, wanted);
  const auto long_frames = static_cast<std::size_t>(std::lround(long_seconds * data.format.rate));
  const std::string own_format = io::to_json(data.format).dump();
  Strips strips(data, evaluation);
  std::vector<AblationResult> results;
  std::string missing;
  print_windows(evaluation);
  const auto measure = [&](const FutureMaker& maker, std::string_view title) {
    const auto all = evaluation.positions(maker, long_frames);
    if (!title.empty()) strips.add(title, all);
    return AblationRun{.measures = evaluation.measure(maker), .long_run = evaluation.measure_alone(all)};
  };
  for (const AblationVariant* variant : variants) {
    AblationResult result{std::string(variant->name), {}};
    for (const std::uint64_t seed : seeds) {
      const RunFiles files{run_folder(save, *variant, seed, seeds.front())};
      if (!fs::exists(files.generator())) continue;
      const ActionGan model = ActionGan::load(context, files.generator());
      require(
          io::to_json(model.format()).dump() == own_format, files.generator().string(),
          ": this model was trained on other data (other clips, labels, split or pose), and may know these "
          "test clips; give the original folder and options");
      result.runs.push_back(
          measure(future_maker(model), result.runs.empty() ? variant->title : std::string_view{}));
      result.runs.back().seed = seed;
      result.runs.back().iterations = iterations_of(files);
    }
    if (!result.runs.empty()) {
      results.push_back(std::move(result));
      continue;
    }
    require(!options.all_must_be_there, "there is no model of the variant ", variant->name, " (no ",
            RunFiles{run_folder(save, *variant, seeds.front(), seeds.front())}.generator().string(), ")");
    missing += (missing.empty() ? "" : ", ") + std::string(variant->name);
  }
  require(!results.empty(), "there is no model in ", save.string(),
          ": none of the variants has been trained");
  if (!missing.empty()) fmt::print("not trained, left out: {}\n", missing);

  make_folder(save);
  const std::vector<AblationClaim> claims = judge_claims(results, metres);
  write_angles(save / "angles.csv", evaluation, results);
  write_runs(save / "runs.csv", results, metres);
  std::vector<view::Series> curves;
  const auto add_curve = [&](std::string name, const std::vector<double>& angles) {
    curves.push_back({std::move(name), {}, angles});
    for (std::size_t f = 0; f < angles.size(); ++f) curves.back().x.push_back(static_cast<double>(f + 1));
  };
  add_curve("truth", evaluation.truth().angles);
  for (const AblationResult& r : results) add_curve(std::string(ablation_variant(r.name).title), r.angles());
  write_png(save / "angles.png",
            view::line_plot(curves, {.title = "mean angle between adjacent bones (degrees)",
                                     .x_label = "frame after the prior",
                                     .width = 1480,
                                     .height = 620}));
  results.push_back({"still", {measure(stand_still(data.format), "")}});
  write_table(save / "table.csv", evaluation, results, metres);

  print_tables(evaluation, results, metres);
  if (!claims.empty())
    fmt::print("\ndoes it agree with what the paper says? (even: within 10%{})\n",
               seeds.size() > 1 ? " or two standard errors" : "; one seed is a single sample");
  for (const AblationClaim& claim : claims)
    fmt::print("  {:<4} {} ({})\n",
               claim.verdict == Verdict::yes  ? "yes"
               : claim.verdict == Verdict::no ? "no"
                                              : "even",
               claim.claim, claim.evidence);
  strips.write(save / "strip_10s.png", 10);
  strips.write(save / "strip_30s.png", long_seconds);
  fmt::print("\nwrote table.csv, runs.csv, angles.csv, angles.png, strip_10s.png and strip_30s.png in {}\n",
             shown(save));
}

}  // namespace motiongan::command

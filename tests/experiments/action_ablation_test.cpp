// The seven variants of the action-model ablation, its tables, and the verdicts on the paper's claims.
#include "motiongan/experiments/action_ablation.hpp"

#include <doctest/doctest.h>

#include <unistd.h>

#include <filesystem>

#include "../support/messages.hpp"
#include "motiongan/procedural/procedural.hpp"

namespace action_ablation_test {

using namespace motiongan;
using motiongan::testing::message_of;
using motiongan::testing::says;

namespace {

const motion::ActionDataset& small_data() {
  static const motion::ActionDataset data = [] {
    motion::ActionDatasetOptions options;
    options.pattern = "{label}_*";
    options.classes = {"run", "walk"};
    options.frames = 8;
    options.rate = 8;
    return motion::ActionDataset::from_motions(
        motion::procedural_motions({.clips = 36, .seconds = 6, .rate = 8}), options);
  }();
  return data;
}

AblationRun run(std::uint64_t seed, double curve, double bones, double seam) {
  AblationRun out{.seed = seed, .iterations = 7};
  out.measures.angles = {40, 41, 39};
  out.measures.curve_error = curve;
  out.measures.curve_error_first = 1;
  out.measures.curve_error_last = 2;
  out.measures.bone_error = bones;
  out.measures.seam_body = seam;
  out.measures.seam = 0.012;
  out.measures.speed = 1.5;
  return out;
}

AblationResult result(const char* name, double curve, double bones, double seam) {
  return {name, {run(1, curve, bones, seam)}};
}

std::string text_of(const std::filesystem::path& path) { return motion::read_text(path, "table"); }

}  // namespace

TEST_CASE("seven variants, each differing from the full model as its name says") {
  REQUIRE(ablation_variants().size() == 7);
  const ActionGanOptions model{.hidden = 12, .noise_dim = 3};
  AttentionTrainOptions training;
  training.iterations = 9;
  training.batch = 5;
  const auto of = [&](const char* name) {
    const AblationVariant& v = ablation_variant(name);
    return std::make_pair(v.model(model), v.training(training));
  };
  for (const AblationVariant& v : ablation_variants()) {
    const auto [m, t] = of(std::string(v.name).c_str());
    CHECK(m.hidden == 12);
    CHECK(t.batch == 5);
    CHECK(t.class_weight == 1);
    CHECK(m.attention == (v.name != "no_attention" && v.name != "neither" && v.name != "lstm"));
    if (v.lstm) continue;
    CHECK((t.skeleton_weight > 0) == (v.name == "full" || v.name == "no_attention" || v.name == "no_blend"));
    CHECK((t.blend_weight > 0) == (v.name == "full" || v.name == "no_attention" || v.name == "no_skeleton"));
  }
  CHECK(of("lstm").first.generator == ActionGenerator::lstm);
  CHECK(of("lstm").first.noise_dim == 0);
  const BaselineTrainOptions lstm = AblationVariant::baseline_training(training);
  CHECK(lstm.batch == 5);
  CHECK(lstm.iterations == 9);
  CHECK(says(message_of([] { ablation_variant("half"); }), "full, no_attention, no_blend, no_skeleton"));
}

TEST_CASE("tables: ground truth first, lengths in millimetres if the unit is known") {
  const ActionEvaluation evaluation(small_data(), {.windows = 4, .frames = 3});
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("motiongan-ablation-" + std::to_string(getpid()) + ".csv");
  std::vector<AblationResult> results{result("full", 0.5, 3, 0.01), result("lstm", 2, 4, 0.02)};
  AblationRun& lstm = results[1].runs.front();
  lstm.long_run = lstm.measures;
  lstm.long_run->broken = 0.25;

  write_angles(path, evaluation, results);
  const std::string angles = text_of(path);
  CHECK(angles.starts_with("frame,seconds,truth,full,lstm\n1,0.125,"));
  CHECK(angles.find(",40,40\n2,0.25,") != std::string::npos);
  CHECK(angles.ends_with(",39,39\n"));

  write_table(path, evaluation, results, true);
  const std::string table = text_of(path);
  CHECK(table.starts_with("variant,iterations,curve_error_deg,"));
  CHECK(table.find(",seam_mm,") != std::string::npos);
  CHECK(table.find("\ntruth,,0,0,0,0,0,") != std::string::npos);
  CHECK(table.find("\nfull,7,0.5,1,2,0,0,3,12,10,0,0,1.5,0,,,,,,,1\n") != std::string::npos);
  CHECK(table.find("\nlstm,7,2,1,2,0,0,4,12,20,0,0,1.5,0,4,12,0,1.5,0,0.25,1\n") != std::string::npos);
  // Two seeds: means in the table, each of them in the other file.
  results[0].runs.push_back(run(2, 1.5, 5, 0.03));
  results[0].runs[1].measures.angles = {42, 41, 39};
  write_table(path, evaluation, results, true);
  CHECK(text_of(path).find("\nfull,7,1,1,2,0,0,4,12,20,0,0,1.5,0,,,,,,,2\n") != std::string::npos);
  write_runs(path, results, true);
  CHECK(text_of(path).find("variant,seed,iterations,curve_error_deg,") == 0);
  CHECK(text_of(path).find("\nfull,1,7,0.5,1,2,0,0,3,12,10,0,0,1.5,0,,,,,,\n"
                           "full,2,7,1.5,1,2,0,0,5,12,30,0,0,1.5,0,,,,,,\nlstm,1,7,2,") != std::string::npos);
  write_angles(path, evaluation, results);
  CHECK(text_of(path).find(",41,40\n2,0.25,") != std::string::npos);
  results[0].runs.pop_back();
  write_table(path, evaluation, results, false);
  CHECK(text_of(path).find("\nfull,7,0.5,1,2,0,0,3,0.012,0.01,") != std::string::npos);
  std::filesystem::remove(path);
}

TEST_CASE("only claims about the given variants are judged") {
  const std::vector<AblationResult> results{result("full", 1, 2, 0.01), result("no_attention", 3, 1, 0),
                                            result("no_blend", 0.5, 9, 0.03), result("lstm", 1.05, 0, 0)};
  const std::vector<AblationClaim> claims = judge_claims(results, true);
  const auto held = [&](const std::string& start) {
    for (const AblationClaim& c : claims)
      if (c.claim.starts_with(start)) return static_cast<int>(c.verdict);
    return -1;
  };
  CHECK(held("attention: closer") == int(Verdict::yes));
  CHECK(held("blend loss: closer") == int(Verdict::no));
  CHECK(held("blend loss: smaller jumps") == int(Verdict::yes));
  CHECK(held("closer to the ground-truth curve than the LSTM") == int(Verdict::even));
  CHECK(held("skeleton loss") == -1);
  CHECK(held("LSTM: its error grows") == int(Verdict::yes));  // error 1 to 2 degrees, angle 40 to 39
  for (const AblationClaim& c : claims)
    if (c.claim.starts_with("blend loss: smaller")) CHECK(c.evidence == "full 10, no_blend 30 mm");
  CHECK(judge_claims({}, true).empty());
}

TEST_CASE("with several seeds a claim needs two standard errors") {
  // Means 1 and 3, standard error sqrt(0.02 / 2 + 8 / 2) = 2.0: one apart; then sqrt(0.02 / 2 + 0.02 / 2).
  std::vector<AblationResult> results{{"full", {run(1, 0.9, 0, 0), run(2, 1.1, 0, 0)}},
                                      {"no_attention", {run(1, 1, 0, 0), run(2, 5, 0, 0)}}};
  AblationClaim claim = judge_claims(results, true).front();
  CHECK(claim.verdict == Verdict::even);
  CHECK(claim.evidence == "full 1 ± 0.141, no_attention 3 ± 2.83 degrees, 0.999 standard errors apart");
  results[1].runs = {run(1, 2.9, 0, 0), run(2, 3.1, 0, 0)};
  claim = judge_claims(results, true).front();
  CHECK(claim.verdict == Verdict::yes);
  CHECK(says(claim.evidence, "14.1 standard errors apart"));
}

}  // namespace action_ablation_test

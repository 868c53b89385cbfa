// The DVGAN ablation: its variants, their options, and statistics over seeds.
#include <doctest/doctest.h>

#include <motiongan/experiments/dvgan_ablation.hpp>
#include <set>

#include "../support/messages.hpp"

namespace dvgan_ablation_test {

using namespace motiongan;
using namespace motiongan::testing;

TEST_CASE("every combination has a unique name and is found by it") {
  const std::vector<DvganVariant> all = all_dvgan_variants();
  std::set<std::string> names;
  for (const DvganVariant& v : all) {
    names.insert(v.name());
    CHECK(dvgan_variant(v.name()) == v);
  }
  CHECK(all.size() == 32);
  CHECK(names.size() == 32);
  CHECK(names.contains("cnn-cnn-dense-shift-cut"));
  CHECK(names.contains("rnn-rnn"));
  CHECK(says(message_of([] { dvgan_variant("cnn-dense"); }), "no variant called \"cnn-dense\""));
}

TEST_CASE("the paper's rows come once each, in its order") {
  std::vector<std::string> names;
  for (const DvganVariant& v : paper_dvgan_variants()) names.push_back(v.name());
  CHECK(names == std::vector<std::string>{"cnn-cnn-final", "cnn-cnn-mod2", "cnn-cnn-dense",
                                          "cnn-cnn-dense-shift", "cnn-cnn-dense-shift-cut", "rnn-cnn-dense",
                                          "rnn-cnn-dense-shift", "rnn-cnn-dense-shift-cut", "cnn-rnn",
                                          "rnn-rnn"});
  const auto* row = dvgan_variant("cnn-cnn-dense-shift").find(paper::table2_cmu);
  REQUIRE(row != nullptr);
  CHECK(row->inception_score == 3.85);
  CHECK(row->recall == Recall{52.2, 58.4, 60.3, 63.0});
  CHECK(dvgan_variant("cnn-rnn").find(paper::table2_cmu) == nullptr);
  REQUIRE(dvgan_variant("cnn-rnn").find(paper::table_s1_h36m) != nullptr);
  CHECK(dvgan_variant("cnn-rnn").find(paper::table_s1_h36m)->recall[0] == 64.7);
}

TEST_CASE("a variant changes only its own options") {
  const DvganVariant v = dvgan_variant("rnn-cnn-mod2-cut");
  const DvganOptions model = v.model({.hidden = 24, .seed = 5});
  CHECK(model.generator == GeneratorKind::rnn);
  CHECK(model.cuts());
  CHECK(model.hidden == 24);
  CHECK(model.seed == 5);
  const DvganTrainOptions training = v.training({.batch = 7});
  CHECK(training.critic.critic == CriticKind::cnn);
  CHECK(training.critic.validation == Validation::mod2);
  CHECK_FALSE(training.input_shift);
  CHECK(training.batch == 7);
  CHECK_FALSE(dvgan_variant("cnn-rnn").model({}).cuts());  // off, not the generator's default
}

TEST_CASE("mean and spread over seeds, and paired differences") {
  const auto run = [](std::uint64_t seed, double score) {
    DvganRun out{seed, 1, {}};
    out.evaluation.measures.inception_score = score;
    return out;
  };
  const auto score = [](const ModelEvaluation& e) { return e.measures.inception_score; };
  const DvganAblationRow a{{}, {run(1, 1.0), run(2, 5.0), run(3, 2.0)}},
      b{{}, {run(2, 5.5), run(1, 2.5), run(9, 0.0)}};
  CHECK(a.over_seeds(score).mean == doctest::Approx(8.0 / 3));
  const MeanStd d = paired_difference(a, b, score);  // differences 1.5 and 0.5
  CHECK(d.count == 2);
  CHECK(paired_difference(a, DvganAblationRow{}, score).count == 0);
  CHECK(d.mean == doctest::Approx(1.0));
  CHECK(d.spread == doctest::Approx(std::sqrt(0.5)));
}

}  // namespace dvgan_ablation_test

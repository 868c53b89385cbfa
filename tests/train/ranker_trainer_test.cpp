// Rankers: training, saving, resuming, and scoring motion.
#include <doctest/doctest.h>

#include <filesystem>
#include <motiongan/experiments/ranker_evaluation.hpp>
#include <motiongan/train/ranker_trainer.hpp>

#include "../support/small_data.hpp"

namespace ranker_trainer_test {

using namespace motiongan;
using namespace motiongan::testing;
namespace fs = std::filesystem;

namespace {

/// Several clips of each of four actions.
motion::Dataset four_actions() {
  std::vector<motion::LabelledMotion> motions;
  for (auto& m : motion::procedural_motions({.clips = 68, .seconds = 5, .rate = 8, .seed = 5}))
    for (const char* action : {"walk", "squat", "jumping_jack", "bow"})
      if (m.id.starts_with(action)) {
        m.captions = {action};
        motions.push_back(m);
      }
  return motion::Dataset::from_motions(motions, {.frames = 8, .rate = 4});
}

}  // namespace

TEST_CASE("descriptions are distinct by their words, the most frequent first") {
  std::vector<motion::DatasetClip> clips(5);
  clips[0].captions = {"Run / jog"};
  clips[1].captions = {"walk", "Walk!"};
  clips[2].captions = {"jump"};
  clips[3].captions = {"run jog", "walk"};
  clips[4].captions = {"walk"};
  const motion::Descriptions all = motion::distinct_descriptions(clips);
  CHECK(all.texts == std::vector<std::string>{"walk", "Run / jog", "jump"});
  CHECK(all.clips == std::vector<std::size_t>{3, 2, 1});
  CHECK(all.of_clip == std::vector<std::vector<std::size_t>>{{1}, {0}, {2}, {0, 1}, {0}});
  const motion::Descriptions two = all.most_popular(2);
  CHECK(two.size() == 2);
  CHECK(two.of_clip[2].empty());
  CHECK(all.most_popular(9).size() == 3);
}

TEST_CASE("both rankers learn to distinguish actions") {
  const motion::Dataset data = four_actions();
  for (const RankerKind kind : {RankerKind::cnn, RankerKind::rnn}) {
    const Context context;
    Ranker ranker(context, data.format, {.kind = kind, .hidden = 16});
    const Recall before = evaluate_ranker(ranker, data).retrieval.recall;
    double first = 0, last = 0;
    RunOptions run;
    run.report = [&](std::size_t i, std::span<const NamedLoss> l) {
      (i == 1 ? first : last) = loss_of(l, "loss");
    };
    train(ranker, data, {.iterations = 150, .batch = 16, .adam = {.learning_rate = 3e-3}}, run);
    CHECK(last < 0.5 * first);
    const RankerEvaluation after = evaluate_ranker(ranker, data);
    CAPTURE(before[0]);
    CHECK(after.retrieval.recall[0] > random_recall(after.retrieval.descriptions)[0] + 30);
    CHECK(after.retrieval.samples == 8 * after.real.clips);
    CHECK(after.inception_score > 0.3);
    CHECK(after.inception_score < std::log(static_cast<double>(after.retrieval.descriptions)) + 1e-6);
  }
}

TEST_CASE("a window has the same scores as motion and as normalised poses" * doctest::test_suite("double")) {
  const motion::Dataset& data = small_data();
  const Context context({.precision = Precision::f64});
  const Ranker ranker(context, data.format, {.kind = RankerKind::rnn, .hidden = 8});
  const std::size_t dof = data.format.dof();
  std::vector<float> window(8 * dof);
  data.window(data.train[1], 3, window);
  const Tensor motion = Tensor::from(context, {8, 1, dof}, window);
  const auto direct = normalize_rows(ranker.embed(Var::constant(motion))).value().to_host<double>();
  const std::vector<float> features = ranker.features({data.to_motion(window)});
  REQUIRE(features.size() == 8);
  double length = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    CHECK(features[i] == doctest::Approx(direct[i]).epsilon(1e-4));
    length += direct[i] * direct[i];
  }
  CHECK(length == doctest::Approx(1));
  // Scores are dot products of features and descriptions.
  const std::vector<std::string> texts{data.train[0].captions[0], data.train[1].captions[0]};
  const Var text = ranker.describe(Sentences(
      context, {data.train[0].sentences[0], data.train[1].sentences[0]}, data.format.vocabulary.size()));
  const auto scores = ranker.scores(Var::constant(motion), text).value().to_host<double>();
  const std::vector<float> again = ranker.scores(features, texts);
  CHECK(again[0] == doctest::Approx(scores[0]).epsilon(1e-4));
  CHECK(again[1] == doctest::Approx(scores[1]).epsilon(1e-4));
}

TEST_CASE("a motion at another frame rate is resampled; a short one is refused") {
  const motion::Dataset& data = small_data();
  const Context context;
  const Ranker ranker(context, data.format, {.kind = RankerKind::rnn, .hidden = 8});
  const auto motions = motion::procedural_motions({.clips = 1, .seconds = 6, .rate = 32, .seed = 3});
  CHECK(ranker.features({motions[0].motion}).size() == 8);
  const auto brief = motion::procedural_motions({.clips = 1, .seconds = 1, .rate = 8, .seed = 3});
  CHECK(
      says(message_of([&] { ranker.features({brief[0].motion}); }), "cannot be ranked, expected at least 8"));
}

TEST_CASE("a resumed run equals an uninterrupted one") {
  const motion::Dataset& data = small_data();
  const fs::path folder = fs::temp_directory_path() / "motiongan_ranker_test";
  fs::remove_all(folder);
  const Context context;
  const auto run = [&](std::size_t iterations, bool keep, bool resume) {
    Ranker ranker(context, data.format, {.kind = RankerKind::cnn, .hidden = 8});
    RunOptions options;
    if (keep) options.save_dir = folder;
    options.resume = resume;
    train(ranker, data, {.iterations = iterations, .batch = 4, .descriptions = 3}, options);
    return all_values(ranker);
  };
  const auto whole = run(6, false, false);
  run(3, true, false);
  CHECK(run(6, true, true) == whole);
  Ranker loaded = Ranker::load(context, folder / "ranker.safetensors");
  CHECK(all_values(loaded) == whole);
  Ranker of_checkpoint = Ranker::load(context, folder / "checkpoint.safetensors");
  CHECK(all_values(of_checkpoint) == whole);
  CHECK(loaded.options().kind == RankerKind::cnn);
  CHECK(fs::exists(folder / "split.tsv"));
  fs::remove_all(folder);
}

TEST_CASE("the candidates of a step contain the right descriptions and are K in all") {
  const motion::Dataset& data = small_data();
  const Context context;
  Ranker ranker(context, data.format, {.hidden = 8});
  RankerTrainer trainer(ranker, data, {.batch = 1, .descriptions = 4});
  const std::vector<std::size_t> clips{2};
  for (std::uint32_t step = 0; step < 5; ++step) {
    const auto chosen = trainer.candidates(clips, step);
    CHECK(chosen.size() == 4);
    CHECK(std::is_sorted(chosen.begin(), chosen.end()));
    for (const std::size_t d : trainer.descriptions().of_clip[2])
      CHECK(std::find(chosen.begin(), chosen.end(), d) != chosen.end());
  }
}

TEST_CASE("invalid data and files are refused") {
  const Context context;
  auto motions = motion::procedural_motions({.clips = 6, .seconds = 4, .rate = 8, .seed = 3});
  for (auto& m : motions) m.captions = {"move"};
  const auto one = motion::Dataset::from_motions(motions, {.frames = 8, .rate = 4});
  Ranker ranker(context, one.format, {.hidden = 8});
  CHECK(says(message_of([&] { RankerTrainer(ranker, one, {}); }), "have the same description"));
  const fs::path file = fs::temp_directory_path() / "motiongan_not_a_ranker.safetensors";
  Dvgan(context, small_data().format, {.hidden = 8}).save(file);
  CHECK(says(message_of([&] { Ranker::load(context, file); }),
             "expected one of cnn_ranker, rnn_ranker; motiongan train ranker makes one"));
  fs::remove(file);
}

}  // namespace ranker_trainer_test

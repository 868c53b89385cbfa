// Models in the completion experiment: their training data, and their errors compared with single
// predictions.
#include <doctest/doctest.h>

#include <motiongan/experiments/completion_models.hpp>

#include "../support/expmap_files.hpp"
#include "../support/messages.hpp"

namespace completion_models_test {

using namespace motiongan;
using testing::ExpmapFolder;
using testing::message_of;
using testing::says;

namespace {

const CompletionData& small_h36m() {
  static const CompletionData data = [] {
    const ExpmapFolder folder;
    testing::write_small_h36m(folder.path());
    return CompletionData(motion::read_expmap_collection(folder.path(), {.actions = {"walking"}}));
  }();
  return data;
}

const Context& context() {
  static const Context one;
  return one;
}

bool same(double a, double b) { return std::abs(a - b) < 1e-4 * (1 + std::abs(b)); }

}  // namespace

TEST_CASE("the baselines' data contains every training clip with its action") {
  const PredictionData data = prediction_data(small_h36m());
  CHECK(data.dof == 14);
  CHECK(data.action_count == 2);
  CHECK(data.actions == std::vector<std::size_t>{0, 0, 1, 1, 1});  // eating, walking
  CHECK(data.sequences[3] == small_h36m().train()[3].poses);
}

TEST_CASE("a baseline's errors equal those of single predictions") {
  const CompletionData& data = small_h36m();
  const PredictionModel model(context(), {14, 2},
                              {.predictor = Predictor::seq2seq, .hidden = 8, .labels = true, .seed = 3});
  const auto errors = prediction_errors(model, data);
  REQUIRE(errors.size() == 1);
  CompletionErrors mean{};
  for (const CompletionTest& test : data.tests()) {
    const std::vector<std::size_t> walking{1};
    const auto one = data.errors(test, model.predict(test.prefix, 1, walking, 25));
    for (std::size_t m = 0; m < 6; ++m) mean[m] += one[m] / 8;
  }
  for (std::size_t m = 0; m < 6; ++m) CHECK(same(errors[0][m], mean[m]));
  CHECK(mean[5] > 0.01);
}

TEST_CASE("DVGAN's data set: every second frame, all clips for training, the action as caption") {
  const CompletionData& data = small_h36m();
  const motion::Dataset set = completion_dataset(data, 40, 2);
  CHECK(set.train.size() == 5);
  CHECK(set.test.empty());
  CHECK(set.format.rate == 12.5);
  CHECK(set.format.dof() == 14);
  CHECK(set.format.vocabulary.words() == std::vector<std::string>{"<unk>", "eating", "walking"});
  CHECK(set.starts(set.train[0]) == 100 - 78);
  std::vector<float> window(40 * 14);
  set.window(set.train[1], 7, window);
  for (const std::size_t i : {0u, 1u, 39u})
    CHECK(window[i * 14 + 9] == data.train()[1].poses[(7 + 2 * i) * 14 + 9]);
  CHECK(set.to_motion(window).skeleton.size() == 5);
  CHECK(completion_dataset(data, 50, 2).skipped.empty());
  CHECK(says(message_of([&] { completion_dataset(data, 51, 2); }),
             "no training file holds 51 frames with a stride of 2; the longest allows 50"));
}

TEST_CASE("DVGAN's errors equal those of its completions, at the times of its frames") {
  const CompletionData& data = small_h36m();
  const motion::Dataset set = completion_dataset(data, 40, 2);
  const Dvgan model(context(), set.format, {.generator = GeneratorKind::rnn, .hidden = 8, .seed = 2});
  const SampledErrors one = dvgan_errors(model, data, 2, 1, 5), three = dvgan_errors(model, data, 2, 3, 5);

  // Sample s of test t is sample 65536 t + s of the seed; the prefix is frames 1, 3, ... 49.
  const NoGrad values_only;
  CompletionErrors mean{}, mean3{}, best3{};
  for (std::size_t t = 0; t < 8; ++t) {
    const CompletionTest& test = data.tests()[t];
    std::vector<float> prior;
    for (std::size_t f = 1; f < 50; f += 2)
      prior.insert(prior.end(), test.prefix.begin() + static_cast<std::ptrdiff_t>(f * 14),
                   test.prefix.begin() + static_cast<std::ptrdiff_t>((f + 1) * 14));
    REQUIRE(prior.size() == 25 * 14);
    CompletionErrors best;
    best.fill(1e9);
    for (std::uint32_t s = 0; s < 3; ++s) {
      const Sentences text(context(), {set.format.vocabulary.encode("walking")}, 3);
      const std::vector<float> made =
          model
              .complete(text,
                        Var::constant(Tensor::from(context(), {25, 1, 14}, std::span<const float>(prior))),
                        {.seed = 5, .first_sample = static_cast<std::uint32_t>(65536 * t) + s})
              .value()
              .to_host();
      std::vector<float> prediction(25 * 14);
      for (std::size_t p = 1; p <= 12; ++p)  // predicted frame p is 2 p frames after the prefix
        std::copy_n(made.begin() + static_cast<std::ptrdiff_t>((24 + p) * 14), 14,
                    prediction.begin() + static_cast<std::ptrdiff_t>((2 * p - 1) * 14));
      const CompletionErrors errors = data.errors(test, prediction);
      for (std::size_t m = 0; m < 5; ++m) {
        if (s == 0) mean[m] += errors[m] / 8;
        mean3[m] += errors[m] / 24;
        best[m] = std::min(best[m], errors[m]);
      }
    }
    for (std::size_t m = 0; m < 5; ++m) best3[m] += best[m] / 8;
  }
  for (std::size_t m = 0; m < 5; ++m) {
    CHECK(same(one.mean[0][m], mean[m]));
    CHECK(one.best[0][m] == one.mean[0][m]);
    CHECK(same(three.mean[0][m], mean3[m]));
    CHECK(same(three.best[0][m], best3[m]));
  }
  CHECK(three.best[0][4] < three.mean[0][4]);
  CHECK(std::isnan(one.mean[0][5]));  // 1000 ms: frame 25 is odd
  const SampledErrors every = dvgan_errors(model, data, 1, 1, 5);
  CHECK_FALSE(std::isnan(every.mean[0][5]));
  CHECK(dvgan_errors(model, data, 2, 3, 5).mean[0][3] == three.mean[0][3]);
}

TEST_CASE("models that do not fit the data are refused") {
  const CompletionData& data = small_h36m();
  motion::Dataset set = completion_dataset(data, 32, 2);
  const Dvgan cnn(context(), set.format, {.generator = GeneratorKind::cnn, .hidden = 8});
  CHECK(says(message_of([&] { dvgan_errors(cnn, data, 2, 1, 1); }), "CNN generator"));
  std::vector<double> std = set.format.normalizer.std();
  std[3] = 0;
  set.format.normalizer = motion::Normalizer(set.format.normalizer.mean(), std);
  set.format.low.clear(), set.format.high.clear();
  const Dvgan other(context(), set.format, {.generator = GeneratorKind::rnn, .hidden = 8});
  CHECK(says(message_of([&] { dvgan_errors(other, data, 2, 1, 1); }), "trained on other data"));
  CHECK(says(message_of([&] { dvgan_errors(other, data, 2, 0, 1); }), "samples is 0"));
}

}  // namespace completion_models_test

// The text encoder: sentences of different lengths in one batch.
#include <doctest/doctest.h>

#include <motiongan/nn/text_encoder.hpp>

#include "../support/check_grads.hpp"

namespace text_encoder_test {

using namespace motiongan;

namespace {

constexpr std::size_t vocabulary = 12;
using Words = std::vector<std::vector<int>>;

std::vector<float> encode(const Context& context, const TextEncoder& encoder, const Words& sentences) {
  return encoder(Sentences(context, sentences, vocabulary)).value().to_host();
}

}  // namespace

TEST_CASE("sentences: layout, and invalid words") {
  const Context context;
  const Sentences s(context, {{3, 1}, {5, 6, 7}}, vocabulary);
  CHECK(s.batch == 2);
  CHECK(s.longest == 3);
  CHECK(s.lengths.to_host() == std::vector<cl_int>{2, 3});
  const std::vector<cl_int> words = s.words.to_host();  // [longest, batch]
  CHECK(std::vector<cl_int>(words.begin(), words.begin() + 4) == std::vector<cl_int>{3, 5, 1, 6});
  CHECK(words[5] == 7);
  CHECK_THROWS_WITH_AS(Sentences(context, {{1}, {}}, vocabulary),
                       "a sentence is empty: every sample needs a description", Error);
  CHECK_THROWS_WITH_AS(Sentences(context, {{1, 12}}, vocabulary),
                       "word id 12 is outside the vocabulary of 12 words", Error);
  CHECK_THROWS_AS(Sentences(context, {{-1}}, vocabulary), Error);
}

TEST_CASE("sentences that samples share are encoded once" * doctest::test_suite("double")) {
  const Context context(ContextOptions{.precision = Precision::f64});
  // 17 samples and quarters of 5: three distinct sentences take 5 rows, 16 distinct ones a row each.
  Words shared{{3, 1}, {5, 6, 7}, {3, 1}, {3, 1}, {2}, {5, 6, 7}};
  while (shared.size() < 17) shared.push_back({3, 1});
  const Sentences text(context, shared, vocabulary);
  CHECK(text.batch == 17);
  CHECK(text.rows == 5);
  CHECK(text.lengths.to_host() == std::vector<cl_int>{2, 3, 1, 2, 2});
  const std::vector<cl_int> rows = text.of_sample.to_host();
  CHECK(std::vector<cl_int>(rows.begin(), rows.begin() + 6) == std::vector<cl_int>{0, 1, 0, 0, 2, 1});
  Words mostly(17, {1});
  for (int i = 0; i < 16; ++i) mostly[static_cast<std::size_t>(i)] = {i % 12, i / 4};
  CHECK(Sentences(context, mostly, vocabulary).rows == 17);
  Initializer init(context, 4);
  TextEncoder encoder(init, vocabulary, 16);
  const Var encoded = encoder(text);
  const std::vector<double> all = encoded.value().to_host<double>();
  // Sample by sample, each with weights of its own in the loss.
  const std::vector<Var> parameters = values_of(named_parameters(encoder));
  const Var weights = Var::constant(random_normal(context, {.seed = 3}, 1, shared.size(), 16));
  Var loss;
  for (std::size_t b = 0; b < shared.size(); ++b) {
    const Var alone = encoder(Sentences(context, {shared[b]}, vocabulary));
    CHECK(alone.value().to_host<double>() ==
          std::vector<double>(all.begin() + static_cast<std::ptrdiff_t>(16 * b),
                              all.begin() + static_cast<std::ptrdiff_t>(16 * b + 16)));
    const Var term = sum(alone * reshape(slice(weights, 1, b, 1), {1, 16}));
    loss = loss.empty() ? term : loss + term;
  }
  const std::vector<Var> expected = grad(loss, parameters),
                         found = grad(sum(encoded * reshape(weights, {shared.size(), 16})), parameters);
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const std::vector<double> x = found[i].value().to_host<double>(),
                              y = expected[i].value().to_host<double>();
    for (std::size_t e = 0; e < x.size(); ++e) CHECK(x[e] == doctest::Approx(y[e]).epsilon(1e-10));
  }
}

TEST_CASE("a sentence is encoded the same alone and in a batch, bit for bit") {
  const Context context;
  for (std::size_t k : {8, 20, 64}) {
    Initializer init(context, 4);
    const TextEncoder encoder(init, vocabulary, k);
    const Words sentences{{1, 2, 3}, {4}, {5, 6, 7, 8, 9, 10, 11}, {4, 4}, {0, 2}};
    const std::vector<float> all = encode(context, encoder, sentences);
    REQUIRE(all.size() == sentences.size() * k);
    for (std::size_t b = 0; b < sentences.size(); ++b) {
      CAPTURE(b);
      const auto row = all.begin() + static_cast<std::ptrdiff_t>(b * k);
      CHECK(encode(context, encoder, {sentences[b]}) ==
            std::vector<float>(row, row + static_cast<std::ptrdiff_t>(k)));
    }
    CHECK(encode(context, encoder, {{1, 2}}) != encode(context, encoder, {{2, 1}}));
    CHECK(encode(context, encoder, {{4}}) != encode(context, encoder, {{4, 4}}));
  }
}

TEST_CASE("padding affects neither value nor gradient") {
  const Context context;
  Initializer init(context, 4);
  TextEncoder encoder(init, vocabulary, 16);
  const std::vector<Var> parameters = values_of(named_parameters(encoder));
  const auto run = [&](cl_int behind) {
    Sentences s(context, {{1, 2}, {3, 4, 5}}, vocabulary);
    s.words.write(std::vector<cl_int>{1, 3, 2, 4, behind, 5});
    const Var y = encoder(s);
    std::vector<std::vector<float>> all{y.value().to_host()};
    const std::vector<Var> gradients = grad(sum(square(y)), parameters);
    for (std::size_t i = 1; i < gradients.size(); ++i) all.push_back(gradients[i].value().to_host());
    // Only the embedding rows of real words have a gradient.
    const std::vector<float> table = gradients[0].value().to_host();
    for (std::size_t row = 0; row < vocabulary; ++row) {
      double size = 0;
      for (std::size_t c = 0; c < 16; ++c) size += std::abs(table[row * 16 + c]);
      CAPTURE(row);
      CHECK((size > 0) == (row >= 1 && row <= 5));
    }
    return all;
  };
  const auto reference = run(0);
  CHECK(run(11) == reference);
  CHECK(run(7) == reference);
}

TEST_CASE("first and second derivatives of the whole encoder" * doctest::test_suite("double")) {
  const Context& context = testing::double_context();
  Initializer init(context, 9);
  TextEncoder encoder(init, vocabulary, 3);
  const Sentences s(context, {{1, 2, 3}, {4}}, vocabulary);
  const std::vector<NamedParameter> all = named_parameters(encoder);
  const auto check = [&](const std::vector<std::size_t>& which, int order) {
    std::vector<testing::Input> at;
    for (std::size_t i : which)
      at.push_back({all[i].value->shape(), all[i].value->value().to_host<double>()});
    const testing::Function f = [&](const std::vector<Var>& values) {
      for (std::size_t i = 0; i < which.size(); ++i) *all[which[i]].value = values[i];
      return encoder(s);
    };
    CHECK(testing::check_grads(context, f, at, order) < 1e-7);
  };
  check({0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10}, 1);
  check({0, 2, 9}, 2);  // embedding, the first layer's recurrent weights, projection
}

}  // namespace text_encoder_test

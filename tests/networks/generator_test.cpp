// The CNN generator: parameter names, final cut, derivatives.
#include <doctest/doctest.h>

#include <motiongan/networks/cnn_generator.hpp>
#include <motiongan/nn/state_dict.hpp>

#include "../support/check_grads.hpp"

namespace generator_test {

using namespace motiongan;
using testing::double_context;

namespace {

constexpr std::size_t vocabulary = 9, dof = 5, k = 4;

CnnGenerator made(const Context& context, std::size_t frames, bool final_cut, std::size_t taps_count = 3) {
  return CnnGenerator(Initializer(context, 3), {.vocabulary = vocabulary,
                                                .dof = dof,
                                                .frames = frames,
                                                .hidden = k,
                                                .taps = taps_count,
                                                .final_cut = final_cut});
}

/// "name [shape in files]", in the model's order.
std::vector<std::string> listed(CnnGenerator& model) {
  std::vector<std::string> lines;
  for (const NamedParameter& p : named_parameters(model))
    lines.push_back(p.name + " " + to_string(io::file_shape(p)));
  return lines;
}

/// Noise for every frame of every level.
std::vector<Var> all_noise(const Context& context, std::size_t levels, std::size_t batch) {
  std::vector<Var> z;
  for (std::size_t i = 0; i <= levels; ++i)
    z.push_back(Var::constant(random_normal(context, {.seed = 8, .stream = RandomStream::noise + i},
                                            std::size_t{1} << i, batch, k)));
  return z;
}

double largest_difference(const Var& a, const Var& b) {
  const std::vector<double> x = a.value().to_host<double>(), y = b.value().to_host<double>();
  REQUIRE(x.size() == y.size());
  double worst = 0;
  for (std::size_t i = 0; i < x.size(); ++i) worst = std::max(worst, std::abs(x[i] - y[i]));
  return worst;
}

}  // namespace

TEST_CASE("parameter names and shapes, as in a PyTorch model" * doctest::test_suite("double")) {
  const std::vector<std::string> text{"text.embedding.weight [9, 4]",
                                      "text.lstm.weight_ih_l0 [16, 4]",
                                      "text.lstm.weight_hh_l0 [16, 4]",
                                      "text.lstm.bias_ih_l0 [16]",
                                      "text.lstm.bias_hh_l0 [16]",
                                      "text.lstm.weight_ih_l1 [16, 4]",
                                      "text.lstm.weight_hh_l1 [16, 4]",
                                      "text.lstm.bias_ih_l1 [16]",
                                      "text.lstm.bias_hh_l1 [16]",
                                      "text.proj.weight [4, 16]",
                                      "text.proj.bias [4]"};
  std::vector<std::string> expected = text;
  for (const char* line : {"plot.0.noise.weight [4, 4, 1]",     "plot.0.noise.bias [4]",
                           "plot.0.out.weight [4, 4, 1]",       "plot.0.out.bias [4]",
                           "plot.1.noise.weight [4, 4, 1]",     "plot.1.noise.bias [4]",
                           "plot.1.out.weight [4, 4, 1]",       "plot.1.out.bias [4]",
                           "plot.2.noise.weight [4, 4, 1]",     "plot.2.noise.bias [4]",
                           "plot.2.out.weight [4, 4, 1]",       "plot.2.out.bias [4]",
                           "residual.1.conv1.weight [4, 4, 3]", "residual.1.conv1.bias [4]",
                           "residual.1.conv2.weight [4, 4, 3]", "residual.1.conv2.bias [4]",
                           "residual.2.conv1.weight [4, 4, 3]", "residual.2.conv1.bias [4]",
                           "residual.2.conv2.weight [4, 4, 3]", "residual.2.conv2.bias [4]",
                           "decode.weight [5, 4, 1]",           "decode.bias [5]"})
    expected.push_back(line);
  CnnGenerator plain = made(double_context(), 4, false);
  CHECK(listed(plain) == expected);
  CnnGenerator cut = made(double_context(), 2, true);  // generates 4 frames with the same parameters
  CHECK(listed(cut) == expected);
  CnnGenerator five = made(double_context(), 4, false, 5);
  CHECK(listed(five).at(23) == "residual.1.conv1.weight [4, 4, 5]");
}

TEST_CASE("the final cut keeps N of the 2N frames of the model without cut, gradients included" *
          doctest::test_suite("double")) {
  const Context& context = double_context();
  for (std::size_t taps_count : {3, 5}) {
    const std::size_t frames = 8;
    CnnGenerator cut_model = made(context, frames, true, taps_count),
                 whole = made(context, 2 * frames, false, taps_count);
    const std::vector<NamedParameter> ours = named_parameters(cut_model), theirs = named_parameters(whole);
    for (std::size_t i = 0; i < ours.size(); ++i) REQUIRE(ours[i].name == theirs[i].name);
    io::SafeTensors file;
    io::save_parameters(ours, file);
    io::load_parameters(theirs, file, "memory");

    const std::vector<cl_int> cuts{0, 1, 3, 7, 8};
    const std::size_t batch = cuts.size();
    const Indices cut(context, cuts);
    const Sentences text(context, {{1}, {2, 3}, {4, 5, 6}, {7}, {8, 1}}, vocabulary);
    const std::vector<Var> z = all_noise(context, 4, batch);
    std::vector<Var> kept_z = z;
    kept_z.back() = cut_model.cut_noise(z.back(), cut);
    const Var kept = cut_model(text, kept_z, cut), expected = shift_frames(whole(text, z, {}), cut, frames);
    CHECK(kept.shape() == Shape{frames, batch, dof});
    CHECK(largest_difference(kept, expected) < 1e-13);
    const std::vector<Var> a = grad(sum(square(kept)), values_of(ours)),
                           b = grad(sum(square(expected)), values_of(theirs));
    for (std::size_t i = 0; i < a.size(); ++i) {
      CAPTURE(ours[i].name);
      CHECK(largest_difference(a[i], b[i]) < 1e-11);
    }
    // noise() returns the needed frames of the noise for all frames.
    const RandomKey key{.seed = 8};
    const std::vector<Var> made_z = cut_model.noise(context, key, batch, cut);
    CHECK(largest_difference(cut_model(text, made_z, cut), kept) < 1e-13);
  }
}

TEST_CASE("first derivatives with respect to every parameter, with and without cut, 3 and 5 taps" *
          doctest::test_suite("double")) {
  const Context& context = double_context();
  for (bool final_cut : {false, true})
    for (std::size_t taps_count : {3, 5}) {
      CnnGenerator model = made(context, 2, final_cut, taps_count);
      const std::vector<NamedParameter> parameters = named_parameters(model);
      const Sentences text(context, {{1, 2}, {3}}, vocabulary);
      const Indices cut = final_cut ? Indices(context, std::vector<cl_int>{0, 1}) : Indices();
      const std::vector<Var> z = model.noise(context, {.seed = 12}, 2, cut);
      std::vector<testing::Input> at;
      for (const NamedParameter& p : parameters)
        at.push_back({p.value->shape(), p.value->value().to_host<double>()});
      const testing::Function f = [&](const std::vector<Var>& values) {
        for (std::size_t i = 0; i < parameters.size(); ++i) *parameters[i].value = values[i];
        return model(text, z, cut);
      };
      CAPTURE(final_cut);
      CHECK(testing::check_grads(context, f, at, 1) < 1e-7);
    }
}

TEST_CASE("noise of another size is rejected" * doctest::test_suite("double")) {
  CnnGenerator model = made(double_context(), 4, false);
  const Sentences text(double_context(), {{1}}, vocabulary);
  CHECK_THROWS_WITH_AS(model(text, all_noise(double_context(), 1, 1), {}),
                       "CnnGenerator: noise for 2 levels, expected 3", Error);
}

}  // namespace generator_test

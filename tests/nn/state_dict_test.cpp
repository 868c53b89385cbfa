// Parameters in files: PyTorch's memory layout, and rejected files.
#include <doctest/doctest.h>

#include <filesystem>
#include <limits>
#include <motiongan/nn/state_dict.hpp>
#include <motiongan/nn/text_encoder.hpp>

namespace state_dict_test {

using namespace motiongan;

namespace {

const Context& context() {
  static const Context c;
  return c;
}

/// A model of a convolution and a linear layer.
struct Pair {
  Conv1d conv;
  Linear linear;
  explicit Pair(std::uint64_t seed, std::size_t taps_count = 3) {
    Initializer init(context(), seed);
    conv = Conv1d(init, 2, 4, taps_count);
    linear = Linear(init, 3, 2);
  }
  void list_parameters(ParameterList& list) {
    list.add_module("conv", conv);
    list.add_module("linear", linear);
  }
};

std::vector<std::vector<float>> values(Pair& pair) {
  std::vector<std::vector<float>> all;
  for (const NamedParameter& p : named_parameters(pair)) all.push_back(p.value->value().to_host());
  return all;
}

io::SafeTensors saved(Pair& pair, const std::string& prefix = "") {
  io::SafeTensors file;
  io::save_parameters(named_parameters(pair), file, prefix);
  return file;
}

/// The error of load_parameters for a file; checks that the model is unchanged.
std::string refusal(const io::SafeTensors& file) {
  Pair pair(77);
  const auto before = values(pair);
  std::string text = "no error";
  try {
    io::load_parameters(named_parameters(pair), file, "some.safetensors");
  } catch (const Error& error) {
    text = error.what();
  }
  if (text != "no error") CHECK(values(pair) == before);
  return text;
}

bool says(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("names, shapes and the layout of a convolution's weights") {
  Pair pair(1);
  const io::SafeTensors file = saved(pair);
  REQUIRE(file.tensors.size() == 4);
  CHECK(file.at("conv.weight").shape == Shape{4, 2, 3});  // [out, in, taps]
  CHECK(file.at("conv.bias").shape == Shape{4});
  CHECK(file.at("linear.weight").shape == Shape{2, 3});
  CHECK(file.at("linear.bias").shape == Shape{2});
  const std::vector<float> ours = pair.conv.weight.value().to_host(),
                           theirs = file.at("conv.weight").as<float>();
  for (std::size_t out = 0; out < 4; ++out)
    for (std::size_t in = 0; in < 2; ++in)
      for (std::size_t tap = 0; tap < 3; ++tap)
        CHECK(theirs[(out * 2 + in) * 3 + tap] == ours[(tap * 4 + out) * 2 + in]);
  CHECK(file.at("linear.weight").as<float>() == pair.linear.weight.value().to_host());
}

TEST_CASE("a round trip through a file keeps every bit, also with a prefix") {
  const auto path = std::filesystem::temp_directory_path() / "motiongan_state_dict_test.safetensors";
  for (const std::string prefix : {"", "generator."}) {
    Pair pair(1), other(2);
    CHECK(values(pair) != values(other));
    saved(pair, prefix).write(path);
    io::load_parameters(named_parameters(other), io::SafeTensors::read(path), path.string(), prefix);
    CHECK(values(pair) == values(other));
  }
  std::filesystem::remove(path);
}

TEST_CASE("other floating-point types are read, integers are not") {
  Pair pair(3);
  io::SafeTensors file = saved(pair);
  file.tensors["conv.bias"] = io::SafeTensor::of({4}, std::vector<double>{1, 2, 3, 4});
  CHECK(refusal(file) == "no error");
  file.tensors["conv.bias"] = io::SafeTensor::of({4}, std::vector<std::int64_t>{1, 2, 3, 4});
  CHECK(says(refusal(file), "I64"));
}

TEST_CASE("double contexts write and read doubles" * doctest::test_suite("double")) {
  const Context doubles({.precision = Precision::f64});
  const std::vector<double> fine{0.1, 1.0 / 3};
  Var v = Var::leaf(Tensor::from(doubles, {2}, fine));
  io::SafeTensors file;
  io::save_parameters({{"v", &v}}, file);
  CHECK(file.at("v").dtype == "F64");
  CHECK(file.at("v").as<double>() == fine);
  Var w = Var::leaf(Tensor(doubles, {2}));
  io::load_parameters({{"v", &w}}, file, "memory");
  CHECK(w.value().to_host<double>() == fine);
}

TEST_CASE("a file that does not fit is rejected by tensor and changes nothing") {
  Pair pair(1);
  io::SafeTensors missing = saved(pair);
  missing.tensors.erase("linear.bias");
  const std::string text = refusal(missing);
  CHECK(says(text, "some.safetensors: the tensor \"linear.bias\" of shape [2] is missing"));

  Pair five(1, 5);
  CHECK(says(refusal(saved(five)), "\"conv.weight\" has shape [4, 2, 5], expected [4, 2, 3]"));

  io::SafeTensors flat = saved(pair);
  flat.tensors["linear.weight"].shape = {6};
  CHECK(says(refusal(flat), "\"linear.weight\" has shape [6], expected [2, 3]"));

  for (float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    io::SafeTensors damaged = saved(pair);
    damaged.tensors["linear.bias"] = io::SafeTensor::of({2}, std::vector<float>{1, bad});
    CHECK(says(refusal(damaged), "some.safetensors: the tensor \"linear.bias\" holds"));
  }
}

}  // namespace state_dict_test

// Outputs, gradient penalty and all gradients against files written by PyTorch (see README.md).
#include <doctest/doctest.h>

#include <filesystem>

#include "compare.hpp"

namespace golden_test {

using namespace motiongan;

TEST_CASE("models agree with PyTorch" * doctest::test_suite("double")) {
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(MOTIONGAN_SOURCE_DIR "/tests/golden")) {
    if (entry.path().extension() != ".safetensors") continue;
    const golden::Report r = golden::compare(entry.path());
    CAPTURE(entry.path().string());
    CAPTURE(r.worst_name);
    CHECK(r.worst <= r.tolerance);
    CHECK(r.outputs > 0);
    CHECK(r.gradients >= 6);
    ++files;
  }
  CHECK(files >= 22);
}

TEST_CASE("a wrong value in a golden file is detected" * doctest::test_suite("double")) {
  io::SafeTensors file =
      io::SafeTensors::read(MOTIONGAN_SOURCE_DIR "/tests/golden/cnn_critic_dense_f64.safetensors");
  std::vector<double> bias = file.at("grad.encode.bias").as<double>();
  bias[0] += 1e-3 * (1 + std::abs(bias[0]));
  file.tensors["grad.encode.bias"] = io::SafeTensor::of({bias.size()}, bias);
  const auto changed = std::filesystem::temp_directory_path() / "motiongan_changed_golden.safetensors";
  file.write(changed);
  const golden::Report r = golden::compare(changed);
  CHECK_FALSE(r.passed());
  CHECK(r.worst_name == "grad.encode.bias");
  std::filesystem::remove(changed);
}

}  // namespace golden_test

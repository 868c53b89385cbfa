// Models found by name: the list, the checksum, the weights in 16 bits.
#include "motiongan/models/shipped_models.hpp"

#include <doctest/doctest.h>

#include <fstream>

#include "../support/folders.hpp"
#include "../support/messages.hpp"
#include "../support/setting.hpp"
#include "../support/small_data.hpp"

namespace shipped_models_test {

using namespace motiongan;
using namespace motiongan::testing;
namespace fs = std::filesystem;

namespace {

void write(const fs::path& file, const std::string& text) { std::ofstream(file, std::ios::binary) << text; }

void list(const fs::path& folder, const std::string& name) {
  std::ofstream(folder / shipped_list, std::ios::app)
      << io::sha256_of(folder / (name + ".safetensors")) << "  " << name << ".safetensors\n";
}

}  // namespace

TEST_CASE("a model is found by its name, and its weights of 16 bits generate almost the same motion") {
  const Scratch folder;
  const Context context;
  Dvgan model(context, small_data().format, {.hidden = 16});
  model.save(folder.path / "walker.safetensors", StoredWeights::half);
  model.save(folder.path / "whole.safetensors");
  list(folder.path, "walker");
  const Setting here("MOTIONGAN_MODELS", ("/nowhere:" + folder.path.string()).c_str());

  CHECK(find_model("walker") == folder.path / "walker.safetensors");
  const Dvgan found = Dvgan::load(context, "walker");
  const auto a = model.generate_poses("a person walks", {.count = 2}),
             b = found.generate_poses("a person walks", {.count = 2});
  CHECK(a != b);  // rounded
  for (std::size_t m = 0; m < a.size(); ++m)
    for (std::size_t i = 0; i < a[m].size(); ++i) CHECK(a[m][i] == doctest::Approx(b[m][i]).epsilon(0.02));

  // Every weight is the nearest of 16 bits, in half the space.
  const io::SafeTensors half = io::SafeTensors::read(folder.path / "walker.safetensors"),
                        whole = io::SafeTensors::read(folder.path / "whole.safetensors");
  CHECK(half.metadata == whole.metadata);
  for (const auto& [name, tensor] : half.tensors) {
    CHECK(tensor.dtype == "F16");
    const auto x = tensor.as<double>(), y = whole.at(name).as<double>();
    for (std::size_t i = 0; i < x.size(); ++i)
      CHECK(std::abs(x[i] - y[i]) <= std::max(std::abs(y[i]) / 2048, std::ldexp(1.0, -25)));
  }
}

TEST_CASE("a path goes before a name, and names have neither folder nor extension") {
  const Scratch folder;
  write(folder.path / "m.safetensors", "model");
  list(folder.path, "m");
  const Setting here("MOTIONGAN_MODELS", folder.path.c_str());
  for (const char* path : {"./m", "m.safetensors", "some/m", ""}) CHECK(find_model(path) == fs::path(path));
  const fs::path before = fs::current_path();
  fs::current_path(folder.path);
  fs::create_directory("m");
  CHECK(find_model("m") == "m");
  fs::current_path(before);
  CHECK(find_model("m") == folder.path / "m.safetensors");
}

TEST_CASE("the first folder that has a name counts, and models are sorted by name") {
  const Scratch first, second;
  for (const char* name : {"box-b", "box-a"}) {
    write(first.path / (std::string(name) + ".safetensors"), name);
    list(first.path, name);
  }
  for (const char* name : {"box-c", "box-a"}) {
    write(second.path / (std::string(name) + ".safetensors"), "other");
    list(second.path, name);
  }
  const Setting here("MOTIONGAN_MODELS", (first.path.string() + ":" + second.path.string()).c_str());
  std::vector<std::string> names;
  for (const ShippedModel& model : shipped_models())
    if (model.name.starts_with("box-")) names.push_back(model.name);  // others are this system's
  CHECK(names == std::vector<std::string>{"box-a", "box-b", "box-c"});
  CHECK(find_model("box-a") == first.path / "box-a.safetensors");
  CHECK(find_model("box-c") == second.path / "box-c.safetensors");
}

TEST_CASE("a damaged file, a missing one, an unknown name and a wrong list are errors that say what to do") {
  const Scratch folder;
  write(folder.path / "m.safetensors", "model");
  list(folder.path, "m");
  const Setting here("MOTIONGAN_MODELS", folder.path.c_str());

  std::string message = message_of([] { find_model("nobody"); });
  for (const char* part : {"no file or folder \"nobody\"", "the shipped models are ", "m"})
    CHECK(says(message, part));

  write(folder.path / "m.safetensors", "mo del");
  message = message_of([] { find_model("m"); });
  CHECK(says(message, (folder.path / "m.safetensors").string() + ": the SHA-256 is " + io::sha256("mo del")));
  CHECK(says(message, "expected " + io::sha256("model")));

  fs::remove(folder.path / "m.safetensors");
  CHECK(says(message_of([] { find_model("m"); }), "is not there"));

  for (const char* line :
       {"abc  m.safetensors", "m.safetensors",
        "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855  ../m.safetensors",
        "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855  m.txt",
        "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"}) {
    write(folder.path / shipped_list, std::string("\n") + line + "\n");
    CHECK(says(message_of([] { shipped_models(); }), std::string(shipped_list) + ":2: found \"" + line));
  }
}

TEST_CASE("what cannot be held in 16 bits is refused") {
  const auto halves = [](std::vector<float> values) {
    return io::SafeTensor::of({values.size()}, values).as_half().as<float>();
  };
  CHECK(halves({65504, -65519, 0, -0.0f}) == std::vector<float>{65504, -65504, 0, -0.0f});
  CHECK(says(message_of([&] { halves({1, 65520}); }), "65520"));
}

}  // namespace shipped_models_test

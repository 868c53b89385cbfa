// DVGAN models: reproducible generation and model files.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <limits>

#include "../support/small_data.hpp"

namespace dvgan_test {

using namespace motiongan;
using namespace motiongan::testing;

namespace {

using Poses = std::vector<std::vector<float>>;
constexpr const char* caption = "a person walks";

const Context& context() {
  static const Context c;
  return c;
}

Dvgan made(const DvganOptions& options = {.hidden = 16}) {
  return Dvgan(context(), small_data().format, options);
}

std::filesystem::path scratch(const char* name) {
  return std::filesystem::temp_directory_path() /
         (std::string("motiongan_dvgan_test_") + name + ".safetensors");
}

/// The error of load() for a model file after `change`.
std::string refusal(const std::function<void(io::SafeTensors&)>& change) {
  const auto path = scratch("changed");
  made().save(path);
  io::SafeTensors file = io::SafeTensors::read(path);
  change(file);
  file.write(path);
  const std::string text = message_of([&] { Dvgan::load(context(), path); });
  if (text != "no error") CHECK(says(text, path.string() + ": "));
  std::filesystem::remove(path);
  return text;
}

}  // namespace

TEST_CASE("a sample is the same alone, in a batch, and across batches of 64") {
  const Dvgan model = made();
  const Poses all = model.generate_poses(caption, {.count = 67, .seed = 5});
  REQUIRE(all.size() == 67);
  for (std::size_t i : {0, 2, 63, 64, 66}) {
    CAPTURE(i);
    CHECK(model.generate_poses(caption, {.count = 1, .seed = 5, .first_sample = i})[0] == all[i]);
  }
  CHECK(model.generate_poses(caption, {.count = 3, .seed = 5}) == Poses(all.begin(), all.begin() + 3));
}

TEST_CASE("motion depends on seed, sample and caption, and is the same for the same ones") {
  const Dvgan model = made();
  const Poses a = model.generate_poses(caption, {.count = 2, .seed = 1});
  CHECK(model.generate_poses(caption, {.count = 2, .seed = 1}) == a);
  CHECK(a[0] != a[1]);
  CHECK(model.generate_poses(caption, {.count = 2, .seed = 2})[0] != a[0]);
  const auto& words = model.format().vocabulary.words();
  REQUIRE(words.size() > 3);
  CHECK(model.generate_poses(words[2], {})[0] != model.generate_poses(words[3], {})[0]);
  CHECK(made({.hidden = 16, .seed = 2}).generate_poses(caption, {})[0] !=
        made().generate_poses(caption, {})[0]);
}

TEST_CASE("a caption may have unknown words, but not no words") {
  const Dvgan model = made();
  CHECK(model.generate_poses("zyxwv", {}) == model.generate_poses("qqqqq", {}));
  CHECK(says(message_of([&] { model.generate("", {}); }), "has no words"));
  CHECK(says(message_of([&] { model.generate(" !? ", {}); }), "has no words"));
}

TEST_CASE("motions have the frames, rate and skeleton of the format") {
  const Dvgan model = made();
  const std::vector<motion::Motion> motions = model.generate(caption, {.count = 2});
  REQUIRE(motions.size() == 2);
  for (const motion::Motion& m : motions) {
    CHECK(m.frames == 8);
    CHECK(m.rate == 4);
    CHECK(m.skeleton.size() == small_data().format.skeleton().size());
    for (const auto& p : m.positions) CHECK(std::isfinite(p[0] + p[1] + p[2]));
  }
  CHECK(model.generate(caption, {.count = 0}).empty());
}

TEST_CASE("a loaded model generates the same motion bit for bit") {
  for (const DvganOptions& options :
       {DvganOptions{.hidden = 16}, DvganOptions{.hidden = 8, .final_cut = false},
        DvganOptions{.hidden = 8, .taps = 5, .seed = 4}}) {
    Dvgan model = made(options);
    const auto path = scratch("round");
    model.save(path);
    Dvgan loaded = Dvgan::load(context(), path);
    CHECK(all_values(loaded) == all_values(model));
    CHECK(loaded.generate_poses(caption, {.count = 3, .seed = 9}) ==
          model.generate_poses(caption, {.count = 3, .seed = 9}));
    CHECK(loaded.options().taps == options.taps);
    CHECK(loaded.options().cuts() == options.cuts());
    CHECK(loaded.format().vocabulary.words() == model.format().vocabulary.words());
    CHECK(loaded.format().normalizer.mean() == model.format().normalizer.mean());
    const auto again = scratch("again");
    loaded.save(again);
    CHECK(io::SafeTensors::read(again).tensors == io::SafeTensors::read(path).tensors);
    CHECK(io::SafeTensors::read(again).metadata == io::SafeTensors::read(path).metadata);
    std::filesystem::remove(path);
    std::filesystem::remove(again);
  }
}

TEST_CASE("with and without final cut") {
  const Dvgan with = made({.hidden = 8, .final_cut = true}),
              without = made({.hidden = 8, .final_cut = false});
  CHECK(with.cnn().levels() == 4);  // generates 16 frames, keeps 8
  CHECK(without.cnn().levels() == 3);
  CHECK(without.cnn().cuts(context(), {}, 4).empty());
  const RandomKey key{.seed = 6};
  for (cl_int cut : with.cnn().cuts(context(), key, 500).to_host()) {
    CHECK(cut >= 0);
    CHECK(cut <= 8);
  }
}

TEST_CASE("the RNN generator: any number of frames, the same alone, in a batch and after loading") {
  Dvgan model = made({.generator = GeneratorKind::rnn, .hidden = 12});
  CHECK_FALSE(model.options().cuts());
  const Poses all = model.generate_poses(caption, {.count = 66, .seed = 5});
  CHECK(all[65] == model.generate_poses(caption, {.count = 1, .seed = 5, .first_sample = 65})[0]);
  const Poses longer = model.generate_poses(caption, {.count = 2, .seed = 5, .frames = 150});
  REQUIRE(longer[1].size() == 150 * model.format().dof());
  CHECK(std::equal(all[1].begin(), all[1].end(), longer[1].begin()));  // begins with the short one
  CHECK(model.generate(caption, {.frames = 1})[0].frames == 1);
  const auto path = scratch("rnn");
  model.save(path);
  Dvgan loaded = Dvgan::load(context(), path);
  CHECK(loaded.is_recurrent());
  CHECK(all_values(loaded) == all_values(model));
  CHECK(loaded.generate_poses(caption, {.count = 2, .seed = 5, .frames = 150}) == longer);
  std::filesystem::remove(path);
}

TEST_CASE("the RNN generator with final cut: a part of the longer motion in training, else after a warm-up") {
  const Dvgan model = made({.generator = GeneratorKind::rnn, .hidden = 12, .final_cut = true});
  const std::size_t dof = model.format().dof(), frames = model.format().frames;
  const RandomKey key{.seed = 2};
  const Sentences text(context(), std::vector<std::vector<int>>(3, model.format().vocabulary.encode(caption)),
                       model.format().vocabulary.size());
  const NoGrad values_only;
  const std::vector<float> whole =  // [3 frames, 3, dof]
      model.rnn()(text, model.rnn().noise(context(), key, 3, 3 * frames)).value().to_host();
  const auto check_part = [&](const std::vector<float>& motion, std::size_t sample, std::size_t from) {
    for (std::size_t f = 0; f < motion.size() / dof; ++f)
      CHECK(std::equal(motion.begin() + static_cast<long>(f * dof),
                       motion.begin() + static_cast<long>((f + 1) * dof),
                       whole.begin() + static_cast<long>(((from + f) * 3 + sample) * dof)));
  };
  const std::vector<float> trained = model.forward(text, key).value().to_host();  // [frames, 3, dof]
  const Poses usual = model.generate_poses(caption, {.count = 3, .seed = 2}),
              longer = model.generate_poses(caption, {.count = 3, .seed = 2, .frames = 2 * frames});
  const std::vector<cl_int> at = model.rnn().cuts(context(), key, 3).to_host();
  for (std::size_t i = 0; i < 3; ++i) {
    std::vector<float> cut;
    for (std::size_t f = 0; f < frames; ++f)
      cut.insert(cut.end(), trained.begin() + static_cast<long>((f * 3 + i) * dof),
                 trained.begin() + static_cast<long>((f * 3 + i + 1) * dof));
    check_part(cut, i, static_cast<std::size_t>(at[i]));
    REQUIRE(usual[i].size() == frames * dof);
    REQUIRE(longer[i].size() == 2 * frames * dof);
    check_part(usual[i], i, frames);
    check_part(longer[i], i, frames);
  }
}

TEST_CASE("the leak of an RNN generator is kept in its file; a file without one has none") {
  const Dvgan plain = made({.generator = GeneratorKind::rnn, .hidden = 12});
  Dvgan leaky = made({.generator = GeneratorKind::rnn, .hidden = 12, .leak = 0.125});
  const Poses motion = leaky.generate_poses(caption, {.seed = 5});
  CHECK(motion != plain.generate_poses(caption, {.seed = 5}));
  const auto path = scratch("leak");
  leaky.save(path);
  CHECK(Dvgan::load(context(), path).generate_poses(caption, {.seed = 5}) == motion);
  io::SafeTensors file = io::SafeTensors::read(path);
  file.metadata["options"] = R"({"final_cut":false,"hidden":12})";
  file.write(path);
  CHECK(Dvgan::load(context(), path).options().leak == 0);
  CHECK(Dvgan::load(context(), path).generate_poses(caption, {.seed = 5}) ==
        plain.generate_poses(caption, {.seed = 5}));
  std::filesystem::remove(path);
  CHECK(message_of([&] { made({.generator = GeneratorKind::rnn, .leak = 1}); }) ==
        "leak is 1, expected 0 to 0.99");
}

TEST_CASE("the error for what only an RNN generator can do says what to use") {
  const Dvgan model = made();
  for (const std::string& text :
       {message_of([&] { model.rnn(); }), message_of([&] { model.generate(caption, {.frames = 20}); })}) {
    CHECK(says(text, "CNN generator"));
    CHECK(says(text, "--generator rnn"));
  }
  CHECK(model.generate(caption, {.frames = model.format().frames}).size() == 1);
  CHECK(
      says(message_of([] { made({.generator = GeneratorKind::rnn, .hidden = 8}).cnn(); }), "RNN generator"));
}

TEST_CASE("invalid sizes are refused") {
  motion::MotionFormat format = small_data().format;
  format.frames = 33;
  const std::string text = message_of([&] { Dvgan(context(), format, {.hidden = 8}); });
  CHECK(says(text, "33"));
  CHECK(says(text, "32 and 64"));
  CHECK(says(message_of([] { made({.hidden = 0}); }), "hidden is 0, expected 1 to 65536"));
  CHECK(says(message_of([] { made({.hidden = 8, .taps = 4}); }), "taps is 4"));
}

TEST_CASE("files without this model are refused, naming the file and the problem") {
  CHECK(refusal([](auto&) {}) == "no error");
  CHECK(says(refusal([](auto& f) { f.metadata.clear(); }), "not a motiongan model"));
  CHECK(says(refusal([](auto& f) { f.metadata["motiongan_model"] = "ranker"; }), "\"ranker\""));
  CHECK(says(refusal([](auto& f) { f.metadata.erase("format"); }), "the model has no motion format"));
  CHECK(says(refusal([](auto& f) { f.metadata["format"] = "{\"frames\": 8"; }),
             "the motion format: cannot be read"));
  CHECK(says(
      refusal([](auto& f) { f.metadata["options"] = R"({"hidden": 16, "taps": 4, "final_cut": true})"; }),
      "taps is 4, expected 3 or 5"));
  CHECK(says(
      refusal([](auto& f) { f.metadata["options"] = R"({"hidden": 32, "taps": 3, "final_cut": true})"; }),
      "has shape"));
  CHECK(says(
      refusal([](auto& f) { f.metadata["options"] = R"({"hidden": -1, "taps": 3, "final_cut": true})"; }),
      "\"hidden\" is -1, expected a whole number of at least 0"));
  CHECK(says(refusal([](auto& f) { f.tensors.erase("decode.bias"); }), "\"decode.bias\""));
  CHECK(says(refusal([](auto& f) {
               f.tensors["decode.bias"] = io::SafeTensor::of(
                   f.at("decode.bias").shape,
                   std::vector<float>(f.at("decode.bias").count(), std::numeric_limits<float>::quiet_NaN()));
             }),
             "\"decode.bias\" holds"));
}

TEST_CASE("options cannot claim a network or a window that the file has no numbers for") {
  const auto with = [](const char* part, const std::string& from, const std::string& to) {
    return refusal([&](io::SafeTensors& file) {
      std::string& text = file.metadata.at(part);
      const std::size_t at = text.find(from);
      REQUIRE(at != std::string::npos);
      text.replace(at, from.size(), to);
    });
  };
  CHECK(with("options", "\"hidden\":16", "\"hidden\":16") == "no error");
  // Gigabytes, which were allocated before the shapes were compared.
  CHECK(says(with("options", "\"hidden\":16", "\"hidden\":65536"), "far more numbers than the file holds"));
  CHECK(says(with("options", "\"hidden\":16", "\"hidden\":32"), "\" has shape "));
  const std::string frames = "\"frames\":" + std::to_string(small_data().format.frames);
  CHECK(says(with("format", frames, "\"frames\":1099511627776"),
             "windows of 1099511627776 frames, expected 1 to 65536"));
}

TEST_CASE("a file truncated at any point is refused by name") {
  const auto path = scratch("short");
  for (const double share : {0.0, 0.001, 0.1, 0.9, 0.9999}) {
    made().save(path);
    const auto size = static_cast<double>(std::filesystem::file_size(path));
    std::filesystem::resize_file(path, static_cast<std::uintmax_t>(size * share));
    CAPTURE(share);
    CHECK(says(message_of([&] { Dvgan::load(context(), path); }), path.string() + ": "));
  }
  std::ofstream(path) << "this is text, not a model";
  CHECK(says(message_of([&] { Dvgan::load(context(), path); }), path.string() + ": "));
  std::filesystem::remove(path);
  CHECK(says(message_of([&] { Dvgan::load(context(), path); }), path.string() + ": no such file"));
}

}  // namespace dvgan_test

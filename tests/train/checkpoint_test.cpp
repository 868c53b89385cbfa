// Checkpoints: a resumed run equals an uninterrupted one bit for bit; a bad file changes nothing.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <motiongan/train/train.hpp>

#include "../support/folders.hpp"
#include "../support/small_data.hpp"

namespace checkpoint_test {

using namespace motiongan;
using namespace motiongan::testing;
namespace fs = std::filesystem;

namespace {

// With what a resumed run has to compute again: the schedule's rate, the critic's view, the losses' floor.
const DvganTrainOptions small_options{.iterations = 6,
                                      .critic_steps = 2,
                                      .batch = 3,
                                      .adam = {.schedule = {.shape = LearningSchedule::cosine}},
                                      .critic = {.sees = CriticSees::both},
                                      .body = {.smooth = 0.5}};

struct Run {
  Context context;
  Dvgan model;
  DvganTrainer trainer;
  explicit Run(const DvganTrainOptions& options = small_options, std::size_t frames = 8,
               std::size_t hidden = 8, GeneratorKind generator = GeneratorKind::cnn)
      : model(context, small_data(frames).format, {.generator = generator, .hidden = hidden}),
        trainer(model, small_data(frames), options) {}

  void iterate(std::size_t until) {
    while (trainer.iteration() < until) trainer.iterate();
  }
  /// Everything that training changes.
  std::vector<std::vector<float>> state() {
    std::vector<std::vector<float>> all = all_values(model);
    for (auto& values : all_values(trainer.critic())) all.push_back(std::move(values));
    for (Adam* adam : {&trainer.generator_adam(), &trainer.critic_adam()}) {
      all.push_back(adam->mean().to_host());
      all.push_back(adam->square().to_host());
      all.push_back({static_cast<float>(adam->steps())});
    }
    if (const WeightMean* mean = trainer.parts()[0].mean) {
      all.push_back(mean->values().to_host());
      all.push_back({static_cast<float>(mean->steps())});
    }
    all.push_back({static_cast<float>(trainer.iteration())});
    return all;
  }
};

/// The error of load_checkpoint() for a checkpoint after `change`; the trainer must be unchanged.
std::string refusal(const std::function<void(io::SafeTensors&)>& change) {
  const Scratch scratch;
  const fs::path path = scratch.path / "checkpoint.safetensors";
  Run run;
  run.iterate(1);
  save_checkpoint(run.trainer, path);
  io::SafeTensors file = io::SafeTensors::read(path);
  change(file);
  file.write(path);
  run.iterate(2);
  const auto before = run.state();
  const std::string text = message_of([&] { load_checkpoint(run.trainer, path); });
  if (text != "no error") {
    CHECK(says(text, path.string() + ": "));
    CHECK(run.state() == before);
  }
  return text;
}

}  // namespace

TEST_CASE("a run that is stopped at any iteration and resumed equals an uninterrupted one") {
  const Scratch scratch;
  const fs::path path = scratch.path / "checkpoint.safetensors";
  Run unbroken;
  unbroken.iterate(6);
  const auto expected = unbroken.state();
  for (const std::vector<std::size_t>& stops : {std::vector<std::size_t>{1}, {3}, {5}, {0, 2, 4}}) {
    for (std::size_t i = 0; i <= stops.size(); ++i) {
      Run run;
      if (i > 0) load_checkpoint(run.trainer, path);
      run.iterate(i < stops.size() ? stops[i] : 6);
      save_checkpoint(run.trainer, path);
      if (i == stops.size()) CHECK(run.state() == expected);
    }
  }
  Run elsewhere;
  elsewhere.iterate(5);
  CHECK(elsewhere.state() != expected);
}

TEST_CASE("the running mean of the weights generates; those after the last step are in the checkpoint") {
  const Scratch scratch;
  const fs::path path = scratch.path / "checkpoint.safetensors";
  Run run;
  save_checkpoint(run.trainer, path);  // no step yet, and no mean
  CHECK(Dvgan::load(run.context, path).options().hidden == 8);
  run.iterate(4);
  save_checkpoint(run.trainer, path);
  const auto raw = all_values(run.model);
  Dvgan by_default = Dvgan::load(run.context, path), last = Dvgan::load(run.context, path, WeightSource::raw);
  CHECK(all_values(last) == raw);
  CHECK(all_values(by_default) != raw);
  use_means(run.trainer);
  CHECK(all_values(by_default) == all_values(run.model));
  by_default.save(scratch.path / "mean.safetensors");
  CHECK(says(
      message_of([&] { Dvgan::load(run.context, scratch.path / "mean.safetensors", WeightSource::raw); }),
      "is no checkpoint"));

  io::SafeTensors old = io::SafeTensors::read(path);  // of a version without means
  std::erase_if(old.tensors, [](const auto& tensor) { return tensor.first.starts_with("mean."); });
  std::erase_if(old.metadata, [](const auto& entry) { return entry.first.starts_with("mean."); });
  old.write(path);
  Run resumed;
  load_checkpoint(resumed.trainer, path);
  CHECK(resumed.trainer.parts()[0].mean->steps() == 0);
  CHECK(all_values(resumed.model) == raw);
  Dvgan without = Dvgan::load(run.context, path);
  CHECK(all_values(without) == raw);

  DvganTrainOptions options = small_options;
  options.ema = 0;
  Run plain(options);
  plain.iterate(4);
  CHECK(plain.trainer.parts()[0].mean == nullptr);
  CHECK(all_values(plain.model) == raw);  // training itself is the same
}

TEST_CASE("the recurrent networks resume as well, but not from another model's checkpoint") {
  const Scratch scratch;
  const fs::path path = scratch.path / "checkpoint.safetensors";
  DvganTrainOptions options = small_options;
  options.critic.critic = CriticKind::rnn;
  const auto fresh = [&] { return Run(options, 8, 8, GeneratorKind::rnn); };
  Run unbroken = fresh(), first = fresh(), second = fresh();
  unbroken.iterate(4);
  first.iterate(2);
  save_checkpoint(first.trainer, path);
  load_checkpoint(second.trainer, path);
  second.iterate(4);
  CHECK(second.state() == unbroken.state());
  Run other_critic(small_options, 8, 8, GeneratorKind::rnn), other_generator(options);
  CHECK(says(message_of([&] { load_checkpoint(other_critic.trainer, path); }), "critic = \"rnn\""));
  CHECK(says(message_of([&] { load_checkpoint(other_generator.trainer, path); }), "another model"));
}

TEST_CASE("an option missing from a checkpoint has its default") {
  const auto drop = [](const std::string& key) {
    return refusal([&](io::SafeTensors& file) {
      auto options = nlohmann::json::parse(file.metadata.at("training"));
      REQUIRE(options.erase(key) == 1);
      file.metadata["training"] = options.dump();
    });
  };
  CHECK(drop("diff_input") == "no error");
  CHECK(says(drop("batch"), "batch = 64, now it is 3"));
}

TEST_CASE("saving changes nothing, and saving a loaded run writes the same contents") {
  const Scratch scratch;
  Run run;
  run.iterate(2);
  const auto before = run.state();
  save_checkpoint(run.trainer, scratch.path / "a");
  CHECK(run.state() == before);
  Run other;
  load_checkpoint(other.trainer, scratch.path / "a");
  CHECK(other.state() == before);
  save_checkpoint(other.trainer, scratch.path / "b");
  const io::SafeTensors a = io::SafeTensors::read(scratch.path / "a"),
                        b = io::SafeTensors::read(scratch.path / "b");
  CHECK(a.tensors == b.tensors);
  CHECK(a.metadata == b.metadata);
  CHECK(a.metadata.at("iteration") == "2");
  CHECK(a.metadata.at("adam.generator.steps") == "2");
  CHECK(a.metadata.at("adam.critic.steps") == "4");
}

TEST_CASE("a model loaded from a checkpoint generates the same motion") {
  const Scratch scratch;
  Run run;
  run.iterate(2);
  save_checkpoint(run.trainer, scratch.path / "a");
  const Dvgan last = Dvgan::load(run.context, scratch.path / "a", WeightSource::raw),
              loaded = Dvgan::load(run.context, scratch.path / "a");
  const GenerateOptions three{.count = 3, .seed = 5};
  CHECK(last.generate_poses("walk", three) == run.model.generate_poses("walk", three));
  use_means(run.trainer);
  CHECK(loaded.generate_poses("walk", three) == run.model.generate_poses("walk", three));
}

TEST_CASE("train() stopped and resumed gives the files, log and parameters of an uninterrupted run") {
  const Scratch scratch;
  const auto run_once = [](const fs::path& folder, bool resume, std::size_t stop_after) {
    const Context context;
    Dvgan model(context, small_data().format, {.hidden = 8});
    std::size_t count = 0;
    return train(
        model, small_data(), small_options,
        {.save_dir = folder, .resume = resume, .should_stop = [&] { return ++count >= stop_after; }});
  };
  const RunResult whole = run_once(scratch.path / "whole", false, 1000);
  CHECK(whole.iterations == 6);
  CHECK_FALSE(whole.stopped);
  const RunResult first = run_once(scratch.path / "parts", false, 2);
  CHECK(first.iterations == 2);
  CHECK(first.stopped);
  CHECK(run_once(scratch.path / "parts", true, 3).iterations == 5);
  CHECK(run_once(scratch.path / "parts", true, 1000).iterations == 6);
  for (const char* name : {"generator.safetensors", "critic.safetensors", "checkpoint.safetensors"}) {
    CAPTURE(name);
    CHECK(io::SafeTensors::read(scratch.path / "parts" / name).tensors ==
          io::SafeTensors::read(scratch.path / "whole" / name).tensors);
  }
  // The log contains each iteration once, with the same losses.
  const auto rows = [](const fs::path& path) {
    std::vector<std::string> losses;
    std::ifstream log(path);
    for (std::string line; std::getline(log, line);) {
      std::size_t at = 0;  // after iteration, seconds, iterations_per_second
      const std::string iteration = line.substr(0, line.find(','));
      for (int comma = 0; comma < 3; ++comma) at = line.find(',', at) + 1;
      losses.push_back(iteration + "," + line.substr(at));
    }
    return losses;
  };
  CHECK(rows(scratch.path / "whole" / "log.csv").size() == 7);
  CHECK(rows(scratch.path / "parts" / "log.csv") == rows(scratch.path / "whole" / "log.csv"));

  // A run killed before its first checkpoint leaves only a log. The same call starts again and renames it.
  fs::create_directories(scratch.path / "killed");
  std::ofstream(scratch.path / "killed" / "log.csv") << "iteration,seconds\n1,0.5\n";
  CHECK(run_once(scratch.path / "killed", false, 1000).iterations == 6);
  CHECK(rows(scratch.path / "killed" / "log.csv") == rows(scratch.path / "whole" / "log.csv"));
  CHECK(fs::file_size(scratch.path / "killed" / "log.unsaved.csv") == 24);

  CHECK(says(message_of([&] { run_once(scratch.path / "whole", false, 1); }), "already holds a run"));
  CHECK(says(message_of([&] { run_once(scratch.path / "new", true, 1); }), "no such file"));
}

TEST_CASE("options or data that differ from the first start are refused by name") {
  const Scratch scratch;
  const fs::path path = scratch.path / "checkpoint.safetensors";
  Run run;
  run.iterate(1);
  save_checkpoint(run.trainer, path);
  const auto refused = [&](const std::function<void(DvganTrainOptions&)>& change) {
    DvganTrainOptions options = small_options;
    change(options);
    Run other(options);
    return message_of([&] { load_checkpoint(other.trainer, path); });
  };
  CHECK(refused([](auto&) {}) == "no error");
  CHECK(refused([](auto& o) { o.iterations = 100; }) == "no error");  // iterations may change
  CHECK(says(refused([](auto& o) { o.critic_steps = 5; }), "started with critic_steps = 2, now it is 5"));
  CHECK(says(refused([](auto& o) { o.batch = 4; }), "batch = 3, now it is 4"));
  CHECK(says(refused([](auto& o) { o.lambda_gp = 1; }), "lambda_gp = 10"));
  CHECK(says(refused([](auto& o) { o.adam.learning_rate = 1; }), "learning_rate"));
  CHECK(says(refused([](auto& o) { o.adam.beta1 = 0; }), "beta1"));
  CHECK(says(refused([](auto& o) { o.adam.beta2 = 0; }), "beta2"));
  CHECK(says(refused([](auto& o) { o.adam.epsilon = 1; }), "epsilon"));
  CHECK(says(refused([](auto& o) { o.input_shift = false; }), "input_shift = true, now it is false"));
  CHECK(says(refused([](auto& o) { o.critic.validation = Validation::final; }), "validation"));
  CHECK(says(refused([](auto& o) { o.critic.level_weights = LevelWeights::softmax; }), "level_weights"));
  CHECK(says(refused([](auto& o) { o.seed = 9; }), "seed = 1, now it is 9"));
  Run longer(small_options, 16), wider(small_options, 8, 16);
  CHECK(says(message_of([&] { load_checkpoint(longer.trainer, path); }), "\"format\" differs"));
  CHECK(says(message_of([&] { load_checkpoint(wider.trainer, path); }), "the run was started with hidden ="));
}

TEST_CASE("a checkpoint with enums as numbers, as earlier versions wrote it, resumes to the same bits") {
  const Scratch scratch;
  const fs::path path = scratch.path / "checkpoint.safetensors";
  DvganTrainOptions options = small_options;
  options.critic = {.critic = CriticKind::rnn, .diff_input = DiffInput::difference};
  const auto fresh = [&] { return Run(options, 8, 8, GeneratorKind::rnn); };
  Run unbroken = fresh(), first = fresh(), second = fresh();
  unbroken.iterate(3);
  first.iterate(1);
  save_checkpoint(first.trainer, path);
  io::SafeTensors file = io::SafeTensors::read(path);
  auto training = nlohmann::json::parse(file.metadata.at("training"));
  CHECK(training.at("critic") == "rnn");
  CHECK(training.at("diff_input") == "difference");
  training["critic"] = training["diff_input"] = 1;
  training["validation"] = training["level_weights"] = 0;
  file.metadata["training"] = training.dump();
  file.metadata["options"] = R"({"final_cut":false,"hidden":8})";
  file.write(path);
  load_checkpoint(second.trainer, path);
  second.iterate(3);
  CHECK(second.state() == unbroken.state());
}

TEST_CASE("a damaged checkpoint is refused by name and changes nothing") {
  CHECK(refusal([](auto&) {}) == "no error");
  CHECK(says(refusal([](auto& f) { f.metadata.clear(); }), "not a motiongan model"));
  CHECK(says(refusal([](auto& f) { f.metadata["iteration"] = "2.5"; }), "\"iteration\" is \"2.5\""));
  CHECK(says(refusal([](auto& f) { f.metadata["adam.critic.steps"] = ""; }), "adam.critic.steps"));
  CHECK(says(refusal([](auto& f) { f.metadata["training"] = "[1, 2"; }), "cannot be read"));
  // These tensors are read last; those before them are valid.
  CHECK(says(refusal([](auto& f) { f.tensors.erase("adam.critic.square"); }), "\"adam.critic.square\""));
  CHECK(says(refusal([](auto& f) { f.tensors.erase("critic.level_weight"); }), "\"critic.level_weight\""));
  CHECK(says(refusal([](auto& f) { f.tensors["adam.critic.mean"].shape.push_back(1); }), "has shape"));
  CHECK(says(refusal([](auto& f) {
               const std::size_t n = f.at("adam.critic.mean").count();
               f.tensors["adam.critic.mean"] =
                   io::SafeTensor::of({n}, std::vector<float>(n, std::numeric_limits<float>::infinity()));
             }),
             "holds inf"));
}

TEST_CASE("a truncated checkpoint is refused and left unchanged") {
  const Scratch scratch;
  const fs::path path = scratch.path / "checkpoint.safetensors";
  Run run;
  save_checkpoint(run.trainer, path);
  const auto size = fs::file_size(path);
  for (const std::uintmax_t left : {size - 1, size / 2, std::uintmax_t{9}, std::uintmax_t{0}}) {
    fs::resize_file(path, left);
    const auto before = run.state();
    CHECK(says(message_of([&] { load_checkpoint(run.trainer, path); }), path.string() + ": "));
    CHECK(run.state() == before);
    CHECK(fs::file_size(path) == left);
  }
}

TEST_CASE("a run that diverged does not overwrite its last checkpoint") {
  const Scratch scratch;
  const fs::path path = scratch.path / "checkpoint.safetensors";
  Run run;
  run.iterate(1);
  save_checkpoint(run.trainer, path);
  const io::SafeTensors before = io::SafeTensors::read(path);
  Tensor bias = named_parameters(run.trainer.critic()).at(12).value->value();
  bias.write(
      std::span<const float>(std::vector<float>(bias.size(), std::numeric_limits<float>::quiet_NaN())));
  CHECK(says(message_of([&] { save_checkpoint(run.trainer, path); }), "\"critic.encode.bias\" holds"));
  CHECK(io::SafeTensors::read(path).tensors == before.tensors);
}

}  // namespace checkpoint_test

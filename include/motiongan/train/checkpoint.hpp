// A training run on disk: everything that the next iteration depends on, in one file.
#pragma once
#include <charconv>
#include <map>

#include "motiongan/train/dvgan_trainer.hpp"

namespace motiongan {

namespace detail {

inline nlohmann::json to_json(const DvganTrainOptions& o) {
  return {{"critic_steps", o.critic_steps},
          {"batch", o.batch},
          {"lambda_gp", o.lambda_gp},
          {"learning_rate", o.adam.learning_rate},
          {"beta1", o.adam.beta1},
          {"beta2", o.adam.beta2},
          {"epsilon", o.adam.epsilon},
          {"input_shift", o.input_shift},
          {"critic", static_cast<int>(o.critic.critic)},
          {"validation", static_cast<int>(o.critic.validation)},
          {"level_weights", static_cast<int>(o.critic.level_weights)},
          {"diff_input", static_cast<int>(o.critic.diff_input)},
          {"completion_share", o.completion_share},
          {"seed", o.seed}};
}

inline io::SafeTensor host_copy(const Tensor& t) {
  return t.context().precision() == Precision::f64 ? io::SafeTensor::of(t.shape(), t.to_host<double>())
                                                   : io::SafeTensor::of(t.shape(), t.to_host<float>());
}

/// A checkpoint's metadata `key`. Error where there is none; `where` names the file.
inline const std::string& checkpoint_text(const io::SafeTensors& file, const std::string& key,
                                          const std::string& where) {
  const auto found = file.metadata.find(key);
  require(found != file.metadata.end(), where, ": not a checkpoint of a training run (no \"", key,
          "\" in its metadata)");
  return found->second;
}

/// The same as a whole number.
inline std::size_t checkpoint_number(const io::SafeTensors& file, const std::string& key,
                                     const std::string& where) {
  const std::string& value = checkpoint_text(file, key, where);
  std::size_t n = 0;
  const auto [end, code] = std::from_chars(value.data(), value.data() + value.size(), n);
  require(code == std::errc() && end == value.data() + value.size(), where, ": \"", key, "\" is \"", value,
          "\", expected a whole number");
  return n;
}

}  // namespace detail

/// What the maker of a run wants to find again in its checkpoint, such as where the data came from.
using RunNotes = std::map<std::string, std::string>;

/// What a checkpoint says of its run without a device: how far it is, and the notes.
struct RunRecord {
  std::size_t iteration = 0;
  RunNotes notes;
};

inline RunRecord read_run_record(const io::SafeTensors& checkpoint, const std::string& where) {
  RunRecord record{detail::checkpoint_number(checkpoint, "iteration", where), {}};
  for (const auto& [key, value] : checkpoint.metadata)
    if (key.starts_with("note.")) record.notes[key.substr(5)] = value;
  return record;
}
inline RunRecord read_run_record(const std::filesystem::path& checkpoint) {
  return read_run_record(io::SafeTensors::read(checkpoint), checkpoint.string());
}

/// Writes the run's state: both networks, both optimisers, the position. Random numbers have no state: they
/// are named by seed and step. The file is written beside and renamed, so a run killed at any moment leaves
/// the last whole one.
inline void save_checkpoint(DvganTrainer& trainer, const std::filesystem::path& path,
                            const RunNotes& notes = {}) {
  io::SafeTensors file;
  trainer.model().describe(file);
  io::save_parameters(named_parameters(trainer.model()), file, "generator.");
  io::save_parameters(named_parameters(trainer.critic()), file, "critic.");
  for (const auto& [name, adam] :
       {std::pair{"generator", &trainer.generator_adam()}, std::pair{"critic", &trainer.critic_adam()}}) {
    file.tensors[concat("adam.", name, ".mean")] = detail::host_copy(adam->mean());
    file.tensors[concat("adam.", name, ".square")] = detail::host_copy(adam->square());
    file.metadata[concat("adam.", name, ".steps")] = std::to_string(adam->steps());
  }
  file.metadata["training"] = detail::to_json(trainer.options()).dump();
  file.metadata["iteration"] = std::to_string(trainer.iteration());
  for (const auto& [key, value] : notes) file.metadata["note." + key] = value;
  file.write(path);
}

/// Continues where save_checkpoint() left off, bit for bit as if the run had never stopped. The trainer must
/// have been made with the same options and data; an Error says what differs, and leaves the trainer as it
/// was.
inline void load_checkpoint(DvganTrainer& trainer, const std::filesystem::path& path) {
  const std::string where = path.string();
  const io::SafeTensors file = io::SafeTensors::read(path);
  const auto text = [&](const char* key) -> const std::string& {
    return detail::checkpoint_text(file, key, where);
  };
  io::SafeTensors expected;
  trainer.model().describe(expected);
  for (const char* key : {"motiongan_model", "options", "format"})
    require(text(key) == expected.metadata.at(key), where,
            ": the run was started with other data or another model (\"", key,
            "\" differs); give the options of ", "the first start, or another folder for a new run");
  // An option that is younger than the run had its default then.
  auto before = detail::to_json(DvganTrainOptions{});
  const auto then = nlohmann::json::parse(text("training"), nullptr, false),
             now = detail::to_json(trainer.options());
  require(then.is_object(), where, ": the training options cannot be read");
  before.update(then);
  for (const auto& [key, value] : now.items())
    require(before.at(key) == value, where, ": the run was started with ", key, " = ", before.at(key).dump(),
            ", now ", value.dump(), " is asked; give the same, or another folder for a new run");
  const std::size_t generator_steps = detail::checkpoint_number(file, "adam.generator.steps", where),
                    critic_steps = detail::checkpoint_number(file, "adam.critic.steps", where),
                    iteration = detail::checkpoint_number(file, "iteration", where);
  // All tensors in one list: when one of them is wrong, nothing has changed.
  Adam &generator = trainer.generator_adam(), &critic = trainer.critic_adam();
  std::array<Var, 4> moments{Var::constant(generator.mean()), Var::constant(generator.square()),
                             Var::constant(critic.mean()), Var::constant(critic.square())};
  ParameterList all;
  all.add_module("generator", trainer.model());
  all.add_module("critic", trainer.critic());
  all.add("adam.generator.mean", moments[0]);
  all.add("adam.generator.square", moments[1]);
  all.add("adam.critic.mean", moments[2]);
  all.add("adam.critic.square", moments[3]);
  io::load_parameters(all.items(), file, where);
  generator.set_steps(generator_steps);
  critic.set_steps(critic_steps);
  trainer.set_iteration(iteration);
}

}  // namespace motiongan

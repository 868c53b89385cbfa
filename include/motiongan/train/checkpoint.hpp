// A training run on disk: everything that the next iteration depends on, in one file.
#pragma once
#include <charconv>
#include <list>
#include <map>
#include <string>

#include "motiongan/train/trainer.hpp"

namespace motiongan {

namespace detail {

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

/// Writes the run's state: all networks, all optimizers, the position. Random numbers have no state: they are
/// named by seed and step. The file is written next to `path` and renamed, so a run killed at any moment leaves
/// the last whole one.
inline void save_checkpoint(Trainer& trainer, const std::filesystem::path& path, const RunNotes& notes = {}) {
  io::SafeTensors file;
  trainer.describe(file);
  for (const TrainedPart& part : trainer.parts()) {
    io::save_parameters(part.parameters, file, part.name + ".");
    const std::string prefix = concat(part.optimizer->name(), ".", part.name, ".");
    for (const auto& [name, tensor] : part.optimizer->state())
      file.tensors[prefix + name] = detail::host_copy(tensor);
    file.metadata[prefix + "steps"] = std::to_string(part.optimizer->steps());
  }
  file.metadata["iteration"] = std::to_string(trainer.iteration());
  for (const auto& [key, value] : notes) file.metadata["note." + key] = value;
  file.write(path);
}

/// Continues where save_checkpoint() left off, bit for bit as if the run had never stopped. The trainer must
/// have been made with the same options and data: Error says what differs, and leaves the trainer as it was.
inline void load_checkpoint(Trainer& trainer, const std::filesystem::path& path) {
  const std::string where = path.string();
  const io::SafeTensors file = io::SafeTensors::read(path);
  trainer.require_same_run(file, where);
  const std::size_t iteration = detail::checkpoint_number(file, "iteration", where);
  // All tensors in one list: when one of them is wrong, nothing has changed.
  const std::vector<TrainedPart> parts = trainer.parts();
  std::list<Var> state;
  std::vector<NamedParameter> all;
  std::vector<std::size_t> steps;
  for (const TrainedPart& part : parts) {
    for (const NamedParameter& p : part.parameters)
      all.push_back({part.name + "." + p.name, p.value, p.layout});
    const std::string prefix = concat(part.optimizer->name(), ".", part.name, ".");
    for (const auto& [name, tensor] : part.optimizer->state())
      all.push_back({prefix + name, &state.emplace_back(Var::constant(tensor))});
    steps.push_back(detail::checkpoint_number(file, prefix + "steps", where));
  }
  io::load_parameters(all, file, where);
  for (std::size_t i = 0; i < parts.size(); ++i) parts[i].optimizer->set_steps(steps[i]);
  trainer.set_iteration(iteration);
}

}  // namespace motiongan

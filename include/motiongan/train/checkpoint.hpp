// Checkpoints: the complete state of a training run in one safetensors file.
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

/// The value of `key` in a checkpoint's metadata. Throws Error if it is missing; `where` names the file.
inline const std::string& checkpoint_text(const io::SafeTensors& file, const std::string& key,
                                          const std::string& where) {
  const auto found = file.metadata.find(key);
  require(found != file.metadata.end(), where, ": not a checkpoint of a training run (no \"", key,
          "\" in its metadata)");
  return found->second;
}

/// The same, parsed as a whole number.
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

/// Key-value notes that a checkpoint carries for its owner, such as where the data came from.
using RunNotes = std::map<std::string, std::string>;

/// What can be read from a checkpoint without a device.
struct RunRecord {
  std::size_t iteration = 0;  ///< iterations done
  RunNotes notes;
};

/// Throws Error if the file is not a checkpoint; `where` names it.
inline RunRecord read_run_record(const io::SafeTensors& checkpoint, const std::string& where) {
  RunRecord record{detail::checkpoint_number(checkpoint, "iteration", where), {}};
  for (const auto& [key, value] : checkpoint.metadata)
    if (key.starts_with("note.")) record.notes[key.substr(5)] = value;
  return record;
}
/// read_run_record() of a checkpoint on disk.
inline RunRecord read_run_record(const std::filesystem::path& checkpoint) {
  return read_run_record(io::SafeTensors::read(checkpoint), checkpoint.string());
}

/// The state of a run: all networks, the optimizer states and the iteration. Random numbers have no state:
/// seed and step determine them. Throws DivergedError, naming the iteration and the tensor, if one is not
/// finite: such a checkpoint could not be resumed.
inline io::SafeTensors checkpoint_of(Trainer& trainer, const RunNotes& notes = {}) {
  io::SafeTensors file;
  trainer.describe(file);
  for (const TrainedPart& part : trainer.parts()) {
    io::add_parameters(part.parameters, file, part.name + ".");
    const std::string prefix = concat(part.optimizer->name(), ".", part.name, ".");
    for (const auto& [name, tensor] : part.optimizer->state())
      file.tensors[prefix + name] = detail::host_copy(tensor);
    file.metadata[prefix + "steps"] = std::to_string(part.optimizer->steps());
    if (part.mean == nullptr || part.mean->steps() == 0) continue;
    std::list<Var> means;
    io::add_parameters(part.mean->means_of(part.parameters, means), file, mean_part(part.name) + ".");
    file.metadata[mean_part(part.name) + ".steps"] = std::to_string(part.mean->steps());
  }
  if (const auto found = io::first_not_finite(file))
    throw DivergedError("training diverged by iteration ", trainer.iteration(), ": the tensor \"",
                        found->name, "\" holds ", found->value,
                        "; nothing is saved, try a lower learning rate");
  file.metadata["iteration"] = std::to_string(trainer.iteration());
  for (const auto& [key, value] : notes) file.metadata["note." + key] = value;
  return file;
}

/// Writes checkpoint_of(trainer, notes). The file is written next to `path` and renamed, so a run killed at
/// any moment leaves the previous checkpoint intact.
inline void save_checkpoint(Trainer& trainer, const std::filesystem::path& path, const RunNotes& notes = {}) {
  checkpoint_of(trainer, notes).write(path);
}

/// The tensors of one network in a checkpoint, under their names in the network.
inline io::SafeTensors part_of_checkpoint(const io::SafeTensors& checkpoint, const std::string& part) {
  io::SafeTensors out;
  const std::string prefix = part + ".";
  for (const auto& [name, tensor] : checkpoint.tensors)
    if (name.starts_with(prefix)) out.tensors[name.substr(prefix.size())] = tensor;
  return out;
}

/// Restores the state that checkpoint_of() gave; training then continues bit for bit as if it had never
/// stopped. Throws Error, naming what differs, if the trainer has other options or data; the trainer is then
/// unchanged. `where` names the file.
inline void restore_checkpoint(Trainer& trainer, const io::SafeTensors& file, const std::string& where) {
  trainer.require_same_run(file, where);
  const std::size_t iteration = detail::checkpoint_number(file, "iteration", where);
  // One list of all tensors, so that load_parameters() checks every one before it changes any.
  const std::vector<TrainedPart> parts = trainer.parts();
  std::list<Var> state;
  std::vector<NamedParameter> all;
  std::vector<std::size_t> steps, mean_steps;
  for (const TrainedPart& part : parts) {
    for (const NamedParameter& p : part.parameters)
      all.push_back({part.name + "." + p.name, p.value, p.layout});
    const std::string prefix = concat(part.optimizer->name(), ".", part.name, ".");
    for (const auto& [name, tensor] : part.optimizer->state())
      all.push_back({prefix + name, &state.emplace_back(Var::constant(tensor))});
    steps.push_back(detail::checkpoint_number(file, prefix + "steps", where));
    // A run of an earlier version has no means: they begin now.
    const std::string means = mean_part(part.name) + ".";
    const bool has_mean = part.mean != nullptr && file.metadata.contains(means + "steps");
    mean_steps.push_back(has_mean ? detail::checkpoint_number(file, means + "steps", where) : 0);
    if (has_mean)
      for (const NamedParameter& p : part.mean->means_of(part.parameters, state))
        all.push_back({means + p.name, p.value, p.layout});
  }
  io::load_parameters(all, file, where);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    parts[i].optimizer->set_steps(steps[i]);
    if (parts[i].mean != nullptr) parts[i].mean->set_steps(mean_steps[i]);
  }
  trainer.set_iteration(iteration);
}

/// restore_checkpoint() from a file.
inline void load_checkpoint(Trainer& trainer, const std::filesystem::path& path) {
  restore_checkpoint(trainer, io::SafeTensors::read(path), path.string());
}

}  // namespace motiongan

// Model files: weights and everything needed to use them in one safetensors file.
//
// The metadata contain "motiongan_model" (the kind of model), "options" and "format" (both JSON); a
// checkpoint contains the same and more. A model class that can be saved has
//   Options               a struct with list_fields()
//   Format                with read_format(text, where) and write_format(format), from and to JSON
//   file_kinds            the table of kind names, by an enum that is a member of Options
//   kind_of(options)      that member
//   part_name             the prefix of its tensors in a checkpoint
//   made_by               the command that trains one
// and may have write_extras(file) and read_extras(file, where), for what a model file holds beside these.
#pragma once
#include <filesystem>
#include <string>
#include <utility>

#include "motiongan/io/fields_json.hpp"
#include "motiongan/io/safetensors.hpp"
#include "motiongan/models/shipped_models.hpp"
#include "motiongan/nn/state_dict.hpp"

namespace motiongan {

namespace detail {
/// bfloat16() of a model whose network is one of several; some networks keep 16-bit weights themselves.
template <class... Networks>
void round_weights(std::variant<Networks...>& network) {
  std::visit(
      [](auto& n) {
        if constexpr (requires { n.bfloat16(); })
          n.bfloat16();
        else
          round_to_bf16(named_parameters(n));
      },
      network);
}
}  // namespace detail

/// Whether the file is a checkpoint of a training run.
inline bool is_checkpoint(const io::SafeTensors& file) { return file.metadata.contains("iteration"); }

/// The kind of model in a file, its "motiongan_model". Throws Error, naming the file, if it has none.
inline const std::string& model_kind(const io::SafeTensors& file, const std::string& where) {
  const auto found = file.metadata.find("motiongan_model");
  require(found != file.metadata.end(), where,
          ": not a motiongan model (no \"motiongan_model\" in its metadata)");
  return found->second;
}

/// Whether a model file or checkpoint contains a model of this class.
template <class Model>
bool holds_model(const io::SafeTensors& file) {
  const auto found = file.metadata.find("motiongan_model");
  if (found == file.metadata.end()) return false;
  for (const auto& [kind, name] : Model::file_kinds)
    if (found->second == name) return true;
  return false;
}

/// Adds the metadata of a model file: its kind, its options and its format.
template <class Model>
void describe_model(const Model& model, io::SafeTensors& file) {
  auto options = model.options();
  for (const auto& [kind, name] : Model::file_kinds)
    if (kind == Model::kind_of(options)) file.metadata["motiongan_model"] = name;
  file.metadata["options"] = io::fields_to_text(fields_of(options));
  file.metadata["format"] = Model::write_format(model.format());
}

/// The metadata of a model file, from those of a checkpoint.
inline std::map<std::string, std::string> model_metadata(const io::SafeTensors& checkpoint) {
  std::map<std::string, std::string> out;
  for (const char* key : {"motiongan_model", "options", "format"})
    if (const auto found = checkpoint.metadata.find(key); found != checkpoint.metadata.end())
      out.insert(*found);
  return out;
}

/// How the weights of a model file are stored.
enum class StoredWeights {
  whole,  ///< as they are
  half    ///< rounded to 16 bits (F16), in half the space; they are computed with as before
};

/// Writes the weights (PyTorch's names and shapes) and the metadata as one safetensors file.
template <class Model>
void save_model(Model& model, const std::filesystem::path& path,
                StoredWeights stored = StoredWeights::whole) {
  io::SafeTensors file;
  describe_model(model, file);
  io::save_parameters(named_parameters(model), file);
  if (stored == StoredWeights::half)
    for (auto& [name, tensor] : file.tensors) tensor = tensor.as_half();
  if constexpr (requires { model.write_extras(file); }) model.write_extras(file);
  file.write(path);
}

/// Reads the options from a file's metadata. Throws Error if the file contains a model of another class, or
/// if a value is out of range.
template <class Model>
typename Model::Options model_options(const io::SafeTensors& file, const std::string& where) {
  typename Model::Options options;
  const std::string& found = model_kind(file, where);
  std::string names;
  bool known = false;
  for (const auto& [kind, name] : Model::file_kinds) {
    names += (names.empty() ? "" : ", ") + std::string(name);
    if (found != name) continue;
    Model::kind_of(options) = kind;
    known = true;
  }
  require(known, where, ": holds a model called \"", found, "\", expected one of ", names, "; ",
          Model::made_by, " makes one");
  const auto text = file.metadata.find("options");
  require(text != file.metadata.end(), where, ": the model has no \"options\" in its metadata");
  const FieldList fields = fields_of(options);
  io::fields_from_text(fields, text->second, where + ": the model's options");
  try {
    fields.check();
  } catch (const Error& error) {
    throw Error(where, ": the model's options: ", error.what());
  }
  return options;
}

/// Reads the motion format from a file's metadata. Throws Error if it is missing or invalid.
template <class Model>
typename Model::Format model_format(const io::SafeTensors& file, const std::string& where) {
  const auto text = file.metadata.find("format");
  require(text != file.metadata.end(), where, ": the model has no motion format in its metadata");
  return Model::read_format(text->second, where);
}

/// Bounds the parameters of a model whose options are read from `file`, which may claim any size. Room is
/// left for load_parameters() to name the tensor that is missing or has another shape.
inline std::size_t most_parameters(const io::SafeTensors& file) {
  std::size_t n = 0;
  for (const auto& [name, tensor] : file.tensors) n += tensor.count();
  return 2 * n + 1'000'000;
}

/// The name of the running means of a network's weights in a checkpoint.
inline std::string mean_part(const std::string& part) { return "mean." + part; }

/// Which weights of a training run are loaded.
enum class WeightSource {
  mean,  ///< their running mean, where the run keeps one (see WeightMean): what generates best
  raw    ///< those after the last step; only a checkpoint holds them beside the mean
};

/// The model in the contents of a file that save_model() wrote, or of a checkpoint. Throws Error, naming the
/// file (`where`) and the problem, for any other contents, and for the last weights of a file that is not a
/// checkpoint.
template <class Model>
Model model_from(const Context& context, const io::SafeTensors& file, const std::string& where,
                 WeightSource source = WeightSource::mean) {
  const auto options = model_options<Model>(file, where);
  auto format = model_format<Model>(file, where);
  const bool in_checkpoint = is_checkpoint(file);
  require(
      source == WeightSource::mean || in_checkpoint, where,
      " is no checkpoint, which alone holds the weights after the last step; give the checkpoint of the run");
  std::string prefix = in_checkpoint ? std::string(Model::part_name) + "." : "";
  const std::string means = mean_part(prefix);
  const auto first = file.tensors.lower_bound(means);
  if (in_checkpoint && source == WeightSource::mean && first != file.tensors.end() &&
      first->first.starts_with(means))
    prefix = means;
  const ParameterLimit limit(most_parameters(file), where);
  Model model(context, std::move(format), options);
  io::load_parameters(named_parameters(model), file, where, prefix);
  if constexpr (requires { model.read_extras(file, where); }) model.read_extras(file, where);
  return model;
}

/// Loads a file, or a shipped model by its name (find_model()), as model_from().
template <class Model>
Model load_model(const Context& context, const std::filesystem::path& path,
                 WeightSource source = WeightSource::mean) {
  const std::filesystem::path file = find_model(path);
  return model_from<Model>(context, io::SafeTensors::read(file), file.string(), source);
}

}  // namespace motiongan

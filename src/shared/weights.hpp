// --weights: which weights of a model generate, and how precise they are.
#pragma once
#include <algorithm>

#include "motiongan/train/run_folder.hpp"
#include "shared/command.hpp"

namespace motiongan::command {

/// The words of --weights: mean or raw, f32 or bf16.
using Weights = std::vector<std::string>;

inline void add_weights_option(CLI::App& verb, Weights& weights) {
  verb.add_option(
          "--weights", weights,
          "which weights generate: mean, the running mean of a run's weights, or raw, those after its last "
          "step; f32, as trained, or bf16, rounded to 16 bits, which is faster for few motions of an RNN or "
          "attention model [mean,f32]")
      ->delimiter(',')
      ->check(CLI::IsMember({"mean", "raw", "f32", "bf16"}))
      ->type_name("mean|raw,f32|bf16");
}

/// The model in `file`, which is what model_file() found for `given`, with these weights.
template <class Model>
Model load_with(const Context& context, const fs::path& file, const fs::path& given, const Weights& weights) {
  const auto asks_for = [&](const char* word) {
    return std::find(weights.begin(), weights.end(), word) != weights.end();
  };
  require(!(asks_for("mean") && asks_for("raw")) && !(asks_for("f32") && asks_for("bf16")),
          "--weights: mean and raw, and f32 and bf16, exclude each other");
  const bool raw = asks_for("raw");
  Model model = Model::load(context, raw && fs::is_directory(given) ? RunFiles{given}.checkpoint() : file,
                            raw ? WeightSource::raw : WeightSource::mean);
  if (asks_for("bf16")) model.bfloat16();
  return model;
}

}  // namespace motiongan::command

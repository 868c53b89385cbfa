// The baselines of motion completion (SPEC 7.7): networks that go on from a prefix of normalised poses.
#pragma once
#include <nlohmann/json.hpp>
#include <span>
#include <variant>

#include "motiongan/io/safetensors.hpp"
#include "motiongan/nn/state_dict.hpp"
#include "motiongan/networks/erd.hpp"
#include "motiongan/networks/lstm_3lr.hpp"
#include "motiongan/networks/lstm_baseline.hpp"
#include "motiongan/networks/seq2seq.hpp"
#include "motiongan/ops/cross_entropy.hpp"

namespace motiongan {

enum class Predictor {
  lstm,     ///< one layer of LSTM, told the class, trained to copy the future
  seq2seq,  ///< one residual GRU, trained to copy the future
  erd,      ///< encoder, two layers of LSTM, decoder, trained one step ahead on noisy poses
  lstm_3lr  ///< three layers of LSTM, likewise
};

/// As it stands in files and tables.
inline const char* name_of(Predictor predictor) {
  switch (predictor) {
    case Predictor::lstm:
      return "lstm";
    case Predictor::seq2seq:
      return "seq2seq";
    case Predictor::erd:
      return "erd";
    default:
      return "lstm_3lr";
  }
}

/// Error, naming what there is, for any other name.
inline Predictor predictor_from(const std::string& name) {
  for (const Predictor p : {Predictor::lstm, Predictor::seq2seq, Predictor::erd, Predictor::lstm_3lr})
    if (name == name_of(p)) return p;
  throw Error("there is no predictor called '", name, "'; there are lstm, seq2seq, erd and lstm_3lr");
}

/// The width that the predictor has in its paper.
inline std::size_t usual_hidden(Predictor predictor) {
  return predictor == Predictor::lstm ? 256 : predictor == Predictor::seq2seq ? 1024 : 1000;
}

struct PredictionOptions {
  Predictor predictor = Predictor::seq2seq;
  std::size_t hidden = 0;  ///< 0: usual_hidden()
  bool labels = true;      ///< whether seq2seq sees the action; lstm always does, the other two never
  std::uint64_t seed = 1;  ///< of the first weights
};

/// Goes on from a prefix of poses.
class PredictionModel {
 public:
  PredictionModel(Context context, std::size_t dof, std::size_t action_count,
                  const PredictionOptions& options)
      : context_(std::move(context)),
        dof_(dof),
        action_count_(action_count),
        options_(with_hidden(options)),
        network_(make_network(context_, dof, action_count, options_)) {}

  const Context& context() const { return context_; }
  std::size_t dof() const { return dof_; }
  std::size_t action_count() const { return action_count_; }
  /// With the hidden size that it has.
  const PredictionOptions& options() const { return options_; }

  /// Parameters by PyTorch's names.
  void list_parameters(ParameterList& list) {
    std::visit([&](auto& network) { network.list_parameters(list); }, network_);
  }

  /// Whether it is trained one step ahead (next_poses) and not on what it makes by itself.
  bool one_step_ahead() const {
    return options_.predictor == Predictor::erd || options_.predictor == Predictor::lstm_3lr;
  }

  /// The `frames` poses [frames, B, dof] that follow the prefix [n, B, dof]; `actions` [B, Y] one-hot.
  Var make(const Var& prefix, const Var& actions, std::size_t frames) const {
    return std::visit(
        [&](const auto& network) -> Var {
          if constexpr (sees_actions<decltype(network)>)
            return network(prefix, actions, frames);
          else
            return network(prefix, frames);
        },
        network_);
  }

  /// What comes after each pose of x [T, B, dof]; Error for a model that is not trained so.
  Var next_poses(const Var& x) const {
    return std::visit(
        [&](const auto& network) -> Var {
          if constexpr (sees_actions<decltype(network)>) {
            throw Error("the predictor ", name_of(options_.predictor), " is not trained one step ahead");
          } else {
            LstmState state;
            return network.next_poses(x, state);
          }
        },
        network_);
  }

  /// The `frames` normalised poses, [frames, B, dof], that follow `prefixes` [n, B, dof] (both time-major);
  /// actions [B]. Error where the sizes do not fit.
  std::vector<float> predict(std::span<const float> prefixes, std::size_t batch,
                             std::span<const std::size_t> actions, std::size_t frames) const {
    require(batch > 0 && frames > 0, "predict: ", batch, " prefixes and ", frames,
            " frames to make, expected at least 1 of each");
    require(!prefixes.empty() && prefixes.size() % (batch * dof_) == 0, "predict: ", prefixes.size(),
            " numbers are no whole frames of ", batch, " poses of ", dof_, " numbers");
    require(actions.size() == batch, "predict: ", actions.size(), " actions for ", batch, " prefixes");
    const NoGrad off;
    const Tensor prefix = Tensor::from(context_, {prefixes.size() / batch / dof_, batch, dof_}, prefixes);
    return make(Var::constant(prefix), Var::constant(one_hot(context_, actions, action_count_)), frames)
        .value()
        .to_host();
  }

  /// Writes the weights (PyTorch's names and shapes) and the model's description as one safetensors file.
  void save(const std::filesystem::path& path) {
    io::SafeTensors file;
    describe(file);
    io::save_parameters(named_parameters(*this), file);
    file.write(path);
  }

  /// A model that save() wrote, or the one of a run's checkpoint. Throws, naming the file and what is wrong,
  /// for any other.
  static PredictionModel load(const Context& context, const std::filesystem::path& path) {
    const io::SafeTensors file = io::SafeTensors::read(path);
    PredictionModel model = from_description(context, file, path.string());
    const bool is_checkpoint = file.metadata.contains("iteration");
    io::load_parameters(named_parameters(model), file, path.string(), is_checkpoint ? "generator." : "");
    return model;
  }

  /// Adds the metadata of a model file: which model it is, its options and what it is for.
  void describe(io::SafeTensors& file) const {
    file.metadata["motiongan_model"] = concat(prefix_of_name, name_of(options_.predictor));
    file.metadata["options"] =
        nlohmann::json{{"hidden", options_.hidden}, {"labels", options_.labels}}.dump();
    file.metadata["format"] = nlohmann::json{{"dof", dof_}, {"actions", action_count_}}.dump();
  }

  /// A model, with fresh weights, as a file's metadata describe it.
  static PredictionModel from_description(const Context& context, const io::SafeTensors& file,
                                          const std::string& where) {
    const auto found = file.metadata.find("motiongan_model");
    require(found != file.metadata.end(), where,
            ": not a motiongan model (no \"motiongan_model\" in its metadata)");
    require(found->second.starts_with(prefix_of_name), where, ": holds a model called \"", found->second,
            "\", expected a predictor");
    try {
      PredictionOptions read;
      read.predictor = predictor_from(found->second.substr(std::string_view(prefix_of_name).size()));
      const auto options = nlohmann::json::parse(file.metadata.at("options")),
                 format = nlohmann::json::parse(file.metadata.at("format"));
      read.hidden = options.at("hidden").get<std::size_t>();
      read.labels = options.at("labels").get<bool>();
      const auto dof = format.at("dof").get<std::size_t>(), actions = format.at("actions").get<std::size_t>();
      require(read.hidden > 0 && read.hidden <= 65536 && dof <= 65536 && actions <= 65536, "hidden ",
              read.hidden, ", dof ", dof, " or actions ", actions, " is out of range");
      return PredictionModel(context, dof, actions, read);
    } catch (const Error& error) {
      throw Error(where, ": ", error.what());
    } catch (const std::exception& error) {  // nlohmann's own, and missing keys
      throw Error(where, ": the model's metadata cannot be read: ", error.what());
    }
  }

 private:
  using Network = std::variant<LstmBaseline, Seq2seq, Erd, Lstm3lr>;
  static constexpr const char* prefix_of_name = "predictor_";

  template <class N>
  static constexpr bool sees_actions =
      std::is_same_v<std::decay_t<N>, LstmBaseline> || std::is_same_v<std::decay_t<N>, Seq2seq>;

  static PredictionOptions with_hidden(PredictionOptions options) {
    if (options.hidden == 0) options.hidden = usual_hidden(options.predictor);
    return options;
  }

  static Network make_network(const Context& context, std::size_t dof, std::size_t actions,
                              const PredictionOptions& options) {
    require(dof > 0 && actions > 0, "PredictionModel: ", dof, " numbers a pose and ", actions,
            " actions, expected at least 1 of each");
    const Initializer init(context, options.seed);
    const std::size_t k = options.hidden;
    switch (options.predictor) {
      case Predictor::lstm:
        return LstmBaseline(init, {.dof = dof, .classes = actions, .hidden = k});
      case Predictor::seq2seq:
        return Seq2seq(init, {.dof = dof, .classes = options.labels ? actions : 0, .hidden = k});
      case Predictor::erd:
        return Erd(init, {.dof = dof, .hidden = k});
      default:
        return Lstm3lr(init, {.dof = dof, .hidden = k});
    }
  }

  Context context_;
  std::size_t dof_, action_count_;
  PredictionOptions options_;
  Network network_;
};

}  // namespace motiongan

// The motion-completion baselines (Lin & Amer, Table 3): networks that continue a prefix of normalised poses.
#pragma once
#include <span>
#include <variant>

#include "motiongan/core/fields.hpp"
#include "motiongan/models/model_file.hpp"
#include "motiongan/networks/erd.hpp"
#include "motiongan/networks/lstm_3lr.hpp"
#include "motiongan/networks/lstm_baseline.hpp"
#include "motiongan/networks/seq2seq.hpp"
#include "motiongan/ops/cross_entropy.hpp"

namespace motiongan {

/// The baseline network.
enum class Predictor {
  lstm,     ///< one-layer LSTM, conditioned on the action, trained by MSE on its own rollout
  seq2seq,  ///< residual GRU (Martinez, Black & Romero 2017), trained by MSE on its own rollout
  erd,      ///< encoder, two-layer LSTM, decoder (Fragkiadaki et al. 2015), one step ahead on noisy poses
  lstm_3lr  ///< three-layer LSTM (Fragkiadaki et al. 2015), likewise
};
constexpr NameTable<Predictor, 4> enum_names(Predictor) {
  return {{{Predictor::lstm, "lstm"},
           {Predictor::seq2seq, "seq2seq"},
           {Predictor::erd, "erd"},
           {Predictor::lstm_3lr, "lstm_3lr"}}};
}

/// The hidden width in the predictor's paper.
inline std::size_t usual_hidden(Predictor predictor) {
  return predictor == Predictor::lstm ? 256 : predictor == Predictor::seq2seq ? 1024 : 1000;
}

/// Options of a PredictionModel.
struct PredictionOptions {
  Predictor predictor = Predictor::seq2seq;  ///< which network predicts
  std::size_t hidden = 0;                    ///< hidden width; 0: usual_hidden()
  bool labels = true;      ///< whether seq2seq is given the action; lstm always is, the other two never
  std::uint64_t seed = 1;  ///< seed of the initial weights

  void list_fields(FieldList& list) {
    list.add(predictor, {.key = "predictor", .help = "which network", .saved = false});
    list.add(hidden, {.key = "hidden",
                      .help = "width; 0: that of its paper (lstm 256, seq2seq 1024, the others 1000)",
                      .range = Range::between(0, 65536)});
    list.add(labels, {.key = "labels", .help = "whether seq2seq is given the action"});
  }
};

/// The sizes of a prediction model's data: channels of a pose and number of actions.
struct PredictionFormat {
  std::size_t dof = 0, actions = 0;

  void list_fields(FieldList& list) {
    list.add(dof, {.key = "dof", .help = "channels of a pose", .range = Range::between(1, 65536)});
    list.add(actions, {.key = "actions", .help = "number of actions", .range = Range::between(1, 65536)});
  }
};

/// A baseline that continues a prefix of poses.
class PredictionModel {
 public:
  /// Throws Error if an option or a size is out of range.
  PredictionModel(Context context, const PredictionFormat& format, const PredictionOptions& options)
      : context_(std::move(context)),
        format_(format),
        options_(with_hidden(options)),
        network_(make_network(context_, format_, options_)) {}

  const Context& context() const { return context_; }
  const PredictionFormat& format() const { return format_; }
  std::size_t dof() const { return format_.dof; }
  std::size_t action_count() const { return format_.actions; }
  /// The options, with the actual hidden width instead of 0.
  const PredictionOptions& options() const { return options_; }

  /// The parameters, under PyTorch's names.
  void list_parameters(ParameterList& list) {
    std::visit([&](auto& network) { network.list_parameters(list); }, network_);
  }

  /// Whether it is trained one step ahead (next_poses()) instead of on its own rollout (forward()).
  bool one_step_ahead() const {
    return options_.predictor == Predictor::erd || options_.predictor == Predictor::lstm_3lr;
  }

  /// The next `frames` poses [frames, B, dof] after a prefix [n, B, dof]; `actions` [B, Y] one-hot.
  Var forward(const Var& prefix, const Var& actions, std::size_t frames) const {
    return std::visit(
        [&](const auto& network) -> Var {
          if constexpr (sees_actions<decltype(network)>)
            return network(prefix, actions, frames);
          else
            return network(prefix, frames);
        },
        network_);
  }

  /// The prediction of the pose after each pose of x [T, B, dof]: [T, B, dof]. Throws Error unless
  /// one_step_ahead().
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

  /// The next `frames` poses [frames, B, dof] after `prefixes` [n, B, dof], both normalised and time-major;
  /// `actions` [B]. Throws Error if the sizes do not fit.
  std::vector<float> predict(std::span<const float> prefixes, std::size_t batch,
                             std::span<const std::size_t> actions, std::size_t frames) const {
    require(batch > 0 && frames > 0, "predict: batch is ", batch, " and frames is ", frames,
            ", expected at least 1 of each");
    require(!prefixes.empty() && prefixes.size() % (batch * dof()) == 0, "predict: prefixes has ",
            prefixes.size(), " values, expected a multiple of ", batch, " x ", dof(), " (batch x dof)");
    require(actions.size() == batch, "predict: ", actions.size(), " actions for ", batch, " prefixes");
    const NoGrad off;
    const Tensor prefix = Tensor::from(context_, {prefixes.size() / batch / dof(), batch, dof()}, prefixes);
    return forward(Var::constant(prefix), Var::constant(one_hot(context_, actions, action_count())), frames)
        .value()
        .to_host();
  }

  /// Writes one safetensors file with the weights (PyTorch's names and shapes), the options and the format.
  void save(const std::filesystem::path& path) { save_model(*this, path); }

  /// Loads a file that save() wrote, or the model in a checkpoint. Throws Error, naming the file and the
  /// problem, for any other file.
  static PredictionModel load(const Context& context, const std::filesystem::path& path) {
    return load_model<PredictionModel>(context, path);
  }

  // Required by model_file.hpp.
  using Options = PredictionOptions;
  using Format = PredictionFormat;
  static constexpr NameTable<Predictor, 4> file_kinds{{{Predictor::lstm, "predictor_lstm"},
                                                       {Predictor::seq2seq, "predictor_seq2seq"},
                                                       {Predictor::erd, "predictor_erd"},
                                                       {Predictor::lstm_3lr, "predictor_lstm_3lr"}}};
  static constexpr const char* part_name = "generator";
  static constexpr const char* made_by = "motiongan evaluate completion";
  static Predictor& kind_of(PredictionOptions& options) { return options.predictor; }
  static std::string write_format(PredictionFormat format) { return io::fields_to_text(fields_of(format)); }
  static PredictionFormat read_format(const std::string& text, const std::string& where) {
    PredictionFormat format;
    io::fields_from_text(fields_of(format), text, where + ": the model's format");
    return format;
  }

 private:
  using Network = std::variant<LstmBaseline, Seq2seq, Erd, Lstm3lr>;

  template <class N>
  static constexpr bool sees_actions =
      std::is_same_v<std::decay_t<N>, LstmBaseline> || std::is_same_v<std::decay_t<N>, Seq2seq>;

  static PredictionOptions with_hidden(PredictionOptions options) {
    check_options(options);
    if (options.hidden == 0) options.hidden = usual_hidden(options.predictor);
    return options;
  }

  static Network make_network(const Context& context, const PredictionFormat& format,
                              const PredictionOptions& options) {
    check_options(format);
    const std::size_t dof = format.dof, actions = format.actions;
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
  PredictionFormat format_;
  PredictionOptions options_;
  Network network_;
};

}  // namespace motiongan

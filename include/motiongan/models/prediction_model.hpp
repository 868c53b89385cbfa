// The baselines of motion completion (SPEC 7.7): networks that go on from a prefix of normalised poses.
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

enum class Predictor {
  lstm,     ///< one layer of LSTM, told the class, trained to copy the future
  seq2seq,  ///< one residual GRU, trained to copy the future
  erd,      ///< encoder, two layers of LSTM, decoder, trained one step ahead on noisy poses
  lstm_3lr  ///< three layers of LSTM, likewise
};
constexpr NameTable<Predictor, 4> enum_names(Predictor) {
  return {{{Predictor::lstm, "lstm"}, {Predictor::seq2seq, "seq2seq"}, {Predictor::erd, "erd"}, {Predictor::lstm_3lr, "lstm_3lr"}}};
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

  void list_fields(FieldList& list) {
    list.add(predictor, {.key = "predictor", .help = "which network", .saved = false});
    list.add(hidden, {.key = "hidden",
                      .help = "width; 0: that of its paper (lstm 256, seq2seq 1024, the others 1000)",
                      .range = Range::between(0, 65536)});
    list.add(labels, {.key = "labels", .help = "whether seq2seq is given the action"});
  }
};

/// What a prediction model's numbers are: the size of a pose and the number of actions.
struct PredictionFormat {
  std::size_t dof = 0, actions = 0;

  void list_fields(FieldList& list) {
    list.add(dof, {.key = "dof", .help = "numbers of a pose", .range = Range::between(1, 65536)});
    list.add(actions, {.key = "actions", .help = "number of actions", .range = Range::between(1, 65536)});
  }
};

/// Goes on from a prefix of poses.
class PredictionModel {
 public:
  PredictionModel(Context context, const PredictionFormat& format, const PredictionOptions& options)
      : context_(std::move(context)),
        format_(format),
        options_(with_hidden(options)),
        network_(make_network(context_, format_, options_)) {}

  const Context& context() const { return context_; }
  const PredictionFormat& format() const { return format_; }
  std::size_t dof() const { return format_.dof; }
  std::size_t action_count() const { return format_.actions; }
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
    require(!prefixes.empty() && prefixes.size() % (batch * dof()) == 0, "predict: ", prefixes.size(),
            " numbers are no whole frames of ", batch, " poses of ", dof(), " numbers");
    require(actions.size() == batch, "predict: ", actions.size(), " actions for ", batch, " prefixes");
    const NoGrad off;
    const Tensor prefix = Tensor::from(context_, {prefixes.size() / batch / dof(), batch, dof()}, prefixes);
    return forward(Var::constant(prefix), Var::constant(one_hot(context_, actions, action_count())), frames)
        .value()
        .to_host();
  }

  /// Writes the weights (PyTorch's names and shapes) and the model's description as one safetensors file.
  void save(const std::filesystem::path& path) { save_model(*this, path); }

  /// A model that save() wrote, or that of a run's checkpoint. Throws Error, naming the file and what is wrong
  /// with it, for any other.
  static PredictionModel load(const Context& context, const std::filesystem::path& path) {
    return load_model<PredictionModel>(context, path);
  }

  // What model_file.hpp needs.
  using Options = PredictionOptions;
  using Format = PredictionFormat;
  static constexpr NameTable<Predictor, 4> file_kinds{{{Predictor::lstm, "predictor_lstm"},
                                                       {Predictor::seq2seq, "predictor_seq2seq"},
                                                       {Predictor::erd, "predictor_erd"},
                                                       {Predictor::lstm_3lr, "predictor_lstm_3lr"}}};
  static constexpr const char* part_name = "generator";
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

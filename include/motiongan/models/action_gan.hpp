// Class-controlled motion, one second after another: a generator with everything that is needed to use it
// (Malek-Podjaski & Deligianni; SPEC 5).
#pragma once
#include <variant>

#include "motiongan/core/fields.hpp"
#include "motiongan/core/random.hpp"
#include "motiongan/data/position_format_json.hpp"
#include "motiongan/models/model_file.hpp"
#include "motiongan/networks/attention_generator.hpp"
#include "motiongan/networks/lstm_baseline.hpp"
#include "motiongan/ops/cross_entropy.hpp"

namespace motiongan {

/// Which network goes on from a prior.
enum class ActionGenerator {
  attention,  ///< a second at once, by convolutions and self-attention, trained against a critic
  lstm        ///< the paper's baseline: frame by frame, trained to copy
};
constexpr NameTable<ActionGenerator, 2> enum_names(ActionGenerator) {
  return {{{ActionGenerator::attention, "attention"}, {ActionGenerator::lstm, "lstm"}}};
}

struct ActionGanOptions {
  ActionGenerator generator = ActionGenerator::attention;
  std::size_t hidden = 256;   ///< C
  std::size_t noise_dim = 0;  ///< numbers of noise beside the class; the paper has none; not for the baseline
  bool attention = true;      ///< of generator, critic and classifier
  std::uint64_t seed = 1;     ///< of the first weights

  void list_fields(FieldList& list) {
    list.add(generator, {.key = "generator",
                         .help = "attention: a second at once, trained against a critic; lstm: the paper's "
                                 "baseline",
                         .option = "--model",
                         .saved = false});  // it is the kind of the file
    list.add(hidden, {.key = "hidden", .help = "width of the networks", .range = Range::between(1, 65536)});
    list.add(attention, {.key = "attention", .help = "self-attention in all networks"});
    list.add(noise_dim, {.key = "noise_dim",
                         .help = "numbers of noise next to the class; the paper: 0",
                         .range = Range::between(0, 65536),
                         .option = "--noise"});
  }
};

/// Goes on from one second of motion to the next, of a given class.
class ActionGan {
 public:
  ActionGan(Context context, motion::PositionFormat format, const ActionGanOptions& options)
      : context_(std::move(context)),
        format_(std::move(format)),
        options_((check_options(options), options)),
        generator_(make_generator(context_, format_, options)) {}

  const Context& context() const { return context_; }
  const motion::PositionFormat& format() const { return format_; }
  const ActionGanOptions& options() const { return options_; }
  bool is_baseline() const { return options_.generator == ActionGenerator::lstm; }

  /// The attention generator; Error for a model of the other kind.
  const AttentionGenerator& generator() const {
    require(!is_baseline(), "this model is the LSTM baseline: it has no attention generator");
    return std::get<AttentionGenerator>(generator_);
  }
  const LstmBaseline& baseline() const {
    require(is_baseline(), "this model has an attention generator: it is not the LSTM baseline");
    return std::get<LstmBaseline>(generator_);
  }

  /// Parameters by PyTorch's names.
  void list_parameters(ParameterList& list) {
    std::visit([&](auto& generator) { generator.list_parameters(list); }, generator_);
  }

  /// The T frames [T, B, dof] that follow a normalised prior [T, B, dof] of class [B, Y] (one-hot); `key`
  /// names the noise where the model has some.
  Var forward(const Var& prior, const Var& classes, const RandomKey& key = {}) const {
    if (is_baseline()) return baseline()(prior, classes, format_.frames);
    return generator()(prior, classes, noise(prior.dim(1), key));
  }

  /// Noise [B, noise_dim] of a step, or none.
  Var noise(std::size_t batch, const RandomKey& key) const {
    if (options_.noise_dim == 0) return {};
    return Var::constant(random_normal(context_, key.with(RandomStream::noise), 1, batch, options_.noise_dim)
                             .reshape({batch, options_.noise_dim}));
  }

  /// Writes the weights (PyTorch's names and shapes) and everything that is needed to generate, as one
  /// safetensors file.
  void save(const std::filesystem::path& path) { save_model(*this, path); }

  /// A model that save() wrote, or the generator of a run's checkpoint. Throws Error, naming the file and what
  /// is wrong with it, for any other.
  static ActionGan load(const Context& context, const std::filesystem::path& path) {
    return load_model<ActionGan>(context, path);
  }

  // What model_file.hpp needs.
  using Options = ActionGanOptions;
  using Format = motion::PositionFormat;
  static constexpr NameTable<ActionGenerator, 2> file_kinds{
      {{ActionGenerator::attention, "attention_generator"}, {ActionGenerator::lstm, "lstm_baseline"}}};
  static constexpr const char* part_name = "generator";
  static ActionGenerator& kind_of(ActionGanOptions& options) { return options.generator; }
  static std::string write_format(const Format& format) { return io::to_text(format); }
  static Format read_format(const std::string& text, const std::string& where) {
    return io::position_format_from_text(text, where);
  }

 private:
  using Network = std::variant<AttentionGenerator, LstmBaseline>;

  static Network make_generator(const Context& context, const motion::PositionFormat& format,
                                const ActionGanOptions& options) {
    format.check();
    const Initializer init(context, options.seed);
    if (options.generator == ActionGenerator::attention)
      return AttentionGenerator(init, {.dof = format.dof(),
                                       .classes = format.classes.size(),
                                       .hidden = options.hidden,
                                       .noise_dim = options.noise_dim,
                                       .attention = options.attention});
    require(options.noise_dim == 0, "the LSTM baseline takes no noise, noise_dim ", options.noise_dim,
            " was asked");
    return LstmBaseline(init,
                        {.dof = format.dof(), .classes = format.classes.size(), .hidden = options.hidden});
  }

  Context context_;
  motion::PositionFormat format_;
  ActionGanOptions options_;
  Network generator_;
};

}  // namespace motiongan

// The class-conditioned motion model of Malek-Podjaski & Deligianni: a generator and the format of its
// motion.
#pragma once
#include <variant>

#include "motiongan/core/fields.hpp"
#include "motiongan/core/random.hpp"
#include "motiongan/data/action_prior.hpp"
#include "motiongan/data/action_schedule.hpp"
#include "motiongan/data/position_format_json.hpp"
#include "motiongan/models/action_starts.hpp"
#include "motiongan/models/model_file.hpp"
#include "motiongan/networks/attention_generator.hpp"
#include "motiongan/networks/lstm_baseline.hpp"
#include "motiongan/ops/cross_entropy.hpp"

namespace motiongan {

/// The network that continues a prior.
enum class ActionGenerator {
  attention,  ///< convolutions and self-attention; T frames at once, trained against a critic
  lstm        ///< the paper's LSTM baseline: frame by frame, trained by MSE
};
constexpr NameTable<ActionGenerator, 2> enum_names(ActionGenerator) {
  return {{{ActionGenerator::attention, "attention"}, {ActionGenerator::lstm, "lstm"}}};
}

/// Options of an ActionGan.
struct ActionGanOptions {
  ActionGenerator generator = ActionGenerator::attention;  ///< which network generates
  std::size_t hidden = 256;                                ///< C, channels of the hidden layers
  std::size_t noise_dim = 0;  ///< noise channels next to the class; the paper: 0; the LSTM must have 0
  bool attention = true;      ///< self-attention in generator, critic and classifier
  bool continues = false;     ///< generate what is added to the prior's last pose, which fades; the paper: no
  bool exact_bones = false;   ///< generated bones keep the lengths of the prior's last pose; the paper: no
  std::uint64_t seed = 1;     ///< seed of the initial weights

  void list_fields(FieldList& list) {
    list.add(generator, {.key = "generator",
                         .help = "attention: a second at once, trained against a critic; lstm: the paper's "
                                 "baseline",
                         .option = "--model",
                         .saved = false});  // it is the kind of the file
    list.add(hidden, {.key = "hidden", .help = "width of the networks", .range = Range::between(1, 65536)});
    list.add(attention, {.key = "attention", .help = "self-attention in all networks"});
    list.add(continues, {.key = "continues",
                         .help = "generate what is added to the given second's last pose, which fades over "
                                 "the next; the paper: off",
                         .option = "--from-last-pose"});
    list.add(exact_bones, {.key = "exact_bones",
                           .help = "give generated bones the lengths of the given second's last pose; the "
                                   "paper: off"});
    list.add(noise_dim, {.key = "noise_dim",
                         .help = "noise channels next to the class; the paper: 0",
                         .range = Range::between(0, 65536),
                         .option = "--noise"});
  }
};

/// Options of ActionGan::generate().
struct ActionGenerateOptions {
  bool with_prior = true;          ///< whether the clips begin with the T frames of the prior
  std::uint64_t seed = 1;          ///< seed of the noise, if the model takes noise
  std::uint32_t first_sample = 0;  ///< noise sample of the first clip; later clips count up from it
};

/// A generator of the T frames of motion of a given class that follow a prior of T frames.
class ActionGan {
 public:
  /// Throws Error if the format or an option is not valid.
  ActionGan(Context context, motion::PositionFormat format, const ActionGanOptions& options)
      : context_(std::move(context)),
        format_(std::move(format)),
        options_((check_options(options), options)),
        generator_(make_generator(context_, format_, options)) {}

  const Context& context() const { return context_; }
  const motion::PositionFormat& format() const { return format_; }
  const ActionGanOptions& options() const { return options_; }
  /// Whether the generator is the LSTM baseline.
  bool is_baseline() const { return options_.generator == ActionGenerator::lstm; }

  /// The attention generator. Throws Error if the model is the LSTM baseline.
  const AttentionGenerator& generator() const {
    require(!is_baseline(), "this model is the LSTM baseline: it has no attention generator");
    return std::get<AttentionGenerator>(generator_);
  }
  /// The LSTM baseline. Throws Error if the model has an attention generator.
  const LstmBaseline& baseline() const {
    require(is_baseline(), "this model has an attention generator: it is not the LSTM baseline");
    return std::get<LstmBaseline>(generator_);
  }

  /// The generator's parameters, under PyTorch's names.
  void list_parameters(ParameterList& list) {
    std::visit([&](auto& generator) { generator.list_parameters(list); }, generator_);
  }

  /// Seconds of motion that the model keeps in its file, to continue where no other is given. Empty unless
  /// set_starts() gave some; `motiongan pack` does.
  const std::vector<ActionStart>& starts() const { return starts_; }
  /// Throws Error if a start does not fit the model's format.
  void set_starts(std::vector<ActionStart> starts) {
    for (const ActionStart& start : starts)
      require(
          start.label < format_.classes.size() && start.prior.poses.size() == format_.frames * format_.dof(),
          "the start ", start.prior.id, " is of class ", start.label, " with ", start.prior.poses.size(),
          " values, expected one of ", format_.classes.size(), " classes and ", format_.frames, " frames of ",
          format_.dof());
    starts_ = std::move(starts);
  }
  /// The start that motion of a class continues: those of clips of this class in turn, by `sample`; of other
  /// classes if there are none. Null if the model keeps none.
  const ActionStart* start(std::size_t label, std::size_t sample) const {
    std::vector<const ActionStart*> own, all;
    for (const ActionStart& start : starts_) {
      all.push_back(&start);
      if (start.label == label) own.push_back(&start);
    }
    const std::vector<const ActionStart*>& from = own.empty() ? all : own;
    return from.empty() ? nullptr : from[sample % from.size()];
  }

  /// The T frames [T, B, dof] that follow a prior [T, B, dof], both normalised, of classes [B, Y] (one-hot).
  /// `key` selects the noise, if the model takes noise.
  Var forward(const Var& prior, const Var& classes, const RandomKey& key = {}) const {
    if (is_baseline()) return baseline()(prior, classes, format_.frames);
    return generator()(prior, classes, noise(prior.dim(1), key));
  }

  /// The noise [B, noise_dim] that `key` selects; empty if the model takes no noise.
  Var noise(std::size_t batch, const RandomKey& key) const {
    if (options_.noise_dim == 0) return {};
    return Var::constant(random_normal(context_, key.with(RandomStream::noise), 1, batch, options_.noise_dim)
                             .reshape({batch, options_.noise_dim}));
  }

  /// Generates one clip for each prior, all with the same schedule; clips have the ids of their priors. The
  /// model makes T frames at a time. Where a segment of the schedule ends within them, the remaining frames
  /// are discarded and the next segment continues from the last T frames kept, so that classes change exactly
  /// where the schedule says. Throws Error if the schedule has no frames or a prior does not fit the model.
  std::vector<motion::PositionClip> generate(const std::vector<ActionPrior>& priors,
                                             const ActionSchedule& schedule,
                                             const ActionGenerateOptions& options = {}) const;

  /// The same with a schedule such as "walk:3s,run:5s", see parse_action_schedule().
  std::vector<motion::PositionClip> generate(const std::vector<ActionPrior>& priors,
                                             std::string_view schedule,
                                             const ActionGenerateOptions& options = {}) const;

  /// `count` clips that continue the model's own starts. Throws Error if it keeps none. All three are defined
  /// in motiongan/sample/action_generate.hpp.
  std::vector<motion::PositionClip> generate(std::string_view schedule, std::size_t count = 1,
                                             const ActionGenerateOptions& options = {}) const;

  /// Rounds all weights to bfloat16 (PyTorch's module.bfloat16(), but computing stays in the context's
  /// precision). What then generates frame by frame or second by second reads them in 16 bits. There is no
  /// way back, and training should not continue from here.
  void bfloat16() { detail::round_weights(generator_); }

  /// Writes one safetensors file with the weights (PyTorch's names and shapes), the options and the format.
  void save(const std::filesystem::path& path, StoredWeights stored = StoredWeights::whole) {
    save_model(*this, path, stored);
  }

  /// Loads a file that save() wrote, the generator in a checkpoint, or a shipped model by its name. Throws
  /// Error, naming the file and the problem, for any other file.
  static ActionGan load(const Context& context, const std::filesystem::path& path,
                        WeightSource source = WeightSource::mean) {
    return load_model<ActionGan>(context, path, source);
  }

  // Required by model_file.hpp.
  using Options = ActionGanOptions;
  using Format = motion::PositionFormat;
  static constexpr NameTable<ActionGenerator, 2> file_kinds{
      {{ActionGenerator::attention, "attention_generator"}, {ActionGenerator::lstm, "lstm_baseline"}}};
  static constexpr const char* part_name = "generator";
  static constexpr const char* made_by = "motiongan train attention";
  static ActionGenerator& kind_of(ActionGanOptions& options) { return options.generator; }
  static std::string write_format(const Format& format) { return io::to_text(format); }
  static Format read_format(const std::string& text, const std::string& where) {
    return io::position_format_from_text(text, where);
  }
  void write_extras(io::SafeTensors& file) const {
    if (!starts_.empty()) add_starts(file, starts_, format_);
  }
  void read_extras(const io::SafeTensors& file, const std::string& where) {
    starts_ = starts_in(file, format_, where);
  }

 private:
  using Network = std::variant<AttentionGenerator, LstmBaseline>;

  static Network make_generator(const Context& context, const motion::PositionFormat& format,
                                const ActionGanOptions& options) {
    format.check();
    const Initializer init(context, options.seed);
    if (options.generator == ActionGenerator::attention)
      return AttentionGenerator(
          init,
          {.dof = format.dof(),
           .classes = format.classes.size(),
           .hidden = options.hidden,
           .noise_dim = options.noise_dim,
           .attention = options.attention,
           .continues = options.continues},
          options.exact_bones ? std::optional<Bones>(std::in_place, context, format) : std::nullopt);
    require(!options.continues && !options.exact_bones,
            "the LSTM baseline generates poses: it has no form that continues or keeps bones");
    require(options.noise_dim == 0, "the LSTM baseline takes no noise: noise_dim is ", options.noise_dim,
            ", expected 0");
    return LstmBaseline(init,
                        {.dof = format.dof(), .classes = format.classes.size(), .hidden = options.hidden});
  }

  Context context_;
  motion::PositionFormat format_;
  ActionGanOptions options_;
  Network generator_;
  std::vector<ActionStart> starts_;
};

}  // namespace motiongan

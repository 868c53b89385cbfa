// Class-controlled motion, one second after another: a generator with everything that is needed to use it
// (Malek-Podjaski & Deligianni; SPEC 5).
#pragma once
#include <variant>

#include "motiongan/core/random.hpp"
#include "motiongan/data/position_format_json.hpp"
#include "motiongan/io/safetensors.hpp"
#include "motiongan/nn/state_dict.hpp"
#include "motiongan/networks/attention_generator.hpp"
#include "motiongan/networks/lstm_baseline.hpp"
#include "motiongan/ops/cross_entropy.hpp"

namespace motiongan {

/// Which network goes on from a prior.
enum class ActionGenerator {
  attention,  ///< a second at once, by convolutions and self-attention, trained against a critic
  lstm        ///< the paper's baseline: frame by frame, trained to copy
};

struct ActionGanOptions {
  ActionGenerator generator = ActionGenerator::attention;
  std::size_t hidden = 256;   ///< C
  std::size_t noise_dim = 0;  ///< numbers of noise beside the class; the paper has none; not for the baseline
  bool attention = true;      ///< of generator, critic and classifier
  std::uint64_t seed = 1;     ///< of the first weights
};

/// Goes on from one second of motion to the next, of a given class.
class ActionGan {
 public:
  ActionGan(Context context, motion::PositionFormat format, const ActionGanOptions& options)
      : context_(std::move(context)),
        format_(std::move(format)),
        options_(options),
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
  Var make(const Var& prior, const Var& classes, const RandomKey& key = {}) const {
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
  void save(const std::filesystem::path& path) {
    io::SafeTensors file;
    describe(file);
    io::save_parameters(named_parameters(*this), file);
    file.write(path);
  }

  /// A model that save() wrote, or the generator of a run's checkpoint. Throws, naming the file and what is
  /// wrong, for any other.
  static ActionGan load(const Context& context, const std::filesystem::path& path) {
    const io::SafeTensors file = io::SafeTensors::read(path);
    ActionGan model = from_description(context, file, path.string());
    const bool is_checkpoint = file.metadata.contains("iteration");
    io::load_parameters(named_parameters(model), file, path.string(), is_checkpoint ? "generator." : "");
    return model;
  }

  /// Whether a file's metadata say that it holds a model of this kind.
  static bool describes(const io::SafeTensors& file) {
    const auto found = file.metadata.find("motiongan_model");
    return found != file.metadata.end() && (found->second == attention_name || found->second == lstm_name);
  }

  /// Adds the metadata of a model file: which model it is, its options and its format.
  void describe(io::SafeTensors& file) const {
    file.metadata["motiongan_model"] = is_baseline() ? lstm_name : attention_name;
    nlohmann::json options{{"hidden", options_.hidden}};
    if (!is_baseline()) {
      options["noise_dim"] = options_.noise_dim;
      options["attention"] = options_.attention;
    }
    file.metadata["options"] = options.dump();
    file.metadata["format"] = io::to_json(format_).dump();
  }

  /// A model, with fresh weights, as a file's metadata describe it.
  static ActionGan from_description(const Context& context, const io::SafeTensors& file,
                                       const std::string& where) {
    require(file.metadata.contains("motiongan_model"), where,
            ": not a motiongan model (no \"motiongan_model\" in its metadata)");
    const std::string& name = file.metadata.at("motiongan_model");
    require(describes(file), where, ": holds a model called \"", name, "\", expected ", attention_name,
            " or ", lstm_name);
    try {
      const auto options = nlohmann::json::parse(file.metadata.at("options"));
      ActionGanOptions read;
      read.generator = name == lstm_name ? ActionGenerator::lstm : ActionGenerator::attention;
      read.hidden = options.at("hidden").get<std::size_t>();
      if (read.generator == ActionGenerator::attention) {
        read.noise_dim = options.at("noise_dim").get<std::size_t>();
        read.attention = options.at("attention").get<bool>();
      }
      require(read.hidden > 0 && read.hidden <= 65536 && read.noise_dim <= 65536, "hidden ", read.hidden,
              " or noise_dim ", read.noise_dim, " is out of range");
      return ActionGan(
          context, io::position_format_from_json(nlohmann::json::parse(file.metadata.at("format"))), read);
    } catch (const Error& error) {
      throw Error(where, ": ", error.what());
    } catch (const std::exception& error) {  // nlohmann's own, and missing keys
      throw Error(where, ": the model's metadata cannot be read: ", error.what());
    }
  }

  static constexpr const char *attention_name = "attention_generator", *lstm_name = "lstm_baseline";

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

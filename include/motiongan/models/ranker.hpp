// A ranker as its user sees it: how well a description fits a motion, and the embedding of motion that the
// evaluation measures in (Lin & Amer, eq. 8 and 9; SPEC 7).
#pragma once
#include <nlohmann/json.hpp>
#include <variant>

#include "motiongan/data/motion_format_json.hpp"
#include "motiongan/nn/state_dict.hpp"
#include "motiongan/networks/rnn_ranker.hpp"

namespace motiongan {

/// What embeds a motion: the CNN critic's trunk, or mean pose and mean motion.
enum class RankerKind { cnn, rnn };

struct RankerOptions {
  RankerKind kind = RankerKind::rnn;
  std::size_t hidden = 1024;  ///< k
  std::size_t taps = 3;       ///< of the CNN's convolutions: 3 or 5
  std::uint64_t seed = 1;     ///< of the first weights
};

/// F(S, A) = <h_txt, h / |h|>: the score of description S for motion A.
class Ranker {
 public:
  Ranker(const Context& context, motion::MotionFormat format, const RankerOptions& options = {})
      : context_(context),
        format_(std::move(format)),
        options_(options),
        network_(make_network(context, format_, options)) {}

  const Context& context() const { return context_; }
  const motion::MotionFormat& format() const { return format_; }
  const RankerOptions& options() const { return options_; }

  /// Embedding of normalised motion [N, B, M], not of length 1 yet: [B, k].
  Var embed(const Var& motion) const {
    return std::visit([&](const auto& network) { return network.embed(motion); }, network_);
  }

  /// Embedding of descriptions: [K, k].
  Var describe(const Sentences& text) const {
    return std::visit([&](const auto& network) { return network.describe(text); }, network_);
  }

  /// Scores of all descriptions [K, k], made by describe(), for all motions [N, B, M]: [B, K].
  Var scores(const Var& motion, const Var& descriptions) const {
    return matmul(normalize_rows(embed(motion)), descriptions, false, true);
  }

  /// h / |h| of motions, [count, k]. Of each the first N frames at the format's rate count, resampled where
  /// it has another one. Error for a shorter motion, or another skeleton.
  std::vector<float> features(const std::vector<motion::Motion>& motions) const {
    const NoGrad values_only;
    const std::size_t frames = format_.frames, dof = format_.dof();
    std::vector<float> out;
    out.reserve(motions.size() * options_.hidden);
    constexpr std::size_t most = 64;
    for (std::size_t first = 0; first < motions.size(); first += most) {
      const std::size_t batch = std::min(most, motions.size() - first);
      std::vector<float> values(frames * batch * dof);  // [N, B, M]
      for (std::size_t b = 0; b < batch; ++b) {
        const std::vector<float> window = window_of(motions[first + b]);
        for (std::size_t f = 0; f < frames; ++f)
          std::copy_n(window.begin() + static_cast<std::ptrdiff_t>(f * dof), dof,
                      values.begin() + static_cast<std::ptrdiff_t>((f * batch + b) * dof));
      }
      const Var motion = Var::constant(Tensor::from(context_, {frames, batch, dof}, values));
      const std::vector<float> part = normalize_rows(embed(motion)).value().to_host();
      out.insert(out.end(), part.begin(), part.end());
    }
    return out;
  }

  /// Scores [count, K] of the descriptions for motions whose features() are given, [count, k]. Error for a
  /// description without a word.
  std::vector<float> scores(std::span<const float> features,
                            const std::vector<std::string>& descriptions) const {
    const NoGrad values_only;
    const std::size_t k = options_.hidden;
    require(!features.empty() && features.size() % k == 0, features.size(),
            " numbers of features are not rows of ", k);
    std::vector<std::vector<int>> sentences;
    for (const std::string& description : descriptions)
      sentences.push_back(format_.vocabulary.encode(description));
    const Var text = describe(Sentences(context_, sentences, format_.vocabulary.size()));
    const Var motion = Var::constant(Tensor::from(context_, {features.size() / k, k},
                                                  std::vector<float>(features.begin(), features.end())));
    return matmul(motion, text, false, true).value().to_host();
  }

  /// Parameters by PyTorch's names.
  void list_parameters(ParameterList& list) {
    std::visit([&](auto& network) { network.list_parameters(list); }, network_);
  }

  /// Writes the weights (PyTorch's names and shapes) and everything that is needed to rank, as one
  /// safetensors file.
  void save(const std::filesystem::path& path) {
    io::SafeTensors file;
    describe(file);
    io::save_parameters(named_parameters(*this), file);
    file.write(path);
  }

  /// A ranker that save() wrote, or that of a run's checkpoint. Throws, naming the file and what is wrong,
  /// for any other.
  static Ranker load(const Context& context, const std::filesystem::path& path) {
    const io::SafeTensors file = io::SafeTensors::read(path);
    Ranker ranker = from_description(context, file, path.string());
    const bool is_checkpoint = file.metadata.contains("iteration");
    io::load_parameters(named_parameters(ranker), file, path.string(), is_checkpoint ? "ranker." : "");
    return ranker;
  }

  /// Whether a file's metadata say that it holds a ranker.
  static bool describes(const io::SafeTensors& file) {
    const auto found = file.metadata.find("motiongan_model");
    return found != file.metadata.end() && (found->second == cnn_name || found->second == rnn_name);
  }

  /// Adds the metadata of a model file: which model it is, its options and its motion format.
  void describe(io::SafeTensors& file) const {
    const bool is_cnn = options_.kind == RankerKind::cnn;
    file.metadata["motiongan_model"] = is_cnn ? cnn_name : rnn_name;
    nlohmann::json options{{"hidden", options_.hidden}};
    if (is_cnn) options["taps"] = options_.taps;
    file.metadata["options"] = options.dump();
    file.metadata["format"] = io::to_json(format_).dump();
  }

  /// A ranker, with fresh weights, as a file's metadata describe it.
  static Ranker from_description(const Context& context, const io::SafeTensors& file,
                                 const std::string& where) {
    const auto found = file.metadata.find("motiongan_model");
    require(found != file.metadata.end(), where,
            ": not a motiongan model (no \"motiongan_model\" in its metadata)");
    require(describes(file), where, ": holds a model called \"", found->second, "\", expected ", cnn_name,
            " or ", rnn_name, "; motiongan train ranker makes one");
    try {
      const auto options = nlohmann::json::parse(file.metadata.at("options"));
      RankerOptions read;
      read.kind = found->second == cnn_name ? RankerKind::cnn : RankerKind::rnn;
      read.hidden = options.at("hidden").get<std::size_t>();
      if (read.kind == RankerKind::cnn) read.taps = options.at("taps").get<std::size_t>();
      require(read.hidden > 0 && read.hidden <= 65536 && (read.taps == 3 || read.taps == 5), "hidden ",
              read.hidden, " or taps ", read.taps, " is out of range");
      return Ranker(context, io::motion_format_from_json(nlohmann::json::parse(file.metadata.at("format"))),
                    read);
    } catch (const Error& error) {
      throw Error(where, ": ", error.what());
    } catch (const std::exception& error) {  // nlohmann's own, and missing keys
      throw Error(where, ": the model's metadata cannot be read: ", error.what());
    }
  }

  static constexpr const char *cnn_name = "cnn_ranker", *rnn_name = "rnn_ranker";

 private:
  using Network = std::variant<CnnRanker, RnnRanker>;

  static Network make_network(const Context& context, const motion::MotionFormat& format,
                              const RankerOptions& options) {
    const Initializer init(context, options.seed);
    const RankerSizes sizes{.vocabulary = format.vocabulary.size(),
                            .dof = format.dof(),
                            .frames = format.frames,
                            .hidden = options.hidden,
                            .taps = options.taps};
    if (options.kind == RankerKind::cnn) return CnnRanker(init, sizes);
    return RnnRanker(init, sizes);
  }

  /// The motion's first N frames as the network sees them, [N, M].
  std::vector<float> window_of(const motion::Motion& motion) const {
    const bool same_rate = std::abs(motion.rate / format_.rate - 1) < 1e-6;
    std::vector<float> poses =
        format_.encode_window(same_rate ? motion : motion::resample(motion, format_.rate));
    const std::size_t wanted = format_.frames * format_.dof();
    require(poses.size() >= wanted, "a motion of ", poses.size() / format_.dof(), " frames at ", format_.rate,
            " per second cannot be ranked, expected at least ", format_.frames);
    poses.resize(wanted);
    return poses;
  }

  Context context_;
  motion::MotionFormat format_;
  RankerOptions options_;
  Network network_;
};

}  // namespace motiongan

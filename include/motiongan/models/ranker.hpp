// A ranker as its user sees it: how well a description fits a motion, and the embedding of motion that the
// evaluation measures in (Lin & Amer, eq. 8 and 9; SPEC 7).
#pragma once
#include <variant>

#include "motiongan/core/fields.hpp"
#include "motiongan/data/motion_format_json.hpp"
#include "motiongan/models/model_file.hpp"
#include "motiongan/networks/rnn_ranker.hpp"

namespace motiongan {

/// What embeds a motion: the CNN critic's trunk, or mean pose and mean motion.
enum class RankerKind { cnn, rnn };
constexpr NameTable<RankerKind, 2> enum_names(RankerKind) {
  return {{{RankerKind::cnn, "cnn"}, {RankerKind::rnn, "rnn"}}};
}

struct RankerOptions {
  RankerKind kind = RankerKind::rnn;
  std::size_t hidden = 1024;  ///< k
  std::size_t taps = 3;       ///< of the CNN's convolutions: 3 or 5
  std::uint64_t seed = 1;     ///< of the first weights

  void list_fields(FieldList& list) {
    list.add(kind, {.key = "kind",
                    .help = "rnn: mean pose and mean motion; cnn: the CNN critic's trunk",
                    .option = "--ranker",
                    .saved = false});  // it is the kind of the file
    list.add(hidden, {.key = "hidden",
                      .help = "width of the network, and of the embedding",
                      .range = Range::between(1, 65536)});
    list.add(taps, {.key = "taps", .help = "taps of the CNN's convolutions: 3 or 5", .choices = {3, 5}});
  }
};

/// F(S, A) = <h_txt, h / |h|>: the score of description S for motion A.
class Ranker {
 public:
  Ranker(const Context& context, motion::MotionFormat format, const RankerOptions& options = {})
      : context_(context),
        format_(std::move(format)),
        options_((check_options(options), options)),
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
  void save(const std::filesystem::path& path) { save_model(*this, path); }

  /// A ranker that save() wrote, or that of a run's checkpoint. Throws Error, naming the file and what is
  /// wrong with it, for any other.
  static Ranker load(const Context& context, const std::filesystem::path& path) {
    return load_model<Ranker>(context, path);
  }

  // What model_file.hpp needs.
  using Options = RankerOptions;
  using Format = motion::MotionFormat;
  static constexpr NameTable<RankerKind, 2> file_kinds{
      {{RankerKind::cnn, "cnn_ranker"}, {RankerKind::rnn, "rnn_ranker"}}};
  static constexpr const char* part_name = "ranker";
  static RankerKind& kind_of(RankerOptions& options) { return options.kind; }
  static std::string write_format(const Format& format) { return io::to_text(format); }
  static Format read_format(const std::string& text, const std::string& where) {
    return io::motion_format_from_text(text, where);
  }

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

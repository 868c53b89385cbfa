// Rankers (Lin & Amer, section 6.2): they score how well a description fits a motion. The evaluation uses
// their embedding of motion.
#pragma once
#include <variant>

#include "motiongan/core/fields.hpp"
#include "motiongan/data/motion_format_json.hpp"
#include "motiongan/models/model_file.hpp"
#include "motiongan/networks/rnn_ranker.hpp"

namespace motiongan {

/// The network that embeds a motion.
enum class RankerKind {
  cnn,  ///< the trunk of the CNN critic (Lin & Amer, eq. 8)
  rnn   ///< mean features of poses and of motion (Lin & Amer, eq. 9)
};
constexpr NameTable<RankerKind, 2> enum_names(RankerKind) {
  return {{{RankerKind::cnn, "cnn"}, {RankerKind::rnn, "rnn"}}};
}

/// Options of a Ranker.
struct RankerOptions {
  RankerKind kind = RankerKind::rnn;  ///< which network ranks
  std::size_t hidden = 1024;          ///< k, width of the network and of the embedding
  std::size_t taps = 3;               ///< kernel size of the CNN's convolutions: 3 or 5
  std::uint64_t seed = 1;             ///< seed of the initial weights

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

/// The score of description S for motion A: F(S, A) = <h_txt, h / |h|> (Lin & Amer, appendix B).
class Ranker {
 public:
  /// Throws Error if an option is not valid, or if N does not fit the CNN.
  Ranker(const Context& context, motion::MotionFormat format, const RankerOptions& options = {})
      : context_(context),
        format_(std::move(format)),
        options_((check_options(options), options)),
        network_(make_network(context, format_, options)) {}

  const Context& context() const { return context_; }
  const motion::MotionFormat& format() const { return format_; }
  const RankerOptions& options() const { return options_; }

  /// The embedding h of normalised motion [N, B, M], not yet of unit length: [B, k].
  Var embed(const Var& motion) const {
    return std::visit([&](const auto& network) { return network.embed(motion); }, network_);
  }

  /// The embedding h_txt of K descriptions: [K, k].
  Var describe(const Sentences& text) const {
    return std::visit([&](const auto& network) { return network.describe(text); }, network_);
  }

  /// The scores [B, K] of all descriptions [K, k], from describe(), for all motions [N, B, M].
  Var scores(const Var& motion, const Var& descriptions) const {
    return matmul(normalize_rows(embed(motion)), descriptions, false, true);
  }

  /// The unit-length embeddings h / |h| of motions, [count, k], from their first N frames, resampled to the
  /// model's frame rate. Throws Error if a motion is shorter or has another skeleton.
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

  /// The scores [count, K] of K descriptions for motions with the given features() [count, k]. Throws Error
  /// if a description has no words.
  std::vector<float> scores(std::span<const float> features,
                            const std::vector<std::string>& descriptions) const {
    const NoGrad values_only;
    const std::size_t k = options_.hidden;
    require(!features.empty() && features.size() % k == 0, "features has ", features.size(),
            " values, expected a multiple of ", k, " (hidden)");
    std::vector<std::vector<int>> sentences;
    for (const std::string& description : descriptions)
      sentences.push_back(format_.vocabulary.encode(description));
    const Var text = describe(Sentences(context_, sentences, format_.vocabulary.size()));
    const Var motion = Var::constant(Tensor::from(context_, {features.size() / k, k},
                                                  std::vector<float>(features.begin(), features.end())));
    return matmul(motion, text, false, true).value().to_host();
  }

  /// The parameters, under PyTorch's names.
  void list_parameters(ParameterList& list) {
    std::visit([&](auto& network) { network.list_parameters(list); }, network_);
  }

  /// Writes one safetensors file with the weights (PyTorch's names and shapes), the options and the format.
  void save(const std::filesystem::path& path) { save_model(*this, path); }

  /// Loads a file that save() wrote, or the ranker in a checkpoint. Throws Error, naming the file and the
  /// problem, for any other file.
  static Ranker load(const Context& context, const std::filesystem::path& path) {
    return load_model<Ranker>(context, path);
  }

  // Required by model_file.hpp.
  using Options = RankerOptions;
  using Format = motion::MotionFormat;
  static constexpr NameTable<RankerKind, 2> file_kinds{
      {{RankerKind::cnn, "cnn_ranker"}, {RankerKind::rnn, "rnn_ranker"}}};
  static constexpr const char* part_name = "ranker";
  static constexpr const char* made_by = "motiongan train ranker";
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

  /// The motion's first N frames as the network's input, [N, M].
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

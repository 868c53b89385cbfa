// The text-conditioned motion model of Lin & Amer (DVGAN): a generator and the format of its motion.
#pragma once
#include <optional>
#include <variant>

#include "motiongan/core/fields.hpp"
#include "motiongan/data/motion_format_json.hpp"
#include "motiongan/models/model_file.hpp"
#include "motiongan/networks/cnn_generator.hpp"
#include "motiongan/networks/rnn_stream.hpp"

namespace motiongan {

/// The generator network.
enum class GeneratorKind {
  cnn,  ///< N frames at once, coarse to fine (Lin & Amer, eq. 4)
  rnn   ///< frame by frame: any length, and completion of a given motion (Lin & Amer, eq. 5)
};
constexpr NameTable<GeneratorKind, 2> enum_names(GeneratorKind) {
  return {{{GeneratorKind::cnn, "cnn"}, {GeneratorKind::rnn, "rnn"}}};
}

/// Options of a Dvgan.
struct DvganOptions {
  GeneratorKind generator = GeneratorKind::cnn;  ///< which network generates
  std::size_t hidden = 256;                      ///< k, hidden width
  std::size_t taps = 3;                          ///< kernel size of the CNN's convolutions: 3 or 5
  std::optional<bool> final_cut = {};  ///< make 2N frames, keep N; not set: on for the CNN, off for the RNN
  double leak = 0;  ///< RNN: share of the pose that is lost in a frame, in [0, 1); 0: none, as the paper
  std::uint64_t seed = 1;  ///< seed of the initial weights

  /// Whether final cut is on.
  bool cuts() const { return final_cut.value_or(generator == GeneratorKind::cnn); }

  void list_fields(FieldList& list) {
    list.add(generator, {.key = "generator",
                         .help = "cnn: a window at once, coarse to fine; rnn: frame by frame, for any length",
                         .saved = false});  // it is the kind of the file
    list.add(final_cut,
             {.key = "final_cut",
              .help = "generate twice the frames and keep half of them [on for the CNN generator]"});
    list.add(leak,
             {.key = "leak",
              .help = "share of the pose that the RNN generator loses in a frame, so that the errors of "
                      "long motions do not add up; 0: none",
              .range = Range::between(0, 0.99)});
    list.add(hidden, {.key = "hidden", .help = "width of the networks", .range = Range::between(1, 65536)});
    list.add(taps, {.key = "taps", .help = "taps of the convolutions: 3 or 5", .choices = {3, 5}});
  }
};

/// Options of Dvgan::generate().
struct GenerateOptions {
  std::size_t count = 1;         ///< number of motions
  std::uint64_t seed = 1;        ///< the same seed gives the same motions on the same device
  std::size_t first_sample = 0;  ///< sample i of a seed is the same motion whatever the count
  std::size_t frames = 0;        ///< of each motion; 0: the model's N; other lengths require an RNN generator
};

/// A text-conditioned motion generator (Lin & Amer).
class Dvgan {
 public:
  /// Throws Error if an option is not valid, or if N does not fit the CNN generator.
  Dvgan(const Context& context, motion::MotionFormat format, const DvganOptions& options = {})
      : context_(context),
        format_(std::move(format)),
        options_(checked(options)),
        generator_(make_generator(context, format_, options)) {}

  const Context& context() const { return context_; }
  const motion::MotionFormat& format() const { return format_; }
  const DvganOptions& options() const { return options_; }

  /// Whether the generator is an RNN: frame by frame, any length, completion.
  bool is_recurrent() const { return options_.generator == GeneratorKind::rnn; }
  /// The CNN generator. Throws Error if the model has an RNN generator.
  const CnnGenerator& cnn() const {
    require(!is_recurrent(), "this model has an RNN generator, expected a CNN generator");
    return std::get<CnnGenerator>(generator_);
  }
  /// The RNN generator. Throws Error if the model has a CNN generator.
  const RnnGenerator& rnn() const {
    require(
        is_recurrent(), "this model has a CNN generator, which makes its ", format_.frames,
        " frames at once: it cannot complete a motion, make other lengths or generate frame by frame. Train "
        "a model with an RNN generator for that (motiongan train dvgan --generator rnn)");
    return std::get<RnnGenerator>(generator_);
  }

  /// The generator's parameters, under PyTorch's names.
  void list_parameters(ParameterList& list) {
    std::visit([&](auto& generator) { generator.list_parameters(list); }, generator_);
  }

  /// Generates normalised motion [N, B, M] for B sentences; training makes its fakes with it. `key` selects
  /// the noise and the final cut.
  Var forward(const Sentences& text, const RandomKey& key) const {
    if (is_recurrent()) {
      const RnnGenerator& generator = rnn();
      return generator(text, generator.noise(context_, key, text.batch, generator.frames_made()),
                       generator.cuts(context_, key, text.batch));
    }
    const Indices cut = cnn().cuts(context_, key, text.batch);
    return cnn()(text, cnn().noise(context_, key, text.batch, cut), cut);
  }

  /// Completes `seed` frames [n, B, M], 1 <= n <= N, to motion [N, B, M], both normalised, without final cut.
  /// Throws Error if the model has a CNN generator.
  Var complete(const Sentences& text, const Var& seed, const RandomKey& key) const {
    return rnn()(text, rnn().noise(context_, key, text.batch, format_.frames), {}, seed);
  }

  /// Generates the normalised poses of `count` motions, [frames, dof] each. Words that are not in the
  /// vocabulary are encoded as unknown. An RNN generator with final cut begins with its frame N, see
  /// RnnGenerator::warm_up(). Throws Error if the caption has no words, or if `frames` is not N and the model
  /// has a CNN generator.
  std::vector<std::vector<float>> generate_poses(const std::string& caption,
                                                 const GenerateOptions& options) const {
    const NoGrad values_only;
    const std::vector<int> sentence = format_.vocabulary.encode(caption);
    const std::size_t frames = options.frames > 0 ? options.frames : format_.frames, dof = format_.dof();
    if (frames != format_.frames) rnn();  // throws for a CNN
    std::vector<std::vector<float>> all(options.count, std::vector<float>(frames * dof));
    constexpr std::size_t most = 64, piece = 64;  // samples and frames per batch
    for (std::size_t first = 0; first < options.count; first += most) {
      const std::size_t batch = std::min(most, options.count - first);
      const auto first_sample = static_cast<std::uint32_t>(options.first_sample + first);
      const auto keep = [&](std::span<const float> values, std::size_t from) {  // [some frames, batch, dof]
        for (std::size_t row = 0; row < values.size() / dof; ++row)
          std::copy_n(
              values.begin() + static_cast<std::ptrdiff_t>(row * dof), dof,
              all[first + row % batch].begin() + static_cast<std::ptrdiff_t>((from + row / batch) * dof));
      };
      if (is_recurrent()) {
        RnnStream stream(rnn());
        std::vector<StreamStart> starts;
        for (std::size_t b = 0; b < batch; ++b)
          starts.push_back({sentence, options.seed, first_sample + static_cast<std::uint32_t>(b)});
        stream.add(starts);
        for (std::size_t at = 0; at < frames; at += piece)
          keep(stream.step(std::min(piece, frames - at)), at);
      } else {
        const Sentences text(context_, std::vector<std::vector<int>>(batch, sentence),
                             format_.vocabulary.size());
        keep(forward(text, {.seed = options.seed, .first_sample = first_sample}).value().to_host(), 0);
      }
    }
    return all;
  }

  /// Generates motions of a caption at the model's frame rate; see generate_poses().
  std::vector<motion::Motion> generate(const std::string& caption,
                                       const GenerateOptions& options = {}) const {
    std::vector<motion::Motion> motions;
    for (const auto& poses : generate_poses(caption, options)) motions.push_back(format_.to_motion(poses));
    return motions;
  }

  /// Rounds all weights to bfloat16 (PyTorch's module.bfloat16(), but computing stays in the context's
  /// precision). What then generates frame by frame or second by second reads them in 16 bits. There is no
  /// way back, and training should not continue from here.
  void bfloat16() { detail::round_weights(generator_); }

  /// Writes one safetensors file with the weights (PyTorch's names and shapes), the options and the format.
  void save(const std::filesystem::path& path, StoredWeights stored = StoredWeights::whole) {
    save_model(*this, path, stored);
  }

  /// Loads a file that save() wrote, the generator in a checkpoint, or a shipped model by its name
  /// ("cmu-text"). Throws Error, naming the file and the problem, for any other file.
  static Dvgan load(const Context& context, const std::filesystem::path& path,
                    WeightSource source = WeightSource::mean) {
    return load_model<Dvgan>(context, path, source);
  }

  // Required by model_file.hpp.
  using Options = DvganOptions;
  using Format = motion::MotionFormat;
  static constexpr NameTable<GeneratorKind, 2> file_kinds{
      {{GeneratorKind::cnn, "dvgan_cnn_generator"}, {GeneratorKind::rnn, "dvgan_rnn_generator"}}};
  static constexpr const char* part_name = "generator";
  static constexpr const char* made_by = "motiongan train dvgan";
  static GeneratorKind& kind_of(DvganOptions& options) { return options.generator; }
  static std::string write_format(const Format& format) { return io::to_text(format); }
  static Format read_format(const std::string& text, const std::string& where) {
    return io::motion_format_from_text(text, where);
  }

 private:
  using Network = std::variant<CnnGenerator, RnnGenerator>;

  static DvganOptions checked(DvganOptions options) {
    check_options(options);
    options.final_cut = options.cuts();
    return options;
  }

  static Network make_generator(const Context& context, const motion::MotionFormat& format,
                                const DvganOptions& options) {
    const Initializer init(context, options.seed);
    if (options.generator == GeneratorKind::rnn)
      return RnnGenerator(init, {.vocabulary = format.vocabulary.size(),
                                 .dof = format.dof(),
                                 .frames = format.frames,
                                 .hidden = options.hidden,
                                 .final_cut = options.cuts(),
                                 .leak = options.leak});
    return CnnGenerator(init, {.vocabulary = format.vocabulary.size(),
                               .dof = format.dof(),
                               .frames = format.frames,
                               .hidden = options.hidden,
                               .taps = options.taps,
                               .final_cut = options.cuts()});
  }

  Context context_;
  motion::MotionFormat format_;
  DvganOptions options_;
  Network generator_;
};

}  // namespace motiongan

// DVGAN as its user sees it: a generator, and the format that turns its numbers into motion. One file holds
// both.
#pragma once
#include <optional>
#include <variant>

#include "motiongan/core/fields.hpp"
#include "motiongan/data/motion_format_json.hpp"
#include "motiongan/models/model_file.hpp"
#include "motiongan/networks/cnn_generator.hpp"
#include "motiongan/networks/rnn_stream.hpp"

namespace motiongan {

/// Which network makes the motion: the CNN makes a window of N frames at once, coarse to fine; the RNN goes
/// on frame by frame, for as long as one likes, and can continue a given motion.
enum class GeneratorKind { cnn, rnn };
constexpr NameTable<GeneratorKind, 2> enum_names(GeneratorKind) {
  return {{{GeneratorKind::cnn, "cnn"}, {GeneratorKind::rnn, "rnn"}}};
}

struct DvganOptions {
  GeneratorKind generator = GeneratorKind::cnn;
  std::size_t hidden = 256;            ///< k
  std::size_t taps = 3;                ///< of the CNN's convolutions: 3 or 5
  std::optional<bool> final_cut = {};  ///< make 2N frames, keep N; not set: on for the CNN, off for the RNN
  std::uint64_t seed = 1;              ///< of the first weights

  bool cuts() const { return final_cut.value_or(generator == GeneratorKind::cnn); }

  void list_fields(FieldList& list) {
    list.add(generator, {.key = "generator",
                         .help = "cnn: a window at once, coarse to fine; rnn: frame by frame, for any length",
                         .saved = false});  // it is the kind of the file
    list.add(final_cut, {.key = "final_cut",
                         .help = "generate twice the frames and keep half of them [on for the CNN generator]"});
    list.add(hidden, {.key = "hidden", .help = "width of the networks", .range = Range::between(1, 65536)});
    list.add(taps, {.key = "taps", .help = "taps of the convolutions: 3 or 5", .choices = {3, 5}});
  }
};

struct GenerateOptions {
  std::size_t count = 1;
  std::uint64_t seed =
      1;  ///< another seed is another motion; the same one gives the same motion on the same device
  std::size_t first_sample = 0;  ///< sample i of a seed is the same whatever the count
  std::size_t frames = 0;        ///< of each motion; 0: the model's N. Others need an RNN generator
};

/// A text-conditioned generator of motion (Lin & Amer; SPEC 2).
class Dvgan {
 public:
  Dvgan(const Context& context, motion::MotionFormat format, const DvganOptions& options = {})
      : context_(context),
        format_(std::move(format)),
        options_(checked(options)),
        generator_(make_generator(context, format_, options)) {}

  const Context& context() const { return context_; }
  const motion::MotionFormat& format() const { return format_; }
  const DvganOptions& options() const { return options_; }

  bool is_recurrent() const { return options_.generator == GeneratorKind::rnn; }
  const CnnGenerator& cnn() const {
    require(!is_recurrent(), "this model has an RNN generator, a CNN generator was asked for");
    return std::get<CnnGenerator>(generator_);
  }
  /// The generator that goes on frame by frame: Error where the model has the other one.
  const RnnGenerator& rnn() const {
    require(
        is_recurrent(), "this model has a CNN generator, which makes its ", format_.frames,
        " frames at once: it cannot complete a motion, go on for longer or be asked frame by frame. Train a "
        "model with an RNN generator for that (motiongan train dvgan --generator rnn)");
    return std::get<RnnGenerator>(generator_);
  }

  /// Parameters by PyTorch's names.
  void list_parameters(ParameterList& list) {
    std::visit([&](auto& generator) { generator.list_parameters(list); }, generator_);
  }

  /// Motion [N, B, M], normalised, for a batch of sentences; what training makes its fakes with.
  Var forward(const Sentences& text, const RandomKey& key) const {
    if (is_recurrent()) {
      const RnnGenerator& generator = rnn();
      return generator(text, generator.noise(context_, key, text.batch, generator.frames_made()),
                       generator.cuts(context_, key, text.batch));
    }
    const Indices cut = cnn().cuts(context_, key, text.batch);
    return cnn()(text, cnn().noise(context_, key, text.batch, cut), cut);
  }

  /// The same with given first frames, `seed` [n, B, M], 1 <= n <= N: completions of N frames, never cut.
  /// Error for a CNN generator.
  Var complete(const Sentences& text, const Var& seed, const RandomKey& key) const {
    return rnn()(text, rnn().noise(context_, key, text.batch, format_.frames), {}, seed);
  }

  /// Normalised poses of `count` motions, each [frames, dof], one after the other. A caption without a word
  /// is an Error; words that the training captions did not have count as unknown. A motion that is not of N
  /// frames is not cut out of a longer one.
  std::vector<std::vector<float>> generate_poses(const std::string& caption,
                                                 const GenerateOptions& options) const {
    const NoGrad values_only;
    const std::vector<int> sentence = format_.vocabulary.encode(caption);
    const std::size_t frames = options.frames > 0 ? options.frames : format_.frames, dof = format_.dof();
    if (frames != format_.frames) rnn();  // refuses where there is none
    std::vector<std::vector<float>> all(options.count, std::vector<float>(frames * dof));
    constexpr std::size_t most = 64, piece = 64;  // samples and frames at a time
    for (std::size_t first = 0; first < options.count; first += most) {
      const std::size_t batch = std::min(most, options.count - first);
      const auto first_sample = static_cast<std::uint32_t>(options.first_sample + first);
      const auto keep = [&](std::span<const float> values, std::size_t from) {  // [some frames, batch, dof]
        for (std::size_t row = 0; row < values.size() / dof; ++row)
          std::copy_n(
              values.begin() + static_cast<std::ptrdiff_t>(row * dof), dof,
              all[first + row % batch].begin() + static_cast<std::ptrdiff_t>((from + row / batch) * dof));
      };
      if (is_recurrent() && !(options_.cuts() && frames == format_.frames)) {
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

  /// Motions of the caption at the model's rate.
  std::vector<motion::Motion> generate(const std::string& caption,
                                       const GenerateOptions& options = {}) const {
    std::vector<motion::Motion> motions;
    for (const auto& poses : generate_poses(caption, options)) motions.push_back(format_.to_motion(poses));
    return motions;
  }

  /// Writes the weights (PyTorch's names and shapes) and everything that is needed to generate, as one
  /// safetensors file.
  void save(const std::filesystem::path& path) { save_model(*this, path); }

  /// A model that save() wrote, or the generator of a run's checkpoint. Throws Error, naming the file and what
  /// is wrong with it, for any other.
  static Dvgan load(const Context& context, const std::filesystem::path& path) {
    return load_model<Dvgan>(context, path);
  }

  // What model_file.hpp needs.
  using Options = DvganOptions;
  using Format = motion::MotionFormat;
  static constexpr NameTable<GeneratorKind, 2> file_kinds{
      {{GeneratorKind::cnn, "dvgan_cnn_generator"}, {GeneratorKind::rnn, "dvgan_rnn_generator"}}};
  static constexpr const char* part_name = "generator";
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
                                 .final_cut = options.cuts()});
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

// DVGAN as its user sees it: a generator, and the format that turns its numbers into motion. One file holds
// both.
#pragma once
#include <nlohmann/json.hpp>

#include "motiongan/io/motion_format_json.hpp"
#include "motiongan/io/state_dict.hpp"
#include "motiongan/models/cnn_generator.hpp"

namespace motiongan {

struct DvganOptions {
  std::size_t hidden = 256;  ///< k
  std::size_t taps = 3;      ///< of the convolutions: 3 or 5
  bool final_cut = true;     ///< make 2N frames, keep N
  std::uint64_t seed = 1;    ///< of the first weights
};

struct GenerateOptions {
  std::size_t count = 1;
  std::uint64_t seed =
      1;  ///< another seed is another motion; the same one gives the same motion on the same device
  std::size_t first_sample = 0;  ///< sample i of a seed is the same whatever the count
};

/// A text-conditioned generator of motion (Lin & Amer; SPEC 2).
class Dvgan {
 public:
  Dvgan(const Context& context, motion::MotionFormat format, const DvganOptions& options = {})
      : context_(context),
        format_(std::move(format)),
        options_(options),
        generator_(Initializer(context, options.seed), {.vocabulary = format_.vocabulary.size(),
                                                        .dof = format_.dof(),
                                                        .frames = format_.frames,
                                                        .hidden = options.hidden,
                                                        .taps = options.taps,
                                                        .final_cut = options.final_cut}) {}

  const Context& context() const { return context_; }
  const motion::MotionFormat& format() const { return format_; }
  const DvganOptions& options() const { return options_; }
  CnnGenerator& generator() { return generator_; }
  const CnnGenerator& generator() const { return generator_; }

  /// Normalised poses of `count` motions, each [frames, dof], one after the other. A caption without a word
  /// is an Error; words that the training captions did not have count as unknown.
  std::vector<std::vector<float>> generate_poses(const std::string& caption,
                                                 const GenerateOptions& options) const {
    const NoGrad values_only;
    const std::vector<int> sentence = format_.vocabulary.encode(caption);
    const std::size_t frames = format_.frames, dof = format_.dof();
    std::vector<std::vector<float>> all;
    constexpr std::size_t most = 64;  // samples at a time
    for (std::size_t first = 0; first < options.count; first += most) {
      const std::size_t batch = std::min(most, options.count - first);
      const RandomKey key{.seed = options.seed,
                          .first_sample = static_cast<std::uint32_t>(options.first_sample + first)};
      const Sentences text(context_, std::vector<std::vector<int>>(batch, sentence),
                           format_.vocabulary.size());
      const Indices cut = generator_.cuts(context_, key, batch);
      const Var motion = generator_(text, generator_.noise(context_, key, batch, cut), cut);
      const std::vector<float> values = motion.value().to_host();
      for (std::size_t b = 0; b < batch; ++b) {
        std::vector<float> poses(frames * dof);
        for (std::size_t t = 0; t < frames; ++t)
          std::copy_n(values.begin() + static_cast<std::ptrdiff_t>((t * batch + b) * dof), dof,
                      poses.begin() + static_cast<std::ptrdiff_t>(t * dof));
        all.push_back(std::move(poses));
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
  void save(const std::filesystem::path& path) {
    io::SafeTensors file;
    describe(file);
    io::save_parameters(named_parameters(generator_), file);
    file.write(path);
  }

  /// A model that save() wrote, or the generator of a run's checkpoint. Throws, naming the file and what is
  /// wrong, for any other.
  static Dvgan load(const Context& context, const std::filesystem::path& path) {
    const io::SafeTensors file = io::SafeTensors::read(path);
    Dvgan model = from_description(context, file, path.string());
    const bool is_checkpoint = file.tensors.contains("generator.decode.weight");
    io::load_parameters(named_parameters(model.generator_), file, path.string(),
                        is_checkpoint ? "generator." : "");
    return model;
  }

  /// Adds the metadata of a model file: which model it is, its options and its motion format.
  void describe(io::SafeTensors& file) const {
    file.metadata["motiongan_model"] = model_name;
    file.metadata["options"] = nlohmann::json{
        {"hidden", options_.hidden},
        {"taps", options_.taps},
        {"final_cut",
         options_.final_cut}}.dump();
    file.metadata["format"] = io::to_json(format_).dump();
  }

  /// A model, with fresh weights, as a file's metadata describe it.
  static Dvgan from_description(const Context& context, const io::SafeTensors& file,
                                const std::string& where) {
    const auto found = file.metadata.find("motiongan_model");
    require(found != file.metadata.end(), where,
            ": not a motiongan model (no \"motiongan_model\" in its metadata)");
    require(found->second == model_name, where, ": holds a model called \"", found->second, "\", expected ",
            model_name);
    try {
      const auto options = nlohmann::json::parse(file.metadata.at("options"));
      DvganOptions read;
      read.hidden = options.at("hidden").get<std::size_t>();
      read.taps = options.at("taps").get<std::size_t>();
      read.final_cut = options.at("final_cut").get<bool>();
      require(read.hidden > 0 && read.hidden <= 65536 && (read.taps == 3 || read.taps == 5), "hidden ",
              read.hidden, " or taps ", read.taps, " is out of range");
      return Dvgan(context, io::motion_format_from_json(nlohmann::json::parse(file.metadata.at("format"))),
                   read);
    } catch (const Error& error) {
      throw Error(where, ": ", error.what());
    } catch (const std::exception& error) {  // nlohmann's own, and missing keys
      throw Error(where, ": the model's metadata cannot be read: ", error.what());
    }
  }

  static constexpr const char* model_name = "dvgan_cnn_generator";

 private:
  Context context_;
  motion::MotionFormat format_;
  DvganOptions options_;
  CnnGenerator generator_;
};

}  // namespace motiongan

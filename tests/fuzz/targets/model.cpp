// Model files and checkpoints up to their weights: kind, options, format and notes. No device is needed.
#include <motiongan/models/action_gan.hpp>
#include <motiongan/models/dvgan.hpp>
#include <motiongan/models/prediction_model.hpp>
#include <motiongan/models/ranker.hpp>
#include <motiongan/train/checkpoint.hpp>

#include "../memory_folder.hpp"
#include "../mutate_safetensors.hpp"

namespace motiongan::fuzz {
namespace {

/// A format that can be read gives motion, and can be written as it was.
void use(const motion::MotionFormat& format) {
  const std::vector<float> poses(2 * format.dof(), 0.5F);
  const motion::Motion motion = format.to_motion(poses);
  demand(motion.frames == 2, "two poses make two frames");
  const std::string text = must("a format can be written", [&] { return io::to_text(format); });
  must("a written format can be read", [&] { return io::motion_format_from_text(text, "again"); });
}
void use(const motion::PositionFormat& format) {
  const std::vector<float> poses(2 * format.dof(), 0.5F);
  demand(format.decode(poses).size() == 2 * format.skeleton().size(), "two poses make two frames");
  demand(format.bone_map().size() == format.bone_shift().size() * format.dof(), "bones have their map");
  const std::string text = must("a format can be written", [&] { return io::to_text(format); });
  must("a written format can be read", [&] { return io::position_format_from_text(text, "again"); });
}
void use(PredictionFormat format) { check_options(format); }

template <class Model>
void read_as(const io::SafeTensors& file) {
  if (!holds_model<Model>(file)) return;
  model_options<Model>(file, "input");
  use(model_format<Model>(file, "input"));
}

}  // namespace

const Target model_target{"model",
                          [](std::string_view bytes) {
                            const auto file =
                                io::SafeTensors::read(memory_folder().write("model.safetensors", bytes));
                            if (is_checkpoint(file)) read_run_record(file, "input");
                            read_as<Dvgan>(file);
                            read_as<Ranker>(file);
                            read_as<ActionGan>(file);
                            read_as<PredictionModel>(file);
                          },
                          mutate_safetensors};

}  // namespace motiongan::fuzz

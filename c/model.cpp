// Models, joints, and what is common to all handles.
#include <cstdlib>
#include <filesystem>

#include "handles.hpp"
#include "motiongan/core/context.hpp"
#include "motiongan/io/safetensors.hpp"
#include "motiongan/models/shipped_models.hpp"
#include "motiongan/train/run_folder.hpp"

namespace motiongan::c {

Model::Model(std::variant<Dvgan, ActionGan> loaded) : network(std::move(loaded)) {
  std::visit(
      [&](const auto& model) {
        skeleton = CharacterStream::skeleton_of(model);
        rate = model.format().rate;
        frames = model.format().frames;
        unit_metres = model.format().space.unit_metres;
      },
      network);
  if (actions()) {
    prompts = actions()->format().classes;
  } else {
    const std::vector<std::string>& words = texts()->format().vocabulary.words();
    prompts.assign(words.begin() + 1, words.end());  // the first stands for unknown words
  }
}

motion::Motion as_prior(const Clip& clip, const Model& model) {
  return motion::scaled(clip.motion, motion::scale_to(model.skeleton, clip.motion.skeleton));
}

std::size_t width_of(motiongan_quantity quantity) {
  require_argument(quantity >= MOTIONGAN_LOCAL_ROTATIONS && quantity <= MOTIONGAN_GLOBAL_POSITIONS,
                   "quantity is ", quantity, ", expected a value of motiongan_quantity, 1 to 3");
  return quantity == MOTIONGAN_LOCAL_ROTATIONS ? 4 : 3;
}

float* put(std::span<const motion::Quat> rotations, float* out) {
  for (const motion::Quat& q : rotations)
    for (const double v : {q.x, q.y, q.z, q.w}) *out++ = static_cast<float>(v);
  return out;
}

float* put(std::span<const motion::Vec3> positions, float* out) {
  for (const motion::Vec3& p : positions)
    for (const double v : p) *out++ = static_cast<float>(v);
  return out;
}

namespace {

/// The model in a file, or in the folder of a run.
std::shared_ptr<Model> load(const std::filesystem::path& given, const char* device) {
  const std::filesystem::path path = model_file(given);
  const io::SafeTensors file = io::SafeTensors::read(path);
  const std::string where = path.string();
  const bool texts = holds_model<Dvgan>(file);
  require(texts || holds_model<ActionGan>(file), where, ": holds a model called \"", model_kind(file, where),
          "\", which makes no motion; give one of motiongan train dvgan or train attention");
  const Context context({.device = device == nullptr ? "" : device});
  // Registered after the driver's own handlers, so it runs before them: see finish_all_contexts().
  static const bool ends_in_order = std::atexit(finish_all_contexts) == 0;
  static_cast<void>(ends_in_order);
  auto model = texts ? std::make_shared<Model>(model_from<Dvgan>(context, file, where))
                     : std::make_shared<Model>(model_from<ActionGan>(context, file, where));
  context.finish();
  return model;
}

/// Writes one property of a model.
template <class T, class Read>
motiongan_status read_model(motiongan_model model, T* out, const char* name, const Read& read) {
  return call([&] {
    require_given(out, name);
    *out = static_cast<T>(read(*get<Model>(model)));
  });
}

/// The skeleton of a model or a clip, and what owns it.
struct Joints {
  std::shared_ptr<const Object> owner;
  const motion::Skeleton& skeleton;
};
Joints joints_of(std::uint64_t handle) {
  const std::shared_ptr<Object> object = Registry::instance().find(handle);
  if (const auto model = std::dynamic_pointer_cast<Model>(object)) return {object, model->skeleton};
  if (const auto clip = std::dynamic_pointer_cast<Clip>(object)) return {object, clip->motion.skeleton};
  throw CallError(MOTIONGAN_INVALID_HANDLE, "handle ", handle, " is ", object->kind(),
                  ", expected a model or a clip");
}

void check_index(std::size_t index, std::size_t count, const char* what) {
  require_argument(index < count, what, " is ", index, ", expected less than ", count);
}

}  // namespace
}  // namespace motiongan::c

using namespace motiongan;
using namespace motiongan::c;

const char* motiongan_version(void) { return MOTIONGAN_VERSION_STRING; }

const char* motiongan_status_name(motiongan_status status) {
  static constexpr const char* names[] = {"MOTIONGAN_OK",
                                          "MOTIONGAN_INVALID_ARGUMENT",
                                          "MOTIONGAN_INVALID_HANDLE",
                                          "MOTIONGAN_BUFFER_TOO_SMALL",
                                          "MOTIONGAN_FAILED",
                                          "MOTIONGAN_DEVICE_FAILED",
                                          "MOTIONGAN_OUT_OF_MEMORY",
                                          "MOTIONGAN_INTERNAL_ERROR"};
  const bool known = status >= 0 && static_cast<std::size_t>(status) < std::size(names);
  return known ? names[status] : "unknown status";
}

const char* motiongan_last_error(void) { return last_error().get(); }

motiongan_status motiongan_close(std::uint64_t handle) {
  return call([&] { Registry::instance().take(handle); });
}

motiongan_status motiongan_shipped_count(std::size_t* count) {
  return call([&] {
    require_given(count, "count");
    *count = shipped_models().size();
  });
}

motiongan_status motiongan_shipped_name(std::size_t index, const char** name) {
  return call([&] {
    require_given(name, "name");
    const std::vector<ShippedModel> models = shipped_models();
    check_index(index, models.size(), "index");
    thread_local std::string kept;
    kept = models[index].name;
    *name = kept.c_str();
  });
}

motiongan_status motiongan_model_open(const char* path, const char* device, motiongan_model* model) {
  return call([&] {
    require_given(path, "path");
    require_given(model, "model");
    *model = Registry::instance().add(load(path, device));
  });
}

motiongan_status motiongan_model_kind(motiongan_model model, motiongan_kind* kind) {
  return read_model(model, kind, "kind", [](const Model& m) {
    return m.actions()                 ? MOTIONGAN_CLASSES
           : m.texts()->is_recurrent() ? MOTIONGAN_TEXT_STREAM
                                       : MOTIONGAN_TEXT_WINDOW;
  });
}

motiongan_status motiongan_model_rate(motiongan_model model, double* rate) {
  return read_model(model, rate, "rate", [](const Model& m) { return m.rate; });
}

motiongan_status motiongan_model_unit(motiongan_model model, double* metres) {
  return read_model(model, metres, "metres", [](const Model& m) { return m.unit_metres; });
}

motiongan_status motiongan_model_frames(motiongan_model model, std::size_t* frames) {
  return read_model(model, frames, "frames", [](const Model& m) { return m.frames; });
}

motiongan_status motiongan_model_prompt_count(motiongan_model model, std::size_t* count) {
  return read_model(model, count, "count", [](const Model& m) { return m.prompts.size(); });
}

motiongan_status motiongan_model_prompt(motiongan_model model, std::size_t index, const char** prompt) {
  return read_model(model, prompt, "prompt", [&](const Model& m) {
    check_index(index, m.prompts.size(), "index");
    return m.prompts[index].c_str();
  });
}

motiongan_status motiongan_joint_count(std::uint64_t handle, std::size_t* count) {
  return call([&] {
    require_given(count, "count");
    *count = joints_of(handle).skeleton.size();
  });
}

motiongan_status motiongan_joint_name(std::uint64_t handle, std::size_t joint, const char** name) {
  return call([&] {
    require_given(name, "name");
    const Joints joints = joints_of(handle);
    check_index(joint, joints.skeleton.size(), "joint");
    *name = joints.skeleton.joints[joint].name.c_str();
  });
}

motiongan_status motiongan_joint_parents(std::uint64_t handle, std::int32_t* parents, std::size_t length) {
  return call([&] {
    const Joints joints = joints_of(handle);
    require_room(parents, "parents", length, joints.skeleton.size());
    for (const motion::Joint& joint : joints.skeleton.joints) *parents++ = joint.parent;
  });
}

motiongan_status motiongan_joint_offsets(std::uint64_t handle, float* offsets, std::size_t length) {
  return call([&] {
    const Joints joints = joints_of(handle);
    require_room(offsets, "offsets", length, 3 * joints.skeleton.size());
    for (const motion::Joint& joint : joints.skeleton.joints) offsets = put({&joint.offset, 1}, offsets);
  });
}

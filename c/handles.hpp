// The objects behind the handles of the C interface, and the registry that finds them.
#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "call.hpp"
#include "motiongan/models/action_gan.hpp"
#include "motiongan/models/dvgan.hpp"
#include "motiongan/sample/character_stream.hpp"

namespace motiongan::c {

/// Anything that has a handle.
struct Object {
  Object() = default;
  Object(const Object&) = delete;
  Object& operator=(const Object&) = delete;
  virtual ~Object() = default;
  virtual const char* kind() const = 0;
};

/// A model with the context that it alone uses. A context serves one thread at a time: whoever computes with
/// it, or with a stream of it, holds `busy`. All else is never changed.
struct Model : Object {
  static constexpr const char* name = "a model";
  explicit Model(std::variant<Dvgan, ActionGan> loaded);

  const char* kind() const override { return name; }
  const Dvgan* texts() const { return std::get_if<Dvgan>(&network); }
  const ActionGan* actions() const { return std::get_if<ActionGan>(&network); }

  std::mutex busy;
  std::variant<Dvgan, ActionGan> network;
  motion::Skeleton skeleton;         ///< of its motion
  std::vector<std::string> prompts;  ///< words or classes
  double rate = 0, unit_metres = 0;
  std::size_t frames = 0;  ///< N or T
};

/// A motion; never changed.
struct Clip : Object {
  static constexpr const char* name = "a clip";
  Clip(motion::Motion made, double unit) : motion(std::move(made)), unit_metres(unit) {}
  const char* kind() const override { return name; }

  const motion::Motion motion;
  const double unit_metres;  ///< 0: unknown
};

/// The characters of a model, used and destroyed by who holds model->busy.
struct Stream : Object {
  static constexpr const char* name = "a stream";
  explicit Stream(std::shared_ptr<Model> of) : model(std::move(of)) {}
  ~Stream() override {
    const std::lock_guard hold(model->busy);
    characters.reset();
  }
  const char* kind() const override { return name; }

  const std::shared_ptr<Model> model;
  std::optional<CharacterStream> characters;
};

/// All live handles. They count up and are never used again, so a closed one is always found out.
class Registry {
 public:
  /// Never destroyed: at the end of the process, parts of the OpenCL driver are gone before it would be.
  static Registry& instance() {
    static Registry* const registry = new Registry;
    return *registry;
  }

  std::uint64_t add(std::shared_ptr<Object> object) {
    const std::lock_guard hold(mutex_);
    objects_.emplace(next_, std::move(object));
    return next_++;
  }

  /// Throws CallError if there is no such handle.
  std::shared_ptr<Object> find(std::uint64_t handle) const {
    const std::lock_guard hold(mutex_);
    const auto found = objects_.find(handle);
    if (found == objects_.end())
      throw CallError(MOTIONGAN_INVALID_HANDLE, "handle ", handle,
                      handle > 0 && handle < next_ ? " is closed" : " was never given out",
                      ", expected one that is open");
    return found->second;
  }

  /// The same, and forgets the handle.
  std::shared_ptr<Object> take(std::uint64_t handle) {
    std::shared_ptr<Object> object = find(handle);
    const std::lock_guard hold(mutex_);
    objects_.erase(handle);
    return object;
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::uint64_t, std::shared_ptr<Object>> objects_;
  std::uint64_t next_ = 1;
};

/// The object of a handle. Throws CallError if there is none or it is of another kind.
template <class T>
std::shared_ptr<T> get(std::uint64_t handle) {
  std::shared_ptr<Object> object = Registry::instance().find(handle);
  std::shared_ptr<T> wanted = std::dynamic_pointer_cast<T>(object);
  if (!wanted)
    throw CallError(MOTIONGAN_INVALID_HANDLE, "handle ", handle, " is ", object->kind(), ", expected ",
                    T::name);
  return wanted;
}

/// The most joints times frames of a clip.
inline constexpr std::size_t most_poses = 50'000'000;

/// Throws CallError if a clip of so many frames would be too large.
inline void check_frames(std::size_t frames, std::size_t joints) {
  require_argument(frames <= most_poses / joints, "frames is ", frames, ", expected at most ",
                   most_poses / joints, " for ", joints, " joints");
}

/// The clip as a prior of the model's size, as the command scales it too.
motion::Motion as_prior(const Clip& clip, const Model& model);

/// Values per joint of a motiongan_quantity. Throws CallError if it is none.
std::size_t width_of(motiongan_quantity quantity);

/// Writes quaternions in the caller's order, or vectors, and returns where the next would go.
float* put(std::span<const motion::Quat> rotations, float* out);
float* put(std::span<const motion::Vec3> positions, float* out);

}  // namespace motiongan::c

// Clips: made by a model, read from a file or from arrays, and written.
#include <cmath>
#include <filesystem>

#include "handles.hpp"
#include "motiongan/formats/bvh_writer.hpp"
#include "motiongan/formats/glb.hpp"
#include "motiongan/formats/read_motion.hpp"

namespace motiongan::c {
namespace {

/// The next `frames` frames of a character alone.
motion::Motion followed(CharacterStream& stream, const CharacterStart& start, std::size_t frames) {
  const CharacterStream::Id id = stream.add(start);
  motion::Motion out;
  for (std::size_t f = 0; f < frames; ++f) {
    stream.step();
    if (f == 0) out = stream.motion(id);
    if (f == 0) continue;
    const auto rotations = stream.rotations(id);
    const auto positions = stream.positions(id);
    out.rotations.insert(out.rotations.end(), rotations.begin(), rotations.end());
    out.positions.insert(out.positions.end(), positions.begin(), positions.end());
    ++out.frames;
  }
  return out;
}

motion::Motion make(Model& model, const char* prompt, std::size_t frames, std::uint64_t seed,
                    std::uint32_t sample, const Clip* given) {
  if (frames == 0) frames = model.frames;
  check_frames(frames, model.skeleton.size());
  const std::lock_guard hold(model.busy);
  if (const Dvgan* const texts = model.texts(); texts && given == nullptr)
    return texts->generate(prompt, {.seed = seed, .first_sample = sample, .frames = frames}).front();
  motion::Motion prior;
  CharacterStart start{.prompt = prompt, .seed = seed, .sample = sample};
  if (given != nullptr) {
    prior = as_prior(*given, model);
    start.prior = &prior;
  }
  return std::visit(
      [&](const auto& network) {
        CharacterStream stream(network);
        return followed(stream, start, frames);
      },
      model.network);
}

/// A motion of the model's joints from the caller's arrays.
motion::Motion from_arrays(const Model& model, double rate, std::size_t frames, const float* rotations,
                           const float* positions) {
  motion::Motion out;
  out.skeleton = model.skeleton;
  out.rate = rate;
  out.frames = frames;
  const std::size_t joints = model.skeleton.size();
  for (std::size_t i = 0; i < frames * joints; ++i, rotations += 4, positions += 3) {
    const auto at = [&] { return concat("frame ", i / joints, ", joint ", i % joints); };
    try {
      out.rotations.push_back(motion::normalize({rotations[3], rotations[0], rotations[1], rotations[2]}));
    } catch (const Error& error) {
      throw CallError(MOTIONGAN_INVALID_ARGUMENT, at(), ": ", error.what());
    }
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (!std::isfinite(positions[axis]))
        throw CallError(MOTIONGAN_INVALID_ARGUMENT, at(), ": the position is ", positions[axis],
                        ", expected a finite number");
    out.positions.push_back({positions[0], positions[1], positions[2]});
  }
  for (std::size_t j = 1; j < joints; ++j) out.skeleton.joints[j].offset = out.positions[j];
  return out;
}

}  // namespace
}  // namespace motiongan::c

using namespace motiongan;
using namespace motiongan::c;

motiongan_status motiongan_clip_make(motiongan_model model, const char* prompt, std::size_t frames,
                                     std::uint64_t seed, std::uint32_t sample, motiongan_clip prior,
                                     motiongan_clip* clip) {
  return call([&] {
    require_given(prompt, "prompt");
    require_given(clip, "clip");
    const std::shared_ptr<Model> by = get<Model>(model);
    const std::shared_ptr<Clip> given = prior == 0 ? nullptr : get<Clip>(prior);
    *clip = Registry::instance().add(
        std::make_shared<Clip>(make(*by, prompt, frames, seed, sample, given.get()), by->unit_metres));
  });
}

motiongan_status motiongan_clip_read(const char* path, motiongan_clip* clip) {
  return call([&] {
    require_given(path, "path");
    require_given(clip, "clip");
    motion::LoadedMotion loaded = motion::read_motion(path);
    *clip = Registry::instance().add(std::make_shared<Clip>(std::move(loaded.motion), loaded.unit_metres));
  });
}

motiongan_status motiongan_clip_from_arrays(motiongan_model model, double rate, std::size_t frames,
                                            const float* rotations, std::size_t rotations_length,
                                            const float* positions, std::size_t positions_length,
                                            motiongan_clip* clip) {
  return call([&] {
    require_given(clip, "clip");
    const std::shared_ptr<Model> of = get<Model>(model);
    const std::size_t joints = of->skeleton.size();
    require_argument(std::isfinite(rate) && rate > 0, "rate is ", rate,
                     " frames per second, expected more than 0");
    require_argument(frames > 0, "frames is 0, expected at least 1");
    check_frames(frames, joints);
    require_room(rotations, "rotations", rotations_length, 4 * frames * joints);
    require_room(positions, "positions", positions_length, 3 * frames * joints);
    *clip = Registry::instance().add(
        std::make_shared<Clip>(from_arrays(*of, rate, frames, rotations, positions), of->unit_metres));
  });
}

motiongan_status motiongan_clip_frames(motiongan_clip clip, std::size_t* frames) {
  return call([&] {
    require_given(frames, "frames");
    *frames = get<Clip>(clip)->motion.frames;
  });
}

motiongan_status motiongan_clip_rate(motiongan_clip clip, double* rate) {
  return call([&] {
    require_given(rate, "rate");
    *rate = get<Clip>(clip)->motion.rate;
  });
}

motiongan_status motiongan_clip_get(motiongan_clip clip, motiongan_quantity quantity, float* out,
                                    std::size_t length) {
  return call([&] {
    const std::size_t width = width_of(quantity);
    const std::shared_ptr<Clip> of = get<Clip>(clip);
    require_room(out, "out", length, width * of->motion.positions.size());
    if (quantity == MOTIONGAN_LOCAL_ROTATIONS)
      put(of->motion.rotations, out);
    else if (quantity == MOTIONGAN_LOCAL_POSITIONS)
      put(of->motion.positions, out);
    else
      put(motion::joint_positions(of->motion), out);
  });
}

motiongan_status motiongan_clip_write(motiongan_clip clip, const char* path) {
  return call([&] {
    require_given(path, "path");
    const std::shared_ptr<Clip> of = get<Clip>(clip);
    const std::filesystem::path file = path;
    const std::string ending = motion::extension_of(file);
    require_argument(ending == ".bvh" || ending == ".glb", "path is ", path,
                     ", expected a file name that ends in "
                     ".bvh or .glb");
    if (ending == ".bvh") return motion::write_bvh(file, of->motion);
    const motion::NamedMotion named{file.stem().string(), of->motion};
    motion::write_glb(file, {&named, 1}, {.unit_metres = of->unit_metres});
  });
}

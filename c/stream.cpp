// Streams: the characters of a model, frame by frame.
#include "handles.hpp"

namespace motiongan::c {
namespace {

constexpr std::size_t most_at_once = 65536;

/// Works on the characters of a stream, alone.
template <class Work>
motiongan_status on_stream(motiongan_stream handle, const Work& work) {
  return call([&] {
    const std::shared_ptr<Stream> stream = get<Stream>(handle);
    const std::lock_guard hold(stream->model->busy);
    work(*stream->characters, *stream->model);
  });
}

CharacterStream::Id known(const CharacterStream& stream, std::uint64_t id) {
  if (!stream.contains(id))
    throw CallError(MOTIONGAN_INVALID_HANDLE, "there is no character ", id,
                    " in the stream; it may have been removed");
  return id;
}

/// Starts as the library takes them. Priors with the same handle are one motion, kept in `priors`.
std::vector<CharacterStart> starts_of(std::span<const motiongan_start> given, const Model& model,
                                      std::map<motiongan_clip, motion::Motion>& priors) {
  std::vector<CharacterStart> out;
  for (const motiongan_start& g : given) {
    const std::size_t number = out.size();
    require_argument(g.prompt != nullptr, "the prompt of start ", number,
                     " is NULL, expected a text or a class");
    require_argument(g.placed <= 1, "placed of start ", number, " is ", g.placed, ", expected 0 or 1");
    CharacterStart start{.prompt = g.prompt, .seed = g.seed, .sample = g.sample};
    if (g.placed == 1) {
      require_argument(std::isfinite(g.x) && std::isfinite(g.z) && std::isfinite(g.yaw), "start ", number,
                       " is placed at x ", g.x, ", z ", g.z, ", yaw ", g.yaw, ", expected finite numbers");
      start.at = motion::RootTrack{g.x, g.z, g.yaw};
    }
    if (g.prior != 0) {
      if (!priors.contains(g.prior)) priors[g.prior] = as_prior(*get<Clip>(g.prior), model);
      start.prior = &priors.at(g.prior);
    }
    out.push_back(std::move(start));
  }
  return out;
}

}  // namespace
}  // namespace motiongan::c

using namespace motiongan;
using namespace motiongan::c;

motiongan_status motiongan_stream_create(motiongan_model model, motiongan_stream* stream) {
  return call([&] {
    require_given(stream, "stream");
    const std::shared_ptr<Model> of = get<Model>(model);
    const auto made = std::make_shared<Stream>(of);
    {
      const std::lock_guard hold(of->busy);
      std::visit([&](const auto& network) { made->characters.emplace(network); }, of->network);
    }
    *stream = Registry::instance().add(made);
  });
}

motiongan_status motiongan_stream_add(motiongan_stream stream, const motiongan_start* starts,
                                      std::size_t count, std::uint64_t* ids) {
  return on_stream(stream, [&](CharacterStream& characters, const Model& model) {
    require_argument(count <= most_at_once, "count is ", count, ", expected at most ", most_at_once);
    if (count == 0) return;
    require_given(starts, "starts");
    require_given(ids, "ids");
    std::map<motiongan_clip, motion::Motion> priors;
    for (const CharacterStream::Id id : characters.add(starts_of({starts, count}, model, priors)))
      *ids++ = id;
  });
}

motiongan_status motiongan_stream_remove(motiongan_stream stream, std::uint64_t id) {
  return on_stream(
      stream, [&](CharacterStream& characters, const Model&) { characters.remove(known(characters, id)); });
}

motiongan_status motiongan_stream_set_prompt(motiongan_stream stream, std::uint64_t id, const char* prompt) {
  return on_stream(stream, [&](CharacterStream& characters, const Model&) {
    require_given(prompt, "prompt");
    characters.set_prompt(known(characters, id), prompt);
  });
}

motiongan_status motiongan_stream_step(motiongan_stream stream) {
  return on_stream(stream, [](CharacterStream& characters, const Model&) { characters.step(); });
}

motiongan_status motiongan_stream_count(motiongan_stream stream, std::size_t* count) {
  return on_stream(stream, [&](CharacterStream& characters, const Model&) {
    require_given(count, "count");
    *count = characters.size();
  });
}

motiongan_status motiongan_stream_ids(motiongan_stream stream, std::uint64_t* ids, std::size_t length) {
  return on_stream(stream, [&](CharacterStream& characters, const Model&) {
    require_room(ids, "ids", length, characters.size());
    std::copy(characters.ids().begin(), characters.ids().end(), ids);
  });
}

motiongan_status motiongan_stream_get(motiongan_stream stream, const std::uint64_t* ids, std::size_t count,
                                      motiongan_quantity quantity, float* out, std::size_t length) {
  return on_stream(stream, [&](CharacterStream& characters, const Model& model) {
    const std::size_t width = width_of(quantity) * model.skeleton.size();
    require_argument(ids != nullptr || count == characters.size(), "ids is NULL and count is ", count,
                     ", expected the number of all characters, ", characters.size());
    require_argument(count <= std::numeric_limits<std::size_t>::max() / width, "count is ", count,
                     ", expected a number of characters");
    require_room(out, "out", length, width * count);
    const auto id_of = [&](std::size_t i) { return ids != nullptr ? ids[i] : characters.ids()[i]; };
    // All are checked before any is written.
    for (std::size_t i = 0; i < count; ++i) characters.rotations(known(characters, id_of(i)));
    for (std::size_t i = 0; i < count; ++i) {
      const CharacterStream::Id id = id_of(i);
      if (quantity == MOTIONGAN_LOCAL_ROTATIONS)
        out = put(characters.rotations(id), out);
      else
        out = put(quantity == MOTIONGAN_LOCAL_POSITIONS ? characters.positions(id)
                                                        : characters.global_positions(id),
                  out);
    }
  });
}

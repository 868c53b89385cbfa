// Priors, the seconds of motion that an attention model continues: read from files, or drawn from a run's
// clips.
#include "generate/action_priors.hpp"

#include <cmath>
#include <map>
#include <optional>

#include "motiongan/core/random.hpp"
#include "motiongan/data/clip_source.hpp"
#include "motiongan/formats/text_file.hpp"
#include "motiongan/motion/root_joint.hpp"
#include "motiongan/train/run.hpp"
#include "shared/clip_reading.hpp"

namespace motiongan::command {
namespace {

/// A clip in the model's format, and its joint rotations if the file has them.
struct SourceClip {
  motion::PositionClip clip;
  std::optional<motion::Motion> motion;
};

SourceClip source_of(motion::Motion motion, const std::string& id, const motion::PositionFormat& format) {
  const int root = motion.skeleton.find(format.skeleton().joints.front().name);
  scale_to_model(motion, format.skeleton(), "the clip " + id);
  SourceClip out{clip_for(motion, format, id), {}};
  out.motion = fold_into_root(motion::resample(motion, format.rate, id), root);
  return out;
}

SourceClip read_source(const fs::path& file, const std::string& id, const motion::PositionFormat& format,
                       const ActionDataArgs& data) {
  const motion::ClipOptions& how = data.options.clips;
  if (!motion::holds_positions(file)) return source_of(read_clip(file, how, format.space).motion, id, format);
  motion::LoadedPositions loaded = motion::read_positions(file, how, format.rate);
  motion::PositionClip clip = motion::resample(loaded.clip, format.rate);
  scale_to_model(clip, format.skeleton(), "the clip " + id);
  clip.id = id;
  return {std::move(clip), {}};
}

GivenPrior take_prior(const SourceClip& source, const motion::PositionFormat& format, std::size_t first) {
  GivenPrior out;
  out.prior = prior_from(source.clip, format, first);
  out.from = fmt::format("{} from {} on", source.clip.id, duration(static_cast<double>(first) / format.rate));
  if (source.motion) {
    const auto joints = static_cast<std::ptrdiff_t>(source.clip.skeleton.size());
    const auto begin =
        source.motion->rotations.begin() + static_cast<std::ptrdiff_t>(first + format.frames - 1) * joints;
    out.reference.assign(begin, begin + joints);
  }
  return out;
}

/// The lines to draw from, shuffled by the seed.
std::vector<SplitLine> pool_of(std::vector<SplitLine> lines, const std::string& label, std::uint64_t seed,
                               const fs::path& split) {
  const auto keep = [&](const auto& wanted) {
    if (std::none_of(lines.begin(), lines.end(), wanted)) return false;
    std::erase_if(lines, [&](const SplitLine& line) { return !wanted(line); });
    return true;
  };
  if (!keep([](const SplitLine& line) { return !line.train; }))
    fmt::print("{} has no test clips: priors are drawn from training clips\n", split.string());
  if (!keep([&](const SplitLine& line) { return line.label == label; }))
    fmt::print("there is no test clip of class '{}': priors are drawn from other classes\n", label);
  const RandomKey key{.seed = seed, .stream = RandomStream::seeding};
  for (std::size_t i = lines.size(); i > 1; --i)
    std::swap(lines[i - 1], lines[random_below(key, static_cast<std::uint32_t>(i), i)]);
  return lines;
}

}  // namespace

std::vector<SplitLine> read_split(const fs::path& file) {
  std::vector<SplitLine> out;
  std::string text = motion::read_text(file, "split of a run", motion::largest_list_file);
  for (std::size_t at = 0, number = 1; at < text.size(); ++number) {
    const std::string line = text.substr(at, text.find('\n', at) - at);
    at += line.size() + 1;
    if (line.empty() || line.front() == '#') continue;
    const std::size_t first = line.find('\t'), second = line.find('\t', first + 1);
    const std::string part = line.substr(0, first);
    require(second != line.npos && (part == "train" || part == "test"), file.string(), ":", number,
            ": found '", line.substr(0, 60),
            "', expected train or test, clip id and class, separated by tabs");
    out.push_back({part == "train", line.substr(first + 1, second - first - 1),
                   line.substr(second + 1, line.find('\t', second + 1) - second - 1)});
  }
  require(!out.empty(), file.string(), " lists no clips");
  return out;
}

GivenPrior read_prior(const fs::path& file, const motion::PositionFormat& format, const ActionDataArgs& data,
                      double seconds) {
  return take_prior(read_source(file, motion::clip_stem(file), format, data), format,
                    static_cast<std::size_t>(std::lround(seconds * format.rate)));
}

std::vector<GivenPrior> kept_priors(const ActionGan& model, std::size_t label, std::size_t first_sample,
                                    std::size_t count) {
  std::vector<GivenPrior> out;
  for (std::size_t i = 0; !model.starts().empty() && i < count; ++i) {
    const ActionStart& start = *model.start(label, first_sample + i);
    const double at = static_cast<double>(start.prior.first_frame) / model.format().rate;
    out.push_back({start.prior, start.rotations, fmt::format("{} from {} on", start.prior.id, duration(at))});
  }
  return out;
}

std::vector<GivenPrior> draw_priors(const fs::path& run, const motion::PositionFormat& format,
                                    const ActionDataArgs& data, std::size_t label, std::uint64_t seed,
                                    std::size_t first_sample, std::size_t count) {
  const fs::path split = RunFiles{run}.split();
  const std::vector<SplitLine> pool = pool_of(read_split(split), format.classes[label], seed, split);
  std::map<std::string, fs::path> files;
  std::vector<motion::LabelledMotion> builtin;
  if (data.procedural > 0) {
    builtin = procedural_clips(data);
  } else {
    const auto all = motion::action_dataset_detail::clip_files(data.folder, data.options);
    const auto ids = motion::clip_ids(all, data.folder);
    for (std::size_t i = 0; i < all.size(); ++i) files[ids[i]] = all[i];
  }
  const auto source = [&](const std::string& id) {
    for (const motion::LabelledMotion& m : builtin)
      if (m.id == id) return source_of(m.motion, id, format);
    const auto found = files.find(id);
    require(found != files.end(), "clip ", id, " of ", split.string(), " is not in ",
            data.procedural > 0 ? "the built-in motion" : data.folder,
            "; give the folder of the clips with --data");
    return read_source(found->second, id, format, data);
  };
  std::vector<GivenPrior> out;
  std::map<std::string, SourceClip> read;
  const RandomKey key{.seed = seed, .stream = RandomStream::windows};
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t sample = first_sample + i;
    const std::string& id = pool[sample % pool.size()].id;
    auto at = read.find(id);
    if (at == read.end()) at = read.emplace(id, source(id)).first;
    const std::size_t frames = at->second.clip.frames;
    const std::size_t starts = frames - std::min(frames, format.frames) + 1;
    out.push_back(
        take_prior(at->second, format, random_below(key, static_cast<std::uint32_t>(sample), starts)));
  }
  return out;
}

}  // namespace motiongan::command

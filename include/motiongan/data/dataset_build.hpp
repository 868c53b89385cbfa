// Construction of a Dataset. Included by dataset.hpp.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/data/caption_parts.hpp"
#include "motiongan/data/captions.hpp"
#include "motiongan/data/clip_agreement.hpp"
#include "motiongan/data/dataset.hpp"
#include "motiongan/data/dataset_fit.hpp"
#include "motiongan/data/descriptions.hpp"
#include "motiongan/data/mirror.hpp"
#include "motiongan/data/split.hpp"
#include "motiongan/formats/bvh_reader.hpp"

namespace motiongan::motion {

namespace dataset_detail {

inline std::string two_decimals(double value) {
  char text[64];
  std::snprintf(text, sizeof text, "%.2f", value);
  return text;
}

/// The clips that a data set can use: readable, long enough, and of the skeleton that the options name.
inline std::vector<Used> choose_clips(const std::vector<ClipSource>& sources, std::vector<EncodedClip>& clips,
                                      const std::vector<std::string>& errors, Dataset& data) {
  const DatasetOptions& o = data.options;
  Skeleton only;
  if (!o.clips.skeleton_of.empty()) only = read_motion(o.clips.skeleton_of, o.clips).motion.skeleton;
  std::size_t longest = clips.size(), readable = 0;
  std::vector<Used> used;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    if (!errors[i].empty()) {
      data.bad.push_back({sources[i].id, errors[i]});
      continue;
    }
    if (only.size() > 0 && !have_same_joints(only, clips[i].skeleton)) {
      data.other_skeletons.push_back({sources[i].id, some_of(joint_differences(only, clips[i].skeleton), 4)});
      continue;
    }
    ++readable;
    data.dropped_frames += clips[i].dropped;
    if (longest == clips.size() || clips[i].seconds() > clips[longest].seconds()) longest = i;
    const std::size_t reach = (o.frames - 1) * clips[i].stride;
    if (clips[i].frames > reach) {
      used.push_back({.source = i, .clip = std::move(clips[i])});
    } else {
      data.skipped.push_back(
          {sources[i].id,
           concat(clips[i].source_frames == 0 && !sources[i].whole.empty() ? "outside its clip, " : "",
                  two_decimals(clips[i].seconds()), " s long, a window of ", o.frames, " frames at ", o.rate,
                  " per second is ", two_decimals(static_cast<double>(o.frames) / o.rate), " s")});
    }
  }
  require(readable > 0, "no clip has the skeleton of ", o.clips.skeleton_of.string(), "; the first, '",
          sources.front().id,
          "', differs: ", data.other_skeletons.empty() ? std::string() : data.other_skeletons.front().reason);
  if (used.empty()) {
    const double seconds = clips[longest].seconds();
    throw Error(
        "none of ", readable, " clips holds ", o.frames, " frames at ", o.rate, " per second (",
        two_decimals(static_cast<double>(o.frames) / o.rate), " s); the longest, '", sources[longest].id,
        "', has ", two_decimals(seconds), " s: use at most ", std::floor(seconds * o.rate), " frames, or ",
        seconds > 0 ? two_decimals(std::ceil(100 * static_cast<double>(o.frames) / seconds) / 100) : "no",
        " frames per second or more");
  }
  return used;
}

/// What has to change in each clip so that all have one up axis and, if asked for, one height; [used]. Throws
/// Error if they cannot be used together.
inline std::vector<LoadChange> agree(const std::vector<ClipSource>& sources, const std::vector<Used>& used,
                                     Dataset& data) {
  std::vector<ClipFacts> facts;
  for (const Used& u : used)
    facts.push_back({sources[u.source].id, &u.clip.skeleton, u.clip.height, u.clip.up, u.clip.unit_metres});
  data.format.space = space_of(facts, data.options.clips);
  return agreed_changes(facts, data.options.clips, data.notes);
}

/// Encodes all sources long enough for a window, all at one stride and with one root joint.
inline std::vector<Used> encode_all(const std::vector<ClipSource>& sources, Dataset& data, int& root) {
  const DatasetOptions& o = data.options;
  std::vector<EncodedClip> clips(sources.size());
  const std::vector<std::string> errors = errors_in_two_threads(sources.size(), [&](std::size_t i) {
    clips[i] = encode_clip(sources[i].load({}), o, 0, -1, sources[i].id);
  });
  require_all_read(errors, o.clips.skip_bad);
  std::vector<Used> used = choose_clips(sources, clips, errors, data);
  const std::vector<LoadChange> changes = agree(sources, used, data);
  for (std::size_t i = 0; i < used.size(); ++i) used[i].change = changes[i];

  data.stride = used.front().clip.stride;
  root = 0;
  for (const Used& u : used) {
    data.stride = std::min(data.stride, u.clip.stride);
    root = std::max(root, u.clip.root);  // clips in which nothing travels have root 0
  }
  in_two_threads(used.size(), [&](std::size_t i) {
    EncodedClip& clip = used[i].clip;
    const LoadChange& change = used[i].change;
    if (clip.stride == data.stride && !change.up && change.scale == 1 &&
        (clip.root == root || (!o.root_position && o.rotation() == RootRotation::expmap)))
      return;
    const ClipSource& source = sources[used[i].source];
    clip = encode_clip(source.load(change), o, data.stride, root, source.id);
  });
  // Resampling rounds a clip's length down to whole frames, which may cost it its only window.
  std::erase_if(used, [&](const Used& u) {
    if (u.clip.frames > (o.frames - 1) * data.stride) return false;
    data.skipped.push_back(
        {sources[u.source].id, "too short for a window after resampling to the common rate"});
    return true;
  });
  require(!used.empty(), "no clip holds a window of ", o.frames, " frames at ", o.rate,
          " per second after resampling; use fewer frames");
  for (Used& u : used) {
    data.notes.insert(data.notes.end(), u.clip.notes.begin(), u.clip.notes.end());
  }
  return used;
}

/// The skeleton of the first clip, each joint with the channels of the clip that has most of them: files of
/// one skeleton may have channels in other orders, or positions only in some.
inline Skeleton common_skeleton(const std::vector<Used>& used) {
  Skeleton out = used.front().clip.skeleton;
  for (const Used& u : used)
    for (std::size_t j = 0; j < out.size(); ++j)
      if (u.clip.skeleton.joints[j].channels.size() > out.joints[j].channels.size())
        out.joints[j].channels = u.clip.skeleton.joints[j].channels;
  return out;
}

/// The captions of a source, or one from its name.
inline std::vector<std::string> captions_of(const ClipSource& source, Dataset& data) {
  std::vector<std::string> out = source.captions;
  if (out.empty()) {
    out.push_back(caption_from_name(source.name));
    ++data.named;
  }
  for (const std::string& caption : out) {
    require(!split_words(caption).empty(), "clip '", source.id, "' has the caption '", caption,
            "', expected at least one word");
    require(is_utf8(caption), "clip '", source.id, "' has a caption that is not UTF-8");
  }
  return out;
}

/// Removes the clips whose captions describe only parts of them, if these parts cover them.
inline void drop_described_in_parts(std::vector<Used>& used, const std::vector<ClipSource>& sources,
                                    Dataset& data) {
  const DatasetOptions& o = data.options;
  const double window = static_cast<double>(o.frames) / o.rate;
  std::erase_if(used, [&](const Used& u) {
    const ClipSource& source = sources[u.source];
    const double begin = static_cast<double>(u.clip.dropped) / u.clip.source_rate;
    if (source.parts.empty() || !parts_cover(source.parts, begin, begin + u.clip.seconds(), window))
      return false;
    ++data.described_in_parts;
    return true;
  });
  for (const Used& u : used) data.parts += sources[u.source].whole.empty() ? 0 : 1;
  require(!used.empty(), "captions describe parts of the clips, and none of these holds a window of ",
          o.frames, " frames at ", o.rate, " per second; use fewer frames, or captions of whole clips");
}

/// Whether each clip is for training. A clip and its parts are on the same side.
inline std::vector<bool> split_by_whole(const std::vector<Used>& used, const std::vector<ClipSource>& sources,
                                        const DatasetOptions& options) {
  std::map<std::string, std::size_t> numbers;
  std::vector<std::size_t> number_of;
  for (const Used& u : used) {
    const ClipSource& source = sources[u.source];
    number_of.push_back(
        numbers.emplace(source.whole.empty() ? source.id : source.whole, numbers.size()).first->second);
  }
  const std::vector<bool> split = split_clips(numbers.size(), options.train_share, options.split_seed);
  std::vector<bool> out;
  for (const std::size_t number : number_of) out.push_back(split[number]);
  return out;
}

/// Appends the clips that the options derive from the training clips: slower and faster, then all of these
/// mirrored. Faster clips that are too short for a window are left out.
inline void derive_clips(std::vector<Used>& used, std::vector<bool>& is_train, const PoseLayout& layout,
                         const std::vector<ClipSource>& sources, const Dataset& data) {
  const DatasetOptions& o = data.options;
  require(o.stretch >= 0 && o.stretch <= 0.5, "stretch is ", o.stretch, ", expected 0 to 0.5");
  std::vector<Used> derived;
  for (std::size_t i = 0; i < used.size() && o.stretch > 0; ++i)
    for (const double speed : {1 - o.stretch, 1 + o.stretch})
      if (is_train[i])
        derived.push_back({.source = used[i].source, .clip = {}, .change = used[i].change, .speed = speed});
  in_two_threads(derived.size(), [&](std::size_t i) {
    const ClipSource& source = sources[derived[i].source];
    LoadedMotion loaded = source.load(derived[i].change);
    loaded.motion.rate *= derived[i].speed;
    derived[i].clip =
        encode_clip(std::move(loaded), o, data.stride, static_cast<int>(layout.root()), source.id);
  });
  std::erase_if(derived, [&](const Used& u) { return u.clip.frames <= (o.frames - 1) * data.stride; });
  if (o.mirror) {
    const PoseMirror mirror(layout);
    const auto image = [&](const Used& of) {
      Used out = of;
      out.clip.poses = mirror(of.clip.poses);
      out.mirrored = true;
      return out;
    };
    const std::size_t stretched = derived.size();
    for (std::size_t i = 0; i < used.size(); ++i)
      if (is_train[i]) derived.push_back(image(used[i]));
    for (std::size_t i = 0; i < stretched; ++i) derived.push_back(image(derived[i]));
  }
  is_train.resize(used.size() + derived.size(), true);
  for (Used& u : derived) used.push_back(std::move(u));
}

/// The range of the training windows: over all frames and, for relative dimensions, over windows (at most 200
/// evenly spaced ones per clip).
inline void fit_range(Dataset& data) {
  MotionFormat& format = data.format;
  const std::size_t dof = format.dof();
  const auto& relative = format.relative_dims;
  std::vector<float> low(dof, std::numeric_limits<float>::max()),
      high(dof, std::numeric_limits<float>::lowest());
  const auto widen = [&](std::size_t k, float value) {
    low[k] = std::min(low[k], value);
    high[k] = std::max(high[k], value);
  };
  for (const DatasetClip& clip : data.train)
    for (std::size_t i = 0; i < clip.poses.size(); ++i) widen(i % dof, clip.poses[i]);
  for (const std::size_t k : relative) low[k] = high[k] = 0;  // every window's first frame
  std::vector<float> window(format.frames * dof);             // only relative dimensions are filled in
  for (const DatasetClip& clip : data.train) {
    if (relative.empty()) break;
    const std::size_t starts = data.starts(clip), leap = (starts + 199) / 200;
    for (std::size_t start = 0; start < starts; start += leap) {
      for (std::size_t i = 0; i < format.frames; ++i)
        for (const std::size_t k : relative)
          window[i * dof + k] = clip.poses[(start + i * data.stride) * dof + k];
      format.make_relative(std::span<float>(window));
      for (std::size_t i = 0; i < format.frames; ++i)
        for (const std::size_t k : relative) widen(k, window[i * dof + k]);
    }
  }
  format.low.assign(low.begin(), low.end());
  format.high.assign(high.begin(), high.end());
}

inline Dataset build(const std::vector<ClipSource>& sources, const DatasetOptions& options) {
  require(options.frames > 0, "frames is 0, expected at least 1");
  require(std::isfinite(options.rate) && options.rate > 0, "rate is ", options.rate,
          " frames per second, expected more than 0");
  require(!sources.empty(), "a data set needs at least one clip");
  std::set<std::string> ids;
  for (const ClipSource& s : sources) require(ids.insert(s.id).second, "two clips are called '", s.id, "'");
  Dataset data;
  data.options = options;
  int root = 0;
  std::vector<Used> used = encode_all(sources, data, root);
  drop_described_in_parts(used, sources, data);
  std::vector<bool> is_train = split_by_whole(used, sources, options);

  MotionFormat& format = data.format;
  format.layout = PoseLayout(common_skeleton(used), options.root_position, static_cast<std::size_t>(root),
                             options.rotation());
  for (const Joint& joint : format.skeleton().joints)
    require(is_utf8(joint.name), "clip '", sources[used.front().source].id, "' has a joint called '",
            joint.name, "', which is not UTF-8; a model file cannot hold it: rename the joint");
  derive_clips(used, is_train, format.layout, sources, data);
  find_floor(used, is_train, format.layout);
  format.rate = options.rate;
  format.frames = options.frames;
  format.normalizer = fit_normalizer(used, is_train, format.layout, options.frames, data.stride);
  const auto& kept = format.normalizer.kept();
  const PoseLayout& layout = format.layout;
  for (std::size_t k = 0; k < kept.size() && !layout.has_steps(); ++k) {
    const bool ground =
        options.root_position && (kept[k] == layout.position_dim() || kept[k] == layout.position_dim() + 2);
    const bool yaw = layout.has_yaw() && kept[k] == layout.yaw_dim();
    if (ground || yaw) format.relative_dims.push_back(k);
  }
  format.check();  // before normalising: throws if nothing moves

  std::vector<std::string> training_captions;
  std::map<std::size_t, std::vector<std::string>> captions;  // by source
  for (std::size_t c = 0; c < used.size(); ++c) {
    DatasetClip clip;
    clip.id = sources[used[c].source].id;
    if (!used[c].derived()) {
      clip.captions = captions_of(sources[used[c].source], data);
      captions.emplace(used[c].source, clip.captions);
    } else {
      clip.derived = true;
      if (used[c].speed != 1) clip.id += used[c].speed < 1 ? " slower" : " faster";
      if (used[c].mirrored) clip.id += " mirrored";
      for (const std::string& caption : captions.at(used[c].source))
        clip.captions.push_back(used[c].mirrored ? mirrored_caption(caption) : caption);
    }
    clip.frames = used[c].clip.frames;
    clip.poses = format.normalizer.normalize<float>(used[c].clip.poses);
    if (is_train[c])
      training_captions.insert(training_captions.end(), clip.captions.begin(), clip.captions.end());
    (is_train[c] ? data.train : data.test).push_back(std::move(clip));
  }
  fit_range(data);
  format.check();
  format.vocabulary = Vocabulary::from_captions(training_captions);
  format.descriptions = distinct_descriptions(data.train).most_popular(MotionFormat::most_descriptions).texts;
  for (auto* part : {&data.train, &data.test})
    for (DatasetClip& clip : *part)
      for (const std::string& caption : clip.captions) {
        clip.sentences.push_back(format.vocabulary.encode(caption));
        if (const std::string note = word_limit_note(caption); !note.empty())
          data.notes.push_back(concat("clip '", clip.id, "': its caption ", note));
      }
  return data;
}

}  // namespace dataset_detail

inline Dataset Dataset::from_bvh(const std::filesystem::path& folder_or_file, const DatasetOptions& options) {
  const std::vector<std::filesystem::path> files =
      find_motion_files(folder_or_file, {options.captions, options.clips.bones});
  const std::vector<std::string> ids = clip_ids(files, folder_or_file);
  CaptionMatch match = find_captions(options.captions, files, clip_names(files, ids, folder_or_file));
  std::vector<ClipSource> sources;
  for (std::size_t i = 0; i < files.size(); ++i)
    sources.push_back(
        {ids[i], files[i].string(), {}, [file = files[i], how = options.clips](const LoadChange& change) {
           return read_motion(file, changed(how, change));
         }});
  Dataset data = dataset_detail::build(with_captions(std::move(sources), match.of_clip), options);
  data.captions = std::move(match.report);
  return data;
}

inline Dataset Dataset::from_motions(const std::vector<LabelledMotion>& motions,
                                     const DatasetOptions& options) {
  std::vector<ClipSource> sources;
  std::vector<ClipName> names;
  for (const LabelledMotion& m : motions) {
    sources.push_back(
        {m.id, m.id, m.captions, [&m](const LoadChange& change) { return in_memory(m.motion, change); }});
    names.push_back(clip_name(m.id));
  }
  CaptionMatch match =
      match_captions(options.captions.empty() ? CaptionFile{} : read_caption_file(options.captions), names);
  Dataset data = dataset_detail::build(with_captions(std::move(sources), match.of_clip), options);
  data.captions = std::move(match.report);
  return data;
}

}  // namespace motiongan::motion

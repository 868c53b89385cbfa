// Construction of an ActionDataset. Included by action_dataset.hpp.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/data/action_dataset.hpp"
#include "motiongan/data/action_source.hpp"
#include "motiongan/data/action_split.hpp"
#include "motiongan/data/clip_agreement.hpp"
#include "motiongan/data/clip_source.hpp"
#include "motiongan/formats/bvh_writer.hpp"
#include "motiongan/motion/skeleton_match.hpp"

namespace motiongan::motion {

namespace action_dataset_detail {

/// A source that will be used.
struct Chosen {
  std::size_t source = 0;
  SplitClip what;     ///< its label is an index into `classes`
  std::string label;  ///< name of the label
};

/// The sources whose label is one of the selected classes; sets format.classes to their names, sorted.
inline std::vector<Chosen> choose(const std::vector<Source>& sources, const ActionLabels* given,
                                  ActionDataset& data) {
  const ActionDatasetOptions& o = data.options;
  const std::optional<NamePattern> pattern =
      o.pattern.empty() ? std::nullopt : std::optional<NamePattern>(o.pattern);
  const bool from_pattern = pattern && pattern->has_label();
  require(!pattern || from_pattern || pattern->has_subject(), "the pattern '", o.pattern,
          "' has neither {label} nor {subject}, expected at least one of them");
  require((o.labels.empty() ? 0 : 1) + (o.folders ? 1 : 0) + (from_pattern ? 1 : 0) + (given ? 1 : 0) <= 1,
          "labels come from several sources, expected exactly one of a label file, folders, and a pattern "
          "with {label}");
  const ActionLabels read = o.labels.empty() ? ActionLabels{} : read_action_labels(o.labels);
  const ActionLabels* const file = o.labels.empty() ? given : &read;
  const bool wants_subject = o.by_subject || !o.test_subjects.empty();

  std::vector<Chosen> out;
  std::set<std::string> all, used;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const Source& source = sources[i];
    NameParts parts;
    if (pattern) parts = pattern->parse(source.name);
    std::string label = source.label.value_or("");
    if (from_pattern) label = parts.label;
    if (file != nullptr) {
      label.clear();
      for (const std::string& key : {source.name, source.id})
        if (const auto at = file->find(key); at != file->end()) label = at->second;
    }
    if (label.empty()) {
      ++data.unlabelled;
      continue;
    }
    require(is_utf8(label), "clip '", source.id, "' has a label that is not UTF-8");
    all.insert(label);
    if (!o.classes.empty() && std::find(o.classes.begin(), o.classes.end(), label) == o.classes.end()) {
      ++data.other_classes;
      continue;
    }
    if (wants_subject && parts.subject.empty()) parts.subject = subject_from_name(source.name);
    used.insert(label);
    out.push_back({i, {0, parts.subject}, label});
  }
  std::string list;
  for (const std::string& label : all) list += (list.empty() ? "'" : ", '") + label + "'";
  for (const std::string& name : o.classes)
    require(all.contains(name), "no clip has the class '", name,
            "'; the classes are: ", list.empty() ? std::string("none") : list);
  require(!out.empty(), "none of ", sources.size(), " clips has a label",
          o.labels.empty() ? std::string() : " in " + o.labels.string(), "; the first clip is '",
          sources.front().name, "'");
  data.format.classes.assign(used.begin(), used.end());
  for (Chosen& c : out) c.what.label = data.format.class_index(c.label);
  return out;
}

/// The skeleton of the file that the options name, from its travelling joint down.
inline Skeleton skeleton_of(const ActionDatasetOptions& o) {
  return load_file(o.clips.skeleton_of, "", o, -1, {}).clip.skeleton;
}

/// Loads again what is not like the other clips: with one root joint, one up axis and, if asked for, one
/// height. Throws Error if the clips cannot be used together.
inline void make_alike(const std::vector<Source>& sources, const std::vector<Chosen>& chosen,
                       std::vector<Loaded>& clips, ActionDataset& data) {
  int root = 0;  // clips in which nothing travels have root 0
  for (const Loaded& clip : clips) root = std::max(root, clip.root);
  const auto load_again = [&](std::size_t i, const LoadChange& change) {
    clips[i] = sources[chosen[i].source].load(root, change);
  };
  in_two_threads(clips.size(), [&](std::size_t i) {
    if (clips[i].root != root) load_again(i, {});
  });
  std::vector<ClipFacts> facts;
  for (const Loaded& clip : clips)
    facts.push_back({clip.clip.id, &clip.clip.skeleton, clip.height, clip.up, clip.unit_metres});
  data.format.space = space_of(facts, data.options.clips);
  const std::vector<LoadChange> changes = agreed_changes(facts, data.options.clips, data.notes);
  in_two_threads(clips.size(), [&](std::size_t i) {
    if (changes[i].up || changes[i].scale != 1) load_again(i, changes[i]);
  });
  for (const Loaded& clip : clips) data.notes.insert(data.notes.end(), clip.notes.begin(), clip.notes.end());
}

/// Loads the chosen clips, all with one root joint, and removes those too short for a window; [chosen].
inline std::vector<Loaded> load_all(const std::vector<Source>& sources, std::vector<Chosen>& chosen,
                                    ActionDataset& data) {
  const ActionDatasetOptions& o = data.options;
  std::vector<Loaded> clips(chosen.size());
  const std::vector<std::string> errors = errors_in_two_threads(
      chosen.size(), [&](std::size_t i) { clips[i] = sources[chosen[i].source].load(-1, {}); });
  require_all_read(errors, o.clips.skip_bad);
  Skeleton only;
  if (!o.clips.skeleton_of.empty()) only = skeleton_of(o);
  const double needed = 2 * static_cast<double>(o.frames) / o.rate;
  std::vector<double> longest(data.format.classes.size(), 0);
  std::vector<bool> has_clip(data.format.classes.size(), false);
  double longest_of_all = 0;
  std::string longest_id;
  std::vector<Chosen> kept;
  std::vector<Loaded> kept_clips;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    const std::string& id = sources[chosen[i].source].id;
    if (!errors[i].empty()) {
      data.bad.push_back({id, errors[i]});
      continue;
    }
    if (only.size() > 0 && !have_same_joints(only, clips[i].clip.skeleton)) {
      data.other_skeletons.push_back({id, some_of(joint_differences(only, clips[i].clip.skeleton), 4)});
      continue;
    }
    const double seconds = clips[i].seconds;
    longest[chosen[i].what.label] = std::max(longest[chosen[i].what.label], seconds);
    if (seconds >= longest_of_all) longest_of_all = seconds, longest_id = id;
    if (clips[i].clip.frames < 2 * o.frames) {
      data.skipped.push_back(
          {id, concat("clip '", id, "' lasts ", seconds_text(seconds), ", a window of 2 x ", o.frames,
                      " frames needs ", seconds_text(needed))});
      continue;
    }
    has_clip[chosen[i].what.label] = true;
    kept.push_back(std::move(chosen[i]));
    kept_clips.push_back(std::move(clips[i]));
  }
  const auto shorter = [&](double seconds) { return std::floor(seconds * o.rate / 2); };
  require(!kept.empty(), "none of ", clips.size(), " labelled clips holds a window of 2 x ", o.frames,
          " frames at ", o.rate, " per second (", seconds_text(needed), "); the longest, '", longest_id,
          "', lasts ", seconds_text(longest_of_all), ": use windows of 2 x ", shorter(longest_of_all),
          " frames or fewer");
  for (std::size_t c = 0; c < has_clip.size(); ++c)
    require(has_clip[c], "no clip of the class '", data.format.classes[c], "' holds a window of ",
            seconds_text(needed), "; the longest lasts ", seconds_text(longest[c]), ": use windows of 2 x ",
            shorter(longest[c]), " frames or fewer, or leave the class out");
  chosen = std::move(kept);
  clips = std::move(kept_clips);

  make_alike(sources, chosen, clips, data);
  return clips;
}

inline std::vector<bool> split(const std::vector<Chosen>& chosen, const ActionDataset& data) {
  const ActionDatasetOptions& o = data.options;
  std::vector<SplitClip> clips;
  for (const Chosen& c : chosen) clips.push_back(c.what);
  const std::size_t classes = data.format.classes.size();
  std::vector<bool> is_train = !o.test_subjects.empty() ? split_off_subjects(clips, o.test_subjects)
                               : o.by_subject ? split_by_subject(clips, classes, o.train_share, o.split_seed)
                                              : split_by_class(clips, classes, o.train_share, o.split_seed);
  std::vector<bool> trained(classes, false);
  for (std::size_t i = 0; i < clips.size(); ++i)
    if (is_train[i]) trained[clips[i].label] = true;
  for (std::size_t c = 0; c < classes; ++c)
    require(trained[c], "the class '", data.format.classes[c],
            "' has no training clip: all its clips are of test subjects; choose other test subjects, another "
            "split seed or a larger train_share, or leave the class out");
  return is_train;
}

inline ActionDataset build(const std::vector<Source>& sources, const ActionLabels* given,
                           const ActionDatasetOptions& options) {
  require(options.frames > 0, "frames is 0, expected at least 1");
  require(std::isfinite(options.rate) && options.rate > 0, "rate is ", options.rate,
          " frames per second, expected more than 0");
  require(!sources.empty(), "a data set needs at least one clip");
  std::set<std::string> ids;
  for (const Source& s : sources) require(ids.insert(s.id).second, "two clips are called '", s.id, "'");
  ActionDataset data;
  data.options = options;
  std::vector<Chosen> chosen = choose(sources, given, data);
  std::vector<Loaded> clips = load_all(sources, chosen, data);
  const std::vector<bool> is_train = split(chosen, data);

  PositionFormat& format = data.format;
  format.layout = PositionLayout(clips.front().clip.skeleton, options.root_track);
  format_hierarchy(format.skeleton());  // as stored in a model file: throws before training
  for (const Joint& joint : format.skeleton().joints)
    require(is_utf8(joint.name), "clip '", clips.front().clip.id, "' has a joint called '", joint.name,
            "', which is not UTF-8; a model file cannot hold it: rename the joint");
  format.rate = options.rate;
  format.frames = options.frames;

  std::vector<std::vector<double>> poses(clips.size());
  std::vector<ActionClip> out(clips.size());
  in_two_threads(clips.size(), [&](std::size_t i) {
    PositionClip& clip = clips[i].clip;
    try {
      out[i].places = format.layout.places(clip.positions);
    } catch (const Error& error) {
      throw Error("clip '", clip.id, "': ", error.what());
    }
    poses[i] = format.layout.encode(clip.positions, out[i].places);
    out[i].id = clip.id;
    out[i].subject = chosen[i].what.subject;
    out[i].label = chosen[i].what.label;
    out[i].frames = clip.frames;
    out[i].skeleton = std::move(clip.skeleton);
    clip.positions = {};
  });
  std::vector<double> training;
  for (std::size_t i = 0; i < clips.size(); ++i)
    if (is_train[i]) training.insert(training.end(), poses[i].begin(), poses[i].end());
  format.normalizer = Normalizer::fit(training, format.layout.dof());
  format.check();
  for (std::size_t i = 0; i < clips.size(); ++i) {
    data.dropped_frames += clips[i].dropped;
    out[i].poses = format.normalizer.normalize<float>(poses[i]);
    (is_train[i] ? data.train : data.test).push_back(std::move(out[i]));
  }
  return data;
}

}  // namespace action_dataset_detail

inline ActionDataset ActionDataset::from_folder(const std::filesystem::path& folder_or_file,
                                                const ActionDatasetOptions& options) {
  namespace detail = action_dataset_detail;
  require(
      !options.labels.empty() || options.folders || !options.pattern.empty(),
      "there are no labels: give a label file (lines of clip id <TAB> label), labels by folder, or a file "
      "name pattern such as *_{label}_*");
  const std::vector<std::filesystem::path> files = detail::clip_files(folder_or_file, options);
  const std::vector<std::string> ids = clip_ids(files, folder_or_file);
  std::vector<detail::Source> sources;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const auto load = [file = files[i], id = ids[i], &options](int root, const LoadChange& change) {
      return detail::load_file(file, id, options, root, change);
    };
    sources.push_back({ids[i], clip_stem(files[i]), {}, load});
    if (options.folders) sources.back().label = label_from_folder(files[i], folder_or_file);
  }
  return detail::build(sources, nullptr, options);
}

inline ActionDataset ActionDataset::from_motions(const std::vector<LabelledMotion>& motions,
                                                 const ActionDatasetOptions& options) {
  require(!options.folders,
          "folders is set, but motions in memory have no folders; expected labels from captions, a file or a "
          "pattern");
  std::vector<action_dataset_detail::Source> sources;
  for (const LabelledMotion& m : motions) {
    sources.push_back({m.id, m.id, {}, [&m, &options](int root, const LoadChange& change) {
                         return action_dataset_detail::load_motion(in_memory(m.motion, change), m.id,
                                                                   options.rate, root);
                       }});
    if (!m.captions.empty()) sources.back().label = m.captions.front();
  }
  return action_dataset_detail::build(sources, nullptr, options);
}

inline ActionDataset ActionDataset::from_positions(const std::vector<PositionClip>& clips,
                                                   const ActionLabels& labels,
                                                   const ActionDatasetOptions& options) {
  require(!options.folders,
          "folders is set, but clips in memory have no folders; expected labels by id or a pattern");
  std::vector<action_dataset_detail::Source> sources;
  for (const PositionClip& clip : clips)
    sources.push_back(
        {clip.id, clip.id, {}, [&clip, &options](int, const LoadChange& change) {
           return action_dataset_detail::load_positions({scaled(clip, change.scale), {}}, options.rate);
         }});
  return action_dataset_detail::build(sources, labels.empty() ? nullptr : &labels, options);
}

}  // namespace motiongan::motion

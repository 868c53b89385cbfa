// Prints what a folder of clips contains: skeletons, rates, lengths, and captions by number of frames.
#include <algorithm>
#include <map>

#include "inspect/info.hpp"
#include "motiongan/data/caption_parts.hpp"
#include "motiongan/data/captions.hpp"
#include "motiongan/data/clip_agreement.hpp"
#include "motiongan/formats/read_motion.hpp"
#include "shared/caption_report.hpp"
#include "shared/clip_reading.hpp"

namespace motiongan::command {
namespace {

/// A caption, or several joined, and the frames that it describes.
struct Captioned {
  std::string text;
  std::size_t frames = 0;
};

struct ClipFacts {
  std::string id;
  std::vector<Captioned> captions;
  std::size_t frames = 0, posed = 0;
  double rate = 0, height = 0;
  std::optional<motion::UpAxis> up;
  motion::Skeleton skeleton;
  std::vector<std::string> notes;
  double seconds() const { return static_cast<double>(frames) / rate; }
};

void add_text(std::string& texts, const std::string& text) { texts += (texts.empty() ? "" : " | ") + text; }

/// The captions of a clip of `frames` frames, without the `posed` frames before them: those of the whole,
/// then those of each part; from the file's name, in parentheses, if there are none.
std::vector<Captioned> captions_of(const fs::path& file, const std::vector<motion::Caption>& captions,
                                   const ClipFacts& clip) {
  if (captions.empty()) return {{"(" + motion::caption_from_name(file) + ")", clip.frames}};
  std::string whole;
  std::map<motion::CaptionPart, std::string> parts;
  for (const motion::Caption& caption : captions)
    add_text(caption.part ? parts[*caption.part] : whole, caption.text);
  std::vector<Captioned> out;
  if (!whole.empty()) out.push_back({whole, clip.frames});
  for (const auto& [part, text] : parts) {
    const auto [first, end] = motion::frames_of_part(part, clip.rate, clip.posed, clip.frames);
    out.push_back({text, end - first});
  }
  return out;
}

ClipFacts read_facts(const fs::path& file, const std::string& id, const motion::ClipOptions& options) {
  motion::InspectedMotion found = motion::inspect_motion(file, options);
  motion::LoadedMotion& loaded = found.loaded;
  ClipFacts out;
  out.id = id;
  out.posed = loaded.dropped;
  out.frames = found.frames;
  out.rate = loaded.motion.rate;
  out.skeleton = std::move(loaded.motion.skeleton);
  out.height = motion::body_height(out.skeleton);
  out.up = loaded.up;
  out.notes = std::move(loaded.notes);
  return out;
}

/// Prints the skeletons as training tells them apart, the largest group first.
void print_skeletons(const std::vector<ClipFacts>& clips) {
  std::vector<const motion::Skeleton*> skeletons;
  for (const ClipFacts& c : clips) skeletons.push_back(&c.skeleton);
  const std::vector<motion::SkeletonGroup> groups = motion::group_by_skeleton(skeletons);
  const motion::Skeleton& first = *skeletons[groups.front().front()];
  for (const motion::SkeletonGroup& group : groups) {
    const motion::Skeleton& skeleton = *skeletons[group.front()];
    std::size_t orders = 0;  // clips whose channels differ from the group's first
    for (const std::size_t i : group)
      for (std::size_t j = 0; j < skeleton.size(); ++j)
        if (clips[i].skeleton.joints[j].channels != skeleton.joints[j].channels) {
          ++orders;
          break;
        }
    std::string text =
        fmt::format("{}: {} ({})", counted(group.size(), "clip"), counted(skeleton.size(), "joint"),
                    counted(skeleton.channel_count(), "channel"));
    if (orders > 0) text += fmt::format(", {} with channels in another order", orders);
    if (groups.size() > 1)
      text += fmt::format("; {}{}", clips[group.front()].id, group.size() > 1 ? ", ..." : "");
    print_fact("skeleton", text);
    if (&group != &groups.front())
      print_fact(
          "", "compared with the first: " + motion::some_of(motion::joint_differences(first, skeleton), 4));
  }
  if (groups.size() > 1)
    print_fact("", fmt::format("training needs clips of one skeleton: --skeleton-of FILE keeps one group"));
}

/// Prints the bodies' sizes and the up axes of the files.
void print_bodies(const std::vector<ClipFacts>& clips) {
  double low = 0, high = 0;
  std::size_t y = 0, z = 0;
  for (const ClipFacts& c : clips) {
    if (c.height > 0) {
      low = low <= 0 ? c.height : std::min(low, c.height);
      high = std::max(high, c.height);
    }
    y += c.up == motion::UpAxis::y, z += c.up == motion::UpAxis::z;
  }
  const double unit = motion::likely_unit_metres(low);
  print_fact(
      "bodies",
      fmt::format("{} units high at rest{}", low == high ? brief(low) : brief(low) + " to " + brief(high),
                  unit > 0 ? fmt::format(", probably in units of {} m", brief(unit)) : std::string()));
  if (high > 1.5 * low)
    print_fact("", "too different for one data set, unless --normalise-height scales them");
  std::string up = z == 0 ? "y" : y == 0 ? "z" : fmt::format("y in {}, z in {}", counted(y, "clip"), z);
  if (y + z == 0)
    up = "not sure, taken to be y; --up tells";
  else if (y + z < clips.size())
    up += fmt::format("; not sure in {}", counted(clips.size() - y - z, "clip"));
  print_fact("up axis", up);
}

/// Prints the number and length of the clips, and their skeletons and rates.
void print_kinds(const std::vector<ClipFacts>& clips) {
  std::map<double, std::size_t> rates;
  double seconds = 0;
  std::size_t posed = 0;
  for (const ClipFacts& c : clips) {
    ++rates[c.rate];
    seconds += c.seconds();
    posed += c.posed > 0;
  }
  const auto [shortest, longest] =
      std::minmax_element(clips.begin(), clips.end(),
                          [](const ClipFacts& a, const ClipFacts& b) { return a.seconds() < b.seconds(); });
  print_fact("clips", fmt::format("{}, {} in all; shortest {} ({}), longest {} ({})", clips.size(),
                                  duration(seconds), duration(shortest->seconds()), shortest->id,
                                  duration(longest->seconds()), longest->id));
  print_skeletons(clips);
  print_bodies(clips);
  for (const auto& [rate, count] : rates)
    print_fact("rate", fmt::format("{}: {} frames per second", counted(count, "clip"), brief(rate)));
  if (posed > 0)
    print_fact("first frame",
               fmt::format("{} begin with a T-pose, which is not counted here", counted(posed, "clip")));
}

/// Prints how many clips are long enough for common window sizes.
void print_windows(const std::vector<ClipFacts>& clips) {
  std::vector<std::vector<std::string>> rows;
  for (const auto& [frames, rate] :
       {std::pair<std::size_t, double>{32, 4}, {64, 12.5}, {32, 8}, {32, 12.5}, {64, 30}, {16, 12.5}}) {
    const double window = static_cast<double>(frames) / rate;
    std::size_t count = 0;
    double seconds = 0;
    for (const ClipFacts& c : clips)
      if (c.seconds() >= window * (1 - 1e-9)) ++count, seconds += c.seconds();
    rows.push_back({fmt::format("--frames {} --rate {}", frames, brief(rate)), duration(window),
                    std::to_string(count), count > 0 ? duration(seconds) : "-"});
  }
  fmt::print("\nclips that are long enough for a window\n");
  print_table({"window", "length", "clips", "in all"}, rows, "lrrr", "  ");
}

void print_captions(const std::vector<ClipFacts>& clips) {
  struct Group {
    std::size_t clips = 0, frames = 0;
    double seconds = 0;
  };
  std::map<std::string, Group> groups;
  for (const ClipFacts& c : clips)
    for (const Captioned& caption : c.captions) {
      Group& g = groups[caption.text];
      ++g.clips;
      g.frames += caption.frames;
      g.seconds += static_cast<double>(caption.frames) / c.rate;
    }
  std::vector<std::pair<std::string, Group>> sorted(groups.begin(), groups.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.second.frames > b.second.frames; });
  std::vector<std::vector<std::string>> rows;
  rows.reserve(sorted.size());
  for (const auto& [caption, g] : sorted)
    rows.push_back({std::to_string(g.frames), duration(g.seconds), std::to_string(g.clips), caption});
  fmt::print("\ncaptions by number of frames\n");
  print_table({"frames", "length", "clips", "caption"}, rows, "rrrl", "  ");
}

/// Drops the files that could not be read from all three lists, and prints each with its reason. Throws Error
/// if none is left.
void drop_bad(const std::vector<std::string>& errors, std::vector<fs::path>& files,
              std::vector<std::string>& ids, std::vector<ClipFacts>& clips) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (!errors[i].empty()) {
      print_fact("unreadable", errors[i]);
      continue;
    }
    if (kept != i)
      files[kept] = std::move(files[i]), ids[kept] = std::move(ids[i]), clips[kept] = std::move(clips[i]);
    ++kept;
  }
  if (kept < files.size()) print_fact("", "training goes on without these files with --skip-bad");
  require(kept > 0, "none of ", files.size(), " files can be read");
  files.resize(kept), ids.resize(kept), clips.resize(kept);
}

}  // namespace

void print_folder(const fs::path& folder, const fs::path& given, const motion::ClipOptions& options) {
  std::vector<fs::path> files = motion::find_motion_files(folder, {given, options.bones});
  std::vector<std::string> ids = motion::clip_ids(files, folder);
  std::vector<ClipFacts> clips(files.size());
  const std::vector<std::string> errors = motion::errors_in_two_threads(
      files.size(), [&](std::size_t i) { clips[i] = read_facts(files[i], ids[i], options); });
  fmt::print("{}: a folder of clips\n", folder.string());
  drop_bad(errors, files, ids, clips);
  const motion::CaptionMatch match =
      motion::find_captions(captions_for(folder, given), files, motion::clip_names(files, ids, folder));
  for (std::size_t i = 0; i < clips.size(); ++i)
    clips[i].captions = captions_of(files[i], match.of_clip[i], clips[i]);
  print_kinds(clips);
  const std::string& source = match.report.source;
  print_fact("captions", source.empty() ? fmt::format("taken from file names ({})", no_captions_found)
                         : match.report.without.empty()
                             ? "from " + source
                             : fmt::format("from {}; {} captioned by file names (in parentheses)", source,
                                           counted(match.report.without.size(), "clip")));
  for (const std::string& remark : caption_remarks(match.report)) print_fact("", remark);
  print_windows(clips);
  print_captions(clips);
  std::vector<std::string> notes;
  for (const ClipFacts& c : clips) notes.insert(notes.end(), c.notes.begin(), c.notes.end());
  print_notes(notes);
}

}  // namespace motiongan::command

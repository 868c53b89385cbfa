// Prints what a folder of clips contains: skeletons, rates, lengths, and captions by number of frames.
#include <algorithm>
#include <map>

#include "inspect/info.hpp"
#include "motiongan/data/captions.hpp"
#include "motiongan/data/clip_source.hpp"
#include "motiongan/data/first_frame.hpp"
#include "motiongan/formats/bvh.hpp"
#include "motiongan/motion/motion.hpp"

namespace motiongan::command {
namespace {

struct ClipFacts {
  std::string id;
  std::string caption;  // several are joined
  std::size_t frames = 0, posed = 0, joints = 0, channels = 0;
  double rate = 0;
  std::string joint_names;
  double seconds() const { return static_cast<double>(frames) / rate; }
};

ClipFacts read_facts(const fs::path& file, const std::string& id, const motion::Captions& captions) {
  const motion::Clip clip = motion::read_bvh(file);
  ClipFacts out;
  out.id = id;
  out.posed = motion::t_pose_frames(clip);
  out.frames = clip.frames - out.posed;
  out.rate = motion::rate_from_frame_time(clip.frame_time);
  out.joints = clip.skeleton.size();
  out.channels = clip.skeleton.channel_count();
  for (const motion::Joint& joint : clip.skeleton.joints) out.joint_names += joint.name + " ";
  for (const std::string& key : {file.stem().string(), id})
    if (const auto at = captions.find(key); at != captions.end()) {
      out.caption.clear();
      for (const std::string& text : at->second) out.caption += (out.caption.empty() ? "" : " | ") + text;
    }
  if (out.caption.empty()) out.caption = "(" + motion::caption_from_name(file) + ")";
  return out;
}

/// Prints the number and length of the clips, and their skeletons and rates.
void print_kinds(const std::vector<ClipFacts>& clips) {
  std::map<std::string, std::size_t> skeletons;
  std::map<std::string, std::string> names;
  std::map<double, std::size_t> rates;
  double seconds = 0;
  std::size_t posed = 0;
  for (const ClipFacts& c : clips) {
    const std::string kind =
        fmt::format("{} ({})", counted(c.joints, "joint"), counted(c.channels, "channel"));
    ++skeletons[c.joint_names + kind];
    names[c.joint_names + kind] = kind;
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
  for (const auto& [key, count] : skeletons)
    print_fact("skeleton", fmt::format("{}: {}", counted(count, "clip"), names[key]));
  if (skeletons.size() > 1) print_fact("", "training needs clips of one skeleton");
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
  for (const ClipFacts& c : clips) {
    Group& g = groups[c.caption];
    ++g.clips;
    g.frames += c.frames;
    g.seconds += c.seconds();
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

}  // namespace

void print_folder(const fs::path& folder, const fs::path& given) {
  const fs::path file = captions_for(folder, given);
  const motion::Captions captions = file.empty() ? motion::Captions{} : motion::read_captions(file);
  const std::vector<fs::path> files = motion::find_clip_files(folder);
  const std::vector<std::string> ids = motion::clip_ids(files, folder);
  std::vector<ClipFacts> clips(files.size());
  motion::in_two_threads(files.size(),
                         [&](std::size_t i) { clips[i] = read_facts(files[i], ids[i], captions); });
  const auto unnamed =
      std::count_if(clips.begin(), clips.end(), [](const ClipFacts& c) { return c.caption.front() == '('; });
  fmt::print("{}: a folder of clips\n", folder.string());
  print_kinds(clips);
  print_fact("captions",
             file.empty() ? "none (no captions.tsv, no --captions): taken from file names"
             : unnamed > 0
                 ? fmt::format("from {}; {} not in it, captioned by their file names (in parentheses)",
                               file.string(), counted(static_cast<std::size_t>(unnamed), "clip"))
                 : "from " + file.string());
  print_windows(clips);
  print_captions(clips);
}

}  // namespace motiongan::command

#include "shared/clip_reading.hpp"

#include "motiongan/data/clip_agreement.hpp"

namespace motiongan::command {

void add_reading_options(CLI::App& verb, motion::ClipOptions& options, bool folders) {
  OptionFilter filter{.only = {"up", "scale", "fps", "first_frame", "bones"}};
  if (folders) filter.only.emplace_back("skip_bad");
  add_options(verb, fields_of(options), "Reading clips", filter);
}

void print_notes(const std::vector<std::string>& notes) {
  constexpr std::size_t most = 10;
  for (std::size_t i = 0; i < std::min(most, notes.size()); ++i)
    fmt::print(stderr, "motiongan: note: {}\n", notes[i]);
  if (notes.size() > most) fmt::print(stderr, "motiongan: and {} more notes\n", notes.size() - most);
}

void print_skipped(const std::vector<motion::SkippedClip>& clips) {
  std::vector<std::string> reasons;
  for (const motion::SkippedClip& clip : clips) reasons.push_back("skipped: " + clip.reason);
  print_notes(reasons);
}

motion::LoadedMotion read_clip(const fs::path& file, const motion::ClipOptions& options,
                               const motion::ClipSpace& space) {
  motion::LoadedMotion loaded = motion::read_motion(file, options);
  if (!loaded.up && space.clips_up == motion::UpAxis::z) {
    motion::ClipOptions turned = options;
    turned.up = motion::UpAxis::z;
    loaded = motion::read_motion(file, turned);
  }
  if (loaded.up == motion::UpAxis::z && !options.up)
    loaded.notes.push_back(file.string() + ": z is up, by rest pose and travel; turned to y up");
  print_notes(loaded.notes);
  return loaded;
}

void for_each_clip(
    const fs::path& where, const motion::ClipOptions& options,
    const std::function<void(const fs::path& file, const std::string& id, motion::LoadedMotion&&)>& use) {
  const std::vector<fs::path> files = motion::find_motion_files(where, {options.bones});
  const std::vector<std::string> ids = motion::clip_ids(files, where);
  std::vector<motion::LoadedMotion> clips(files.size());
  const std::vector<std::string> errors = motion::errors_in_two_threads(
      files.size(), [&](std::size_t i) { clips[i] = motion::read_motion(files[i], options); });
  motion::require_all_read(errors, options.skip_bad);
  std::vector<std::string> notes;
  std::size_t turned = 0;
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (!errors[i].empty()) {
      fmt::print(stderr, "motiongan: skipped: {}\n", errors[i]);
      continue;
    }
    notes.insert(notes.end(), clips[i].notes.begin(), clips[i].notes.end());
    turned += clips[i].up == motion::UpAxis::z;
    use(files[i], ids[i], std::move(clips[i]));
  }
  if (turned > 0 && !options.up)
    notes.push_back(fmt::format("{}: z is up in {}, by rest pose and travel; turned to y up", where.string(),
                                counted(turned, "clip")));
  print_notes(notes);
}

void scale_all_to(const motion::Skeleton& model, std::vector<motion::Motion>& motions,
                  const std::string& what) {
  std::size_t count = 0;
  double first = 1;
  for (motion::Motion& motion : motions) {
    const double factor = motion::scale_to(model, motion.skeleton);
    if (factor == 1) continue;
    if (count++ == 0) first = factor;
    motion = motion::scaled(std::move(motion), factor);
  }
  if (count > 0)
    fmt::print(stderr, "motiongan: {}: {} scaled by leg length, the first by {}\n", what,
               counted(count, "clip"), brief(first));
}

}  // namespace motiongan::command

// Updates the search index of a folder: reads new and changed files, keeps the rest.
#pragma once
#include "motiongan/formats/read_motion.hpp"
#include "motiongan/search/index.hpp"

namespace motiongan {

/// An index, and what was done to update it.
struct SearchCollection {
  SearchIndex index;
  std::filesystem::path file;         ///< where the index is stored
  std::size_t read = 0;               ///< files read now
  std::size_t kept = 0;               ///< files taken from the stored index
  std::size_t removed = 0;            ///< files of the stored index that no longer exist
  bool written = false;               ///< whether the stored index was rewritten
  std::vector<std::string> warnings;  ///< for the user, one sentence each
};

/// The default index file of a folder: one for each motion format.
inline std::filesystem::path search_index_file(const std::filesystem::path& folder,
                                               const motion::MotionFormat& format,
                                               const motion::ClipOptions& clips = {}) {
  const std::string key = search_key(format, clips);
  return folder / ".motiongan-search" /
         (search_detail::hexadecimal(search_detail::digest(key.data(), key.size())) + ".safetensors");
}

namespace search_detail {

/// A clip's normalised poses [frames, dof] at the model's rate; fills in `clip`. Returns nothing for a file
/// that cannot be used and gives the reason in `clip.left_out`. `size` is what lengths were multiplied by.
inline std::vector<float> encode_file(const std::filesystem::path& path, const motion::MotionFormat& format,
                                      const motion::ClipOptions& how, SearchClip& clip, double& size) {
  std::vector<float> poses;
  try {
    motion::LoadedMotion loaded = motion::read_motion(path, how);
    format.require_skeleton(loaded.motion.skeleton, "the clip " + clip.path);
    clip.begin = static_cast<double>(loaded.dropped) / loaded.motion.rate;
    size = motion::scale_to(format.skeleton(), loaded.motion.skeleton);
    if (size != 1) loaded.motion = motion::scaled(std::move(loaded.motion), size);
    motion::DatasetOptions options;
    options.frames = format.frames;
    options.rate = format.rate;
    options.root_position = format.layout.root_position();
    options.root_rotation = format.layout.root_rotation();
    const motion::EncodedClip encoded =
        encode_clip(std::move(loaded.motion), options, 0, static_cast<int>(format.layout.root()));
    const std::size_t dof = format.layout.dof();
    std::vector<double> rows;  // every stride-th frame, as in a data set's windows
    for (std::size_t f = 0; f < encoded.frames; f += encoded.stride)
      rows.insert(rows.end(), encoded.poses.begin() + static_cast<std::ptrdiff_t>(f * dof),
                  encoded.poses.begin() + static_cast<std::ptrdiff_t>((f + 1) * dof));
    if (rows.size() < format.frames * dof) {
      clip.left_out = concat(clip.path, " is shorter than a window of ", format.frames, " frames at ",
                             format.rate, " per second");
      return {};
    }
    std::vector<double> normalised = format.normalizer.normalize<double>(rows);
    format.make_relative(std::span<double>(normalised));
    poses.assign(normalised.begin(), normalised.end());
    clip.frames = poses.size() / format.dof();
  } catch (const Error& error) {
    clip.left_out = error.what();
  }
  return poses;
}

/// Whether the file begins like an index, damaged or not, or is empty: then it may be overwritten.
inline bool looks_like_index(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::string head(512, '\0');
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(in.gcount()));
  return head.empty() || head.find(version_key) != std::string::npos;
}

/// The stored index, if it exists and can be used; otherwise adds the reason to `warnings`. Throws Error if
/// `file` is something else.
inline std::optional<SearchIndex> old_index(const std::filesystem::path& file, bool is_ours,
                                            const motion::MotionFormat& format,
                                            const motion::ClipOptions& clips,
                                            std::vector<std::string>& warnings) {
  std::error_code problem;
  if (std::filesystem::status(file, problem).type() == std::filesystem::file_type::not_found)
    return std::nullopt;
  motion::require_regular_file(file, "search index");
  require(is_ours || looks_like_index(file), file.string(),
          " is not a search index and will not be replaced by one; give --index another file");
  try {
    std::optional<SearchIndex> index = SearchIndex::read(file, format, clips);
    if (!index)
      warnings.push_back(
          concat("the index ", file.string(), " was made for another model's format; rebuilding it"));
    return index;
  } catch (const std::exception& error) {
    warnings.push_back(concat("the index cannot be used (", error.what(), "); rebuilding it"));
    return std::nullopt;
  }
}

}  // namespace search_detail

/// Opens the index of all motion files in a folder and its subfolders, or of one file, for models of this
/// format. `options` say how the files are read; clips of another size are scaled to the model's.
///
/// The index is stored in `file`, by default search_index_file(). Files whose size and modification time are
/// unchanged are not read again. Clips shorter than a window, unreadable files and files of another skeleton
/// are left out, and recorded as such. An index that cannot be written is a warning, not an error; a damaged
/// one is rebuilt with a warning. Throws Error if no clip is left, giving the reason for the first one, and
/// if `file` exists and is not an index.
inline SearchCollection open_search_collection(const std::filesystem::path& folder,
                                               const motion::MotionFormat& format,
                                               const std::filesystem::path& file = {},
                                               const motion::ClipOptions& options = {}) {
  namespace fs = std::filesystem;
  const std::vector<fs::path> files = motion::find_motion_files(folder, {options.bones});
  const fs::path home = fs::is_directory(folder) ? folder : folder.parent_path();
  SearchCollection out{SearchIndex(format, options),
                       file.empty() ? search_index_file(home, format, options) : file,
                       0,
                       0,
                       0,
                       false,
                       {}};
  std::optional<SearchIndex> before =
      search_detail::old_index(out.file, file.empty(), format, options, out.warnings);
  std::map<std::string_view, const SearchClip*> known;
  if (before)
    for (const SearchClip& clip : before->clips()) known[clip.path] = &clip;

  const std::size_t skip = home.empty() ? 0 : (home / "").native().size();
  std::vector<SearchClip> clips(files.size());
  std::vector<const SearchClip*> same(files.size(), nullptr);
  std::vector<std::size_t> changed;
  for (std::size_t i = 0; i < files.size(); ++i) {
    std::error_code problem;
    clips[i].path = files[i].native().substr(skip);
    clips[i].size = static_cast<std::int64_t>(fs::file_size(motion::ClipPath(files[i]).file, problem));
    clips[i].modified = static_cast<std::int64_t>(
        fs::last_write_time(motion::ClipPath(files[i]).file, problem).time_since_epoch().count());
    const auto found = known.find(clips[i].path);
    if (found != known.end() && found->second->size == clips[i].size &&
        found->second->modified == clips[i].modified)
      same[i] = found->second;
    else
      changed.push_back(i);
  }
  std::vector<std::vector<float>> poses(files.size());
  std::vector<double> sizes(files.size(), 1);
  motion::in_two_threads(changed.size(), [&](std::size_t c) {
    const std::size_t i = changed[c];
    poses[i] = search_detail::encode_file(files[i], format, options, clips[i], sizes[i]);
  });
  out.read = changed.size();
  out.kept = files.size() - changed.size();
  std::size_t still = 0;
  for (const SearchClip& clip : clips) still += known.count(clip.path);
  out.removed = known.size() - still;
  if (before && changed.empty() && out.removed == 0) {
    out.index = std::move(*before);
  } else {
    for (std::size_t i = 0; i < files.size(); ++i) {
      if (same[i] != nullptr) {
        out.index.add_from(*before, *same[i]);
      } else {
        out.index.add(clips[i], poses[i]);
        poses[i] = {};
      }
    }
    try {
      fs::create_directories(fs::absolute(out.file).parent_path());
      out.index.write(out.file);
      out.written = true;
    } catch (const std::exception& error) {
      out.warnings.push_back(
          concat("the index could not be saved, so the next search will read all files again (", error.what(),
                 "); give --index a writable FILE"));
    }
  }
  const auto resized = std::find_if(sizes.begin(), sizes.end(), [](double size) { return size != 1; });
  if (resized != sizes.end())
    out.warnings.push_back(
        concat(std::count_if(sizes.begin(), sizes.end(), [](double size) { return size != 1; }),
               " files are scaled by leg length to the model's size; the first, ",
               clips[static_cast<std::size_t>(resized - sizes.begin())].path, ", by ", *resized));
  const std::string* reason = nullptr;
  std::size_t left_out = 0;
  for (const SearchClip& clip : out.index.clips())
    if (!clip.left_out.empty() && left_out++ == 0) reason = &clip.left_out;
  require(left_out < out.index.clips().size(), "no clip of ", folder.string(),
          " can be searched: ", reason != nullptr ? *reason : std::string());
  if (left_out > 0)
    out.warnings.push_back(
        concat(left_out, " of ", out.index.clips().size(), " files left out; the first: ", *reason));
  return out;
}

}  // namespace motiongan

// Bringing the index of a folder up to date: what is new or has changed is read, the rest is kept.
#pragma once
#include "motiongan/search/index.hpp"
#include "motiongan/formats/bvh_reader.hpp"

namespace motiongan {

/// An index, and what was done to have it.
struct SearchCollection {
  SearchIndex index;
  std::filesystem::path file;         ///< where the index is kept
  std::size_t read = 0;               ///< files that were read now
  std::size_t kept = 0;               ///< files that the index on disk had
  std::size_t removed = 0;            ///< files that it had and that are gone
  bool written = false;               ///< whether the index on disk is another now
  std::vector<std::string> warnings;  ///< what people should know, a sentence each
};

/// Where the index of a folder is kept unless somebody says otherwise: one file for each motion format.
inline std::filesystem::path search_index_file(const std::filesystem::path& folder,
                                               const motion::MotionFormat& format) {
  const std::string key = search_key(format);
  return folder / ".motiongan-search" /
         (search_detail::hexadecimal(search_detail::digest(key.data(), key.size())) + ".safetensors");
}

namespace search_detail {

/// A clip's poses in the model's format, at its rate, and what is known of the file. Files that are no use
/// say why in `left_out`.
inline std::vector<float> encode_file(const std::filesystem::path& path, const motion::MotionFormat& format,
                                      SearchClip& clip) {
  std::vector<float> poses;
  try {
    motion::Clip bvh = motion::read_bvh(path);
    format.require_skeleton(bvh.skeleton, "the clip " + clip.path);
    const double frame_time = bvh.frame_time;
    const std::size_t dropped = motion::drop_first_frames(bvh, motion::FirstFrame::automatic);
    clip.begin = static_cast<double>(dropped) * frame_time;
    motion::DatasetOptions options;
    options.frames = format.frames;
    options.rate = format.rate;
    options.root_position = format.layout.root_position();
    options.root_rotation = format.layout.root_rotation();
    const motion::EncodedClip encoded =
        encode_clip(motion::to_motion(bvh), options, 0, static_cast<int>(format.layout.root()));
    const std::size_t dof = format.layout.dof();
    std::vector<double> rows;  // every stride-th frame, as windows of a data set have them
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

/// Whether the file begins as an index does, whatever became of the rest of it; or is empty.
inline bool looks_like_index(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::string head(512, '\0');
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(in.gcount()));
  return head.empty() || head.find(version_key) != std::string::npos;
}

/// The index on disk where there is one to go on from; why not is added to `warnings`.
inline std::optional<SearchIndex> old_index(const std::filesystem::path& file, bool is_ours,
                                            const motion::MotionFormat& format,
                                            std::vector<std::string>& warnings) {
  if (!std::filesystem::exists(file)) return std::nullopt;
  require(is_ours || looks_like_index(file), file.string(),
          " is not a search index and will not be replaced by one; give --index another file");
  try {
    std::optional<SearchIndex> index = SearchIndex::read(file, format);
    if (!index)
      warnings.push_back(
          concat("the index ", file.string(), " was made for another model's format; making it anew"));
    return index;
  } catch (const std::exception& error) {
    warnings.push_back(concat("the index cannot be used (", error.what(), "); making it anew"));
    return std::nullopt;
  }
}

}  // namespace search_detail

/// The index of all BVH files in a folder and the folders in it, or of one file, for models of this format.
///
/// Kept in `file`, or where search_index_file() says. Files whose size and time are those of the index are
/// not read again. Clips shorter than a window, files that cannot be read and those of another skeleton are
/// left out, and remembered as such. An index that cannot be written is a warning, no error; a damaged one is
/// made anew, with a warning. Error where no clip is left, naming the first one's reason, and where `file` is
/// something else than an index.
inline SearchCollection open_search_collection(const std::filesystem::path& folder,
                                               const motion::MotionFormat& format,
                                               const std::filesystem::path& file = {}) {
  namespace fs = std::filesystem;
  const std::vector<fs::path> files = motion::find_bvh_files(folder);
  const fs::path home = fs::is_directory(folder) ? folder : folder.parent_path();
  SearchCollection out{
      SearchIndex(format), file.empty() ? search_index_file(home, format) : file, 0, 0, 0, false, {}};
  std::optional<SearchIndex> before = search_detail::old_index(out.file, file.empty(), format, out.warnings);
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
    clips[i].size = static_cast<std::int64_t>(fs::file_size(files[i], problem));
    clips[i].modified =
        static_cast<std::int64_t>(fs::last_write_time(files[i], problem).time_since_epoch().count());
    const auto found = known.find(clips[i].path);
    if (found != known.end() && found->second->size == clips[i].size &&
        found->second->modified == clips[i].modified)
      same[i] = found->second;
    else
      changed.push_back(i);
  }
  std::vector<std::vector<float>> poses(files.size());
  motion::in_two_threads(changed.size(), [&](std::size_t c) {
    const std::size_t i = changed[c];
    poses[i] = search_detail::encode_file(files[i], format, clips[i]);
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
          concat("the index could not be kept, and the next search will read all files again (", error.what(),
                 "); give --index FILE a place that can be written"));
    }
  }
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

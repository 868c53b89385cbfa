// The search index of a collection: its clips' poses in a model's format, in memory and on disk.
#pragma once
#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/data/clip_source.hpp"
#include "motiongan/data/motion_format_json.hpp"
#include "motiongan/io/safetensors.hpp"
#include "motiongan/search/distance.hpp"

namespace motiongan {

/// A file of a collection, as of when it was read.
struct SearchClip {
  std::string path;           ///< relative to the collection's folder, with /
  std::int64_t size = 0;      ///< bytes
  std::int64_t modified = 0;  ///< modification time, in ticks of the file system's clock
  std::size_t frames = 0;     ///< at the model's rate; 0 if the file was left out
  double begin = 0;           ///< seconds of the file before the first frame (a dropped T-pose)
  std::string left_out;       ///< why the file was left out; empty if it was not
  std::size_t first = 0;      ///< index of its first frame in SearchIndex::frames()
};

/// A window: a clip of the index and the window's first frame in it.
struct SearchWindow {
  std::size_t clip = 0, frame = 0;
};

/// The parts of a motion format that determine how a clip is encoded: models that agree in them share an
/// index.
inline std::string search_key(const motion::MotionFormat& format, const motion::ClipOptions& clips = {}) {
  nlohmann::json key = io::to_json(format);
  for (const char* part : {"vocabulary", "low", "high", "unit_metres", "clips_up"}) key.erase(part);
  motion::ClipOptions how = clips, usual;
  const nlohmann::json given = io::fields_to_json(fields_of(how));
  if (given != io::fields_to_json(fields_of(usual))) key["clips"] = given;
  return key.dump();
}

namespace search_detail {

/// FNV-1a over eight bytes at a time, for detecting damage and naming files.
inline std::uint64_t digest(const void* data, std::size_t bytes, std::uint64_t hash = 14695981039346656037u) {
  const auto* at = static_cast<const unsigned char*>(data);
  for (; bytes >= 8; at += 8, bytes -= 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, at, 8);
    hash = (hash ^ word) * 1099511628211u;
    hash ^= hash >> 29;
  }
  for (; bytes > 0; ++at, --bytes) hash = (hash ^ *at) * 1099511628211u;
  return hash;
}

inline std::string hexadecimal(std::uint64_t value) {
  char text[17] = {};
  const char* end = std::to_chars(text, text + 16, value, 16).ptr;
  return std::string(16 - static_cast<std::size_t>(end - text), '0') + text;
}

inline std::string checksum(const io::SafeTensors& file) {
  std::uint64_t hash = digest(nullptr, 0);
  for (const auto& [name, tensor] : file.tensors) hash = digest(tensor.data.data(), tensor.data.size(), hash);
  return hexadecimal(hash);
}

inline constexpr const char *version_key = "motiongan_search_index", *version = "1";

/// A safetensors file whose tensors are read straight into their destination: an index is large, and each
/// copy of it takes a good part of a query's time.
class IndexFile {
 public:
  explicit IndexFile(const std::filesystem::path& path) : where_(path.string()), in_(path, std::ios::binary) {
    std::error_code problem;
    const std::uint64_t size = std::filesystem::file_size(path, problem);
    std::uint64_t length = 0;
    require(in_.is_open() && !problem, where_, ": cannot be opened");
    read(&length, sizeof length);
    require(length <= size - sizeof length, where_, ": is truncated or is not a safetensors file");
    std::string text(length, '\0');
    read(text.data(), text.size());
    begin_ = sizeof length + length;
    header_ = io::parse_safetensors_header(text, size - begin_, where_);
  }

  std::string metadata(const char* key) const {
    const auto found = header_.metadata.find(key);
    return found == header_.metadata.end() ? std::string() : found->second;
  }

  /// The values of a tensor, as stored. Throws Error if it is missing or of another type.
  template <class T>
  std::vector<T> values(const char* name, std::string_view dtype) {
    const auto found = header_.entries.find(name);
    require(found != header_.entries.end(), where_, ": there is no tensor \"", name, "\"");
    const auto& entry = found->second;
    require(entry.dtype == dtype, where_, ": tensor \"", name, "\" is of type ", entry.dtype, ", expected ",
            dtype);
    std::vector<T> out((entry.offsets[1] - entry.offsets[0]) / sizeof(T));
    in_.seekg(static_cast<std::streamoff>(begin_ + entry.offsets[0]));
    read(out.data(), out.size() * sizeof(T));
    hash_ = digest(out.data(), out.size() * sizeof(T), hash_);
    return out;
  }

  /// Checksum of the tensors read so far; equals checksum() if all are read in the order of their names.
  std::string checksum_so_far() const { return hexadecimal(hash_); }

 private:
  void read(void* to, std::size_t bytes) {
    in_.read(static_cast<char*>(to), static_cast<std::streamsize>(bytes));
    require(static_cast<std::size_t>(in_.gcount()) == bytes, where_, ": is truncated or cannot be read");
  }

  std::string where_;
  std::ifstream in_;
  std::uint64_t begin_ = 0, hash_ = digest(nullptr, 0);
  io::SafeTensorsHeader header_;
};

}  // namespace search_detail

/// The clips of a collection in a model's format.
class SearchIndex {
 public:
  /// An index without clips.
  explicit SearchIndex(const motion::MotionFormat& format, const motion::ClipOptions& clips = {})
      : format_(format), reading_(clips), layout_(format) {}

  const motion::MotionFormat& format() const { return format_; }
  const SearchLayout& layout() const { return layout_; }
  const std::vector<SearchClip>& clips() const { return clips_; }  ///< in the order of their paths
  /// The normalised poses of all clips.
  const SearchFrames& frames() const { return frames_; }

  /// Adds a clip and its normalised poses [clip.frames, dof]. Throws Error for another size.
  void add(SearchClip clip, std::span<const float> poses) {
    require(poses.size() == clip.frames * format_.dof(), "clip ", clip.path, " of ", clip.frames,
            " frames has ", poses.size(), " values, expected ", clip.frames, " x ", format_.dof());
    clip.first = rows_;
    rows_ += clip.frames;
    frames_.add(layout_, poses);
    clips_.push_back(std::move(clip));
  }

  /// Copies a clip from another index of the same format.
  void add_from(const SearchIndex& other, const SearchClip& clip) {
    const auto copy = [&](const std::vector<float>& from, std::vector<float>& to, std::size_t width) {
      const auto begin = from.begin() + static_cast<std::ptrdiff_t>(clip.first * width);
      to.insert(to.end(), begin, begin + static_cast<std::ptrdiff_t>(clip.frames * width));
    };
    copy(other.frames_.plain, frames_.plain, layout_.columns());
    copy(other.frames_.track, frames_.track, layout_.track.size());
    clips_.push_back(clip);
    clips_.back().first = rows_;
    rows_ += clip.frames;
  }

  /// The windows of every clip, `hop` frames apart, and the last one. Throws Error if hop is 0.
  std::vector<SearchWindow> windows(std::size_t hop) const {
    require(hop > 0, "hop is 0, expected at least 1");
    std::vector<SearchWindow> out;
    for (std::size_t c = 0; c < clips_.size(); ++c) {
      if (clips_[c].frames < format_.frames) continue;
      const std::size_t last = clips_[c].frames - format_.frames;
      for (std::size_t frame = 0; frame < last; frame += hop) out.push_back({c, frame});
      out.push_back({c, last});
    }
    return out;
  }

  /// The windows' first frames, as indices into frames().
  std::vector<std::size_t> starts(const std::vector<SearchWindow>& windows) const {
    std::vector<std::size_t> out;
    for (const SearchWindow& window : windows) out.push_back(clips_.at(window.clip).first + window.frame);
    return out;
  }

  /// The normalised poses of a window, [N, dof].
  std::vector<float> poses(const SearchWindow& window) const {
    return frames_.window(format_, layout_, clips_.at(window.clip).first + window.frame, format_.frames);
  }

  /// Writes the index to a temporary file, then renames it to `path`.
  void write(const std::filesystem::path& path) const {
    using io::SafeTensor;
    std::vector<std::int64_t> size, modified, frames;
    std::vector<double> begin;
    std::vector<std::uint8_t> names;  // path \0 reason \0 ...
    for (const SearchClip& clip : clips_) {
      size.push_back(clip.size), modified.push_back(clip.modified);
      frames.push_back(static_cast<std::int64_t>(clip.frames)), begin.push_back(clip.begin);
      for (const std::string* text : {&clip.path, &clip.left_out}) {
        names.insert(names.end(), text->begin(), text->end());
        names.push_back(0);
      }
    }
    io::SafeTensors file;
    const std::size_t n = clips_.size();
    file.tensors = {{"size", SafeTensor::of({n}, size)},
                    {"modified", SafeTensor::of({n}, modified)},
                    {"frames", SafeTensor::of({n}, frames)},
                    {"begin", SafeTensor::of({n}, begin)},
                    {"names", SafeTensor::of({names.size()}, names)},
                    {"plain", SafeTensor::of({rows_, layout_.columns()}, frames_.plain)},
                    {"track", SafeTensor::of({rows_, layout_.track.size()}, frames_.track)}};
    file.metadata = {{"checksum", search_detail::checksum(file)},
                     {search_detail::version_key, search_detail::version},
                     {"search_format", search_key(format_, reading_)}};
    file.write(path);
  }

  /// Reads an index written by write(); nothing if it was written for another format. Throws Error, saying
  /// what is wrong, if the file is damaged or not an index.
  static std::optional<SearchIndex> read(const std::filesystem::path& path,
                                         const motion::MotionFormat& format,
                                         const motion::ClipOptions& clips = {}) {
    search_detail::IndexFile file(path);
    require(file.metadata(search_detail::version_key) == search_detail::version, path.string(),
            ": not a search index of this version");
    if (file.metadata("search_format") != search_key(format, clips)) return std::nullopt;
    SearchIndex index(format, clips);
    const auto begin = file.values<double>("begin", "F64");
    const auto frames = file.values<std::int64_t>("frames", "I64");
    const auto modified = file.values<std::int64_t>("modified", "I64");
    const auto names = file.values<char>("names", "U8");
    index.frames_.plain = file.values<float>("plain", "F32");
    const auto size = file.values<std::int64_t>("size", "I64");
    index.frames_.track = file.values<float>("track", "F32");
    require(file.metadata("checksum") == file.checksum_so_far(), path.string(), ": its checksum is wrong");
    const std::size_t n = size.size();
    require(modified.size() == n && frames.size() == n && begin.size() == n, path.string(),
            ": its lists of clips differ in length");
    const std::size_t rows = index.frames_.plain.size() / index.layout_.columns();
    auto at = names.begin();
    const auto text = [&] {
      const auto end = std::find(at, names.end(), '\0');
      require(end != names.end(), path.string(), ": its list of names is cut short");
      std::string out(at, end);
      at = end + 1;
      return out;
    };
    for (std::size_t i = 0; i < n; ++i) {
      require(frames[i] >= 0 && static_cast<std::size_t>(frames[i]) <= rows - index.rows_, path.string(),
              ": clip ", i, " has ", frames[i], " frames, and ", rows - index.rows_, " are left");
      SearchClip clip{text(),   size[i], modified[i], static_cast<std::size_t>(frames[i]),
                      begin[i], {},      index.rows_};
      clip.left_out = text();
      index.rows_ += clip.frames;
      index.clips_.push_back(std::move(clip));
    }
    require(index.frames_.plain.size() == index.rows_ * index.layout_.columns() &&
                index.frames_.track.size() == index.rows_ * index.layout_.track.size(),
            path.string(), ": its number of frames differs from that of its clips");
    return index;
  }

 private:
  motion::MotionFormat format_;
  motion::ClipOptions reading_;
  SearchLayout layout_;
  std::vector<SearchClip> clips_;
  SearchFrames frames_;
  std::size_t rows_ = 0;
};

}  // namespace motiongan

// BVH reader for any skeleton and any channels; every error gives its place in the file.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/formats/bvh_cursor.hpp"
#include "motiongan/formats/bvh_hierarchy.hpp"
#include "motiongan/formats/text_file.hpp"
#include "motiongan/motion/frame_rate.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

namespace bvh_detail {

/// What the lines below MOTION say.
struct MotionHeader {
  std::size_t frames = 0, frames_place = 0;  ///< the announced number of frames
  double frame_time = 0;
  std::size_t time_place = 0;
};

inline MotionHeader read_motion_header(Cursor& in) {
  MotionHeader out;
  in.expect("MOTION", " after the skeleton");
  in.expect_label("Frames:");
  in.skip_space();
  out.frames_place = in.place();
  out.frames = in.count("the number of frames");
  in.expect_label("Frame Time:");
  in.skip_space();
  out.time_place = in.place();
  out.frame_time = in.number("the seconds between two frames");
  if (out.frame_time < 1e-6)
    in.fail_at(out.time_place, "found a frame time of ", out.frame_time,
               " seconds, expected at least 0.000001");
  if (!in.at_line_end())
    in.fail_at(in.place(), "found ", Cursor::quoted(in.peek()),
               ", expected the end of the line after the frame time");
  return out;
}

/// Reads frames up to the end of the text, or up to `stop`, where an incomplete last line starts. `kept` is
/// that of Hierarchy.
inline void read_frames(Cursor& in, const std::vector<char>& kept, std::size_t announced, std::size_t stop,
                        Clip& clip) {
  const std::size_t width = kept.size();
  const bool all = std::find(kept.begin(), kept.end(), 0) == kept.end();
  for (in.skip_space(); !in.at_end(); in.skip_space()) {
    const std::size_t start = in.place();
    if (start == stop && clip.frames > 0) return;
    if (clip.frames >= announced && !in.at_number())
      in.fail_at(start, "found ", Cursor::quoted(in.peek()), ", expected the end of the file");
    for (std::size_t i = 0; i < width; ++i) {
      if (in.at_line_end())
        in.fail_at(in.place(), "frame ", clip.frames + 1, " has ", i, " values, expected ", width);
      const double value = in.number_here("a channel's value");
      if (all || kept[i]) clip.channels.push_back(value);
    }
    if (!in.at_line_end()) {
      std::size_t extra = 0;
      const std::size_t place = in.place();
      for (; !in.at_line_end(); ++extra) in.next();
      in.fail_at(place, "frame ", clip.frames + 1, " has ", width + extra, " values, expected ", width);
    }
    ++clip.frames;
  }
}

/// A duration in the unit that suits it: "2.5 h".
inline std::string duration(double seconds) {
  const auto rounded = [](double value) { return std::round(10 * value) / 10; };
  if (seconds >= 3600) return concat(rounded(seconds / 3600), " h");
  if (seconds >= 120) return concat(rounded(seconds / 60), " min");
  return concat(seconds, " s");
}

/// A note on a frame time that is unlikely in seconds, or that stands for a standard rate; else empty.
inline std::string frame_time_note(double frame_time, std::size_t frames) {
  if (frame_time >= 1e-3 && frame_time < 1) return rate_note(frame_time);
  const std::string length = duration(frame_time * static_cast<double>(frames));
  const double rate = rate_from_frame_time(frame_time);
  if (frame_time <= 1)
    return concat("a frame time of ", frame_time, " s is ", rate, rate == 1 ? " frame" : " frames",
                  " per second and makes this clip last ", length,
                  "; if another rate is meant, give it with --fps");
  const std::string found = concat("a frame time of ", frame_time, " s makes this clip last ", length);
  // 33.3333 is more likely milliseconds, 30 and 29.97 frames per second.
  const double ntsc = std::round(frame_time) * 1000 / 1001;
  if (frame_time == std::round(frame_time) || std::abs(frame_time - ntsc) <= 5e-4 * ntsc)
    return concat(found, "; if it is meant as ", frame_time, " frames per second, give --fps ", frame_time);
  return concat(found, "; if it is meant in milliseconds, give --fps ",
                rate_from_frame_time(frame_time / 1000));
}

}  // namespace bvh_detail

/// Reads the HIERARCHY part of a BVH text, which may end after it. `name` is what messages call the text.
/// Throws Error as `name:line:column: ...`.
inline Skeleton parse_hierarchy(std::string_view text, std::string name) {
  bvh_detail::Cursor in(text, std::move(name));
  Skeleton skeleton = bvh_detail::read_hierarchy(in).skeleton;
  if (!in.peek().empty() && !bvh_detail::same_word(in.peek(), "MOTION"))
    in.fail_at(in.place(), "found ", bvh_detail::Cursor::quoted(in.peek()),
               ", expected MOTION or the end of the text");
  return skeleton;
}

/// Reads a whole BVH text, one frame per line; `name` becomes the clip's id and prefixes messages. What is
/// wrong but clear is read, with a note in Clip::notes: another number of frames than `Frames:` says, a last
/// line that is cut off (it is dropped), NUL bytes at the end, scale channels, joints of one name (renamed),
/// a second End Site of a joint, and frame times that are rounded or look like another unit. Throws Error as
/// `name:line:column: what was found, what was expected`; the column counts bytes.
inline Clip parse_bvh(std::string_view text, std::string name) {
  using bvh_detail::Cursor;
  Cursor in(text, name);
  const std::string padding = in.drop_padding();
  Clip clip;
  clip.id = std::move(name);
  bvh_detail::Hierarchy hierarchy = bvh_detail::read_hierarchy(in);
  clip.skeleton = std::move(hierarchy.skeleton);
  clip.notes = std::move(hierarchy.notes);
  const std::size_t width = hierarchy.kept.size(), channels = clip.skeleton.channel_count();
  const bvh_detail::MotionHeader header = bvh_detail::read_motion_header(in);
  clip.frame_time = header.frame_time;
  const std::size_t announced = header.frames;
  if (channels == 0 && announced > 0)
    in.fail_at(header.frames_place, "the skeleton has no channels but ", announced,
               " frames, expected channels");
  in.skip_space();
  if (channels == 0 && !in.at_end())
    in.fail_at(in.place(), "found ", Cursor::quoted(in.peek()),
               ", expected the end of the file: the skeleton has no channels");

  // A number takes at least two bytes: do not reserve memory for more frames than the file can hold.
  if (width > 0)
    clip.channels.reserve(announced <= in.left() / (2 * width) + 1 ? announced * channels
                                                                   : in.left() / 2 + width);
  const std::size_t stop = in.incomplete_last_line(width);
  bvh_detail::read_frames(in, hierarchy.kept, announced, stop, clip);
  if (clip.frames == 0 && announced > 0)
    in.fail_at(in.place(), "found the end of the file, expected ", announced,
               " frames as the line 'Frames:' says");

  const auto add_note = [&](std::size_t at, const auto&... parts) {
    clip.notes.push_back(in.note_at(at, parts...));
  };
  if (clip.frames != announced)
    add_note(header.frames_place, "Frames: says ", announced, ", found ",
             clip.frames < announced ? "only " : "", clip.frames,
             clip.frames == 1 ? " frame; it is read" : concat(" frames; all ", clip.frames, " are read"));
  if (const std::string note = bvh_detail::frame_time_note(clip.frame_time, clip.frames); !note.empty())
    add_note(header.time_place, note);
  if (!in.at_end())
    add_note(stop, "the last line is cut off: it does not hold the ", width,
             " values of a frame, and is ignored");
  if (!padding.empty()) clip.notes.push_back(padding);
  return clip;
}

/// Reads a BVH file with parse_bvh; the clip's id is the file name without folder and extension. Throws Error
/// if the file cannot be read or parsed.
inline Clip read_bvh(const std::filesystem::path& path) {
  const std::string text = read_text(path, "BVH file");
  require(!text.empty(), path.string(), " is empty, expected a BVH file");
  Clip clip = parse_bvh(text, path.string());
  clip.id = path.stem().string();
  return clip;
}

}  // namespace motiongan::motion

// Joint positions as CSV, one frame per line.
#pragma once
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/formats/bone_list.hpp"
#include "motiongan/io/read_number.hpp"
#include "motiongan/motion/motion.hpp"
#include "motiongan/motion/position_clip.hpp"

namespace motiongan::motion {

namespace position_csv_detail {

/// The last character of each line: CR in files of old Macintosh programs, which have no LF.
inline char line_end_of(std::string_view text) { return text.find('\n') == text.npos ? '\r' : '\n'; }

/// The separator of columns. Spreadsheets write ';' where the comma is the decimal point.
inline char separator_of(std::string_view header) {
  for (const char c : {',', ';', '\t'})
    if (header.find(c) != header.npos) return c;
  return ',';
}

/// Removes and returns the next line of `text`, without its line break.
inline std::string_view take_line(std::string_view& text, char line_end) {
  std::string_view line = text.substr(0, text.find(line_end));
  text.remove_prefix(std::min(text.size(), line.size() + 1));
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

/// Splits `line` at `separator`; fields are trimmed.
inline void split_fields(std::string_view line, char separator, std::vector<std::string_view>& out) {
  out.clear();
  for (std::size_t at = 0;;) {
    const std::size_t stop = std::min(line.find(separator, at), line.size());
    std::string_view field = line.substr(at, stop - at);
    const std::size_t first = field.find_first_not_of(" \t");
    out.push_back(first == field.npos ? std::string_view()
                                      : field.substr(first, field.find_last_not_of(" \t") - first + 1));
    if (stop == line.size()) return;
    at = stop + 1;
  }
}

/// The columns of a position file, and where each goes in a frame of [joints, 3].
struct CsvColumns {
  bool time = false;               ///< the first column is the time in seconds
  std::vector<std::size_t> place;  ///< [columns without time], 3 * joint + axis
};

/// Throws Error as `name:1: ...` for an unknown, duplicate or missing column.
inline CsvColumns parse_csv_header(const std::vector<std::string_view>& fields, const Skeleton& skeleton,
                                   std::string_view name) {
  CsvColumns out;
  out.time = fields.front() == "time";
  std::vector<char> seen(3 * skeleton.size(), 0);
  for (std::size_t i = out.time ? 1 : 0; i < fields.size(); ++i) {
    const std::string_view field = fields[i];
    // A joint's name may itself contain a dot, so the axis follows the last one.
    const std::size_t dot = field.rfind('.');
    const std::string_view axis = dot == field.npos ? std::string_view() : field.substr(dot + 1);
    require(axis == "x" || axis == "y" || axis == "z", name, ":1: column ", i + 1, " is called '", field,
            "', expected a joint's name and .x, .y or .z as in Hips.x (the first column may be time)");
    const int joint = skeleton.find(field.substr(0, dot));
    require(joint >= 0, name, ":1: column ", i + 1, " is for joint '", field.substr(0, dot),
            "', which is not in the bone list");
    const std::size_t place =
        3 * static_cast<std::size_t>(joint) + static_cast<std::size_t>(axis.front() - 'x');
    require(!seen[place], name, ":1: the column '", field, "' appears twice");
    seen[place] = 1;
    out.place.push_back(place);
  }
  for (std::size_t p = 0; p < seen.size(); ++p)
    require(seen[p], name, ":1: the column '", skeleton.joints[p / 3].name, ".",
            static_cast<char>('x' + static_cast<char>(p % 3)),
            "' is missing; expected x, y and z of every joint in the bone list");
  return out;
}

/// Frames per second from times in seconds. Throws Error as `name: ...` if they are not evenly spaced.
/// `lines` [frames] are their line numbers.
inline double rate_from_times(const std::vector<double>& times, const std::vector<std::size_t>& lines,
                              std::string_view name) {
  const double step = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
  require(step > 0, name, ": the times go from ", times.front(), " to ", times.back(),
          " s, expected increasing times");
  // Times are often rounded to a millisecond, so a tenth of a frame is tolerated; a lost frame is not.
  for (std::size_t f = 0; f < times.size(); ++f)
    require(std::abs(times[f] - (times.front() + step * static_cast<double>(f))) <= 0.1 * step, name, ":",
            lines[f], ": the time is ", times[f], " s, expected ",
            times.front() + step * static_cast<double>(f), " s at a constant rate; resample the file");
  return rate_from_frame_time(step);
}

}  // namespace position_csv_detail

/// Reads text whose first line names the columns (`Hips.x,Hips.y,Hips.z,...`: x, y and z of every joint of
/// `skeleton`, joints in any order) and whose other lines are frames. Columns are separated by commas, or by
/// ';' or tabs if the first line has no comma; numbers have a decimal point. With a first column `time`
/// (seconds) the rate is taken from it, otherwise it is `rate`, in frames per second. Positions are world
/// coordinates, y up, in the file's unit. Names and parents come from `skeleton`, offsets from the positions
/// (with_offsets_of). Throws Error as `name:line: ...` for wrong columns, wrong numbers of fields, values
/// that are not finite, and uneven times.
inline PositionClip parse_position_csv(std::string_view text, const Skeleton& skeleton, double rate,
                                       std::string_view name) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  const char line_end = position_csv_detail::line_end_of(text);
  const std::string_view header = position_csv_detail::take_line(text, line_end);
  const char separator = position_csv_detail::separator_of(header);
  std::vector<std::string_view> fields;
  position_csv_detail::split_fields(header, separator, fields);
  const position_csv_detail::CsvColumns columns =
      position_csv_detail::parse_csv_header(fields, skeleton, name);
  const std::size_t width = fields.size(), shift = columns.time ? 1 : 0;

  PositionClip out;
  std::vector<double> times;
  std::vector<std::size_t> lines;
  for (std::size_t line = 2; !text.empty(); ++line) {
    const std::string_view raw = position_csv_detail::take_line(text, line_end);
    if (raw.find_first_not_of(" \t") == raw.npos) continue;
    position_csv_detail::split_fields(raw, separator, fields);
    require(fields.size() == width, name, ":", line, ": found ", fields.size(), " fields, expected ", width,
            " as in the first line");
    const std::size_t frame = out.positions.size();
    out.positions.resize(frame + skeleton.size());
    for (std::size_t i = 0; i < width; ++i) {
      const std::string_view field = fields[i].substr(fields[i].starts_with('+') ? 1 : 0);
      const std::size_t place = i < shift ? 0 : columns.place[i - shift];
      double value = 0;
      const auto [stop, problem] = io::read_number(field.data(), field.data() + field.size(), value);
      const bool number = problem == std::errc() && stop == field.data() + field.size();
      if (!number || !std::isfinite(value))
        throw Error(name, ":", line, ": found '", fields[i].substr(0, 40), "' in column ", i + 1, " (",
                    i < shift ? std::string("time") : "joint '" + skeleton.joints[place / 3].name + "'",
                    "), expected a finite number with a decimal point",
                    fields[i].find(',') == field.npos ? "" : ", not a decimal comma: write 1.5, not 1,5");
      if (i < shift)
        times.push_back(value);
      else
        out.positions[frame + place / 3][place % 3] = value;
    }
    lines.push_back(line);
  }
  out.frames = lines.size();
  require(out.frames > 0, name, ": found no frames below the header line, expected one per line");
  out.rate = times.size() > 1 ? position_csv_detail::rate_from_times(times, lines, name) : rate;
  require(std::isfinite(out.rate) && out.rate > 0, name, ": the rate is ", rate,
          " frames per second, expected more than 0; add a first column 'time' in seconds, or give the rate: "
          "--rate or --fps on the command line, the argument `rate` in the API");
  out.skeleton = with_offsets_of(skeleton, out.positions);
  return out;
}

/// Throws Error unless the clip can be written: sizes match, all values are finite, the rate is above 0.
inline void check_writable(const PositionClip& clip) {
  const std::size_t joints = clip.skeleton.size();
  require(joints > 0 && clip.positions.size() == clip.frames * joints, "clip '", clip.id, "' has ",
          clip.positions.size(), " positions, expected ", clip.frames, " frames x ", joints, " joints");
  require(std::isfinite(clip.rate) && clip.rate > 0, "clip '", clip.id, "' has a rate of ", clip.rate,
          " frames per second, expected more than 0");
  for (std::size_t i = 0; i < clip.positions.size(); ++i)
    for (const double v : clip.positions[i])
      require(std::isfinite(v), "clip '", clip.id, "', frame ", i / joints + 1, ", joint '",
              clip.skeleton.joints[i % joints].name, "': found ", v, ", expected a finite number");
}

/// The clip as text that parse_position_csv reads: a column `time`, then x, y, z of every joint. Positions
/// are rounded to single precision and written in the fewest digits that preserve it. Throws Error for names
/// that a column cannot hold (a comma, a line break).
inline std::string format_position_csv(const PositionClip& clip) {
  check_writable(clip);
  std::string out = "time";
  for (const Joint& j : clip.skeleton.joints) {
    require(j.name.find_first_of(",\r\n") == j.name.npos, "a joint called '", j.name,
            "' cannot be written as CSV: a name must not contain a comma or a line break");
    for (const char axis : {'x', 'y', 'z'}) out.append(",").append(j.name).append(".") += axis;
  }
  out += '\n';
  std::array<char, 64> digits{};
  const auto append = [&](auto value) {
    out.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr);
  };
  for (std::size_t f = 0; f < clip.frames; ++f) {
    append(std::round(static_cast<double>(f) / clip.rate * 1e9) / 1e9);
    for (std::size_t j = 0; j < clip.skeleton.size(); ++j)
      for (const double v : clip.positions[f * clip.skeleton.size() + j]) {
        out += ',';
        append(static_cast<float>(v) + 0.0F);  // no -0
      }
    out += '\n';
  }
  return out;
}

}  // namespace motiongan::motion

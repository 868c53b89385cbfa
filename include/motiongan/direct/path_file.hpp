// A path over the ground as a text file.
#pragma once
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "motiongan/direct/constraints.hpp"
#include "motiongan/formats/tab_lines.hpp"
#include "motiongan/formats/text_file.hpp"
#include "motiongan/io/read_number.hpp"

namespace motiongan {

namespace detail {

/// The cells of a line of a CSV file, trimmed; separated by commas, semicolons or tabs.
inline std::vector<std::string_view> path_cells(std::string_view line) {
  std::vector<std::string_view> out;
  for (;;) {
    const std::size_t end = line.find_first_of(",;\t");
    out.push_back(motion::trimmed(line.substr(0, end)));
    if (end == line.npos) return out;
    line.remove_prefix(end + 1);
  }
}

/// A finite number, and nothing else in the cell.
inline std::optional<double> path_number(std::string_view cell) {
  double value = 0;
  const auto [end, code] = io::read_number(cell.data(), cell.data() + cell.size(), value);
  if (code != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value)) return {};
  return value;
}

}  // namespace detail

/// Reads the points of a path: a line each with x and z and, optionally, the time in seconds and the heading
/// in degrees about y from +z, in this order, or in that of a first line that names them (x, z, time,
/// heading; other columns are not read). An empty cell means that the point has none. Blank lines and lines
/// that start with # are skipped. Throws Error as `file:line: ...`.
inline std::vector<PathPoint> read_path(const std::filesystem::path& file) {
  const std::string name = file.string(), text = motion::read_text(file, "path", motion::largest_list_file);
  constexpr std::array<std::string_view, 4> known{"x", "z", "time", "heading"};
  std::array<std::optional<std::size_t>, 4> column{0, 1, 2, 3};
  std::vector<PathPoint> out;
  bool first = true;
  motion::for_each_line(text, name, [&](const motion::TextLine& line) {
    const std::vector<std::string_view> cells = detail::path_cells(line.raw);
    if (std::exchange(first, false) && !detail::path_number(cells.front()) && !cells.front().empty()) {
      for (std::size_t k = 0; k < known.size(); ++k) {
        column[k].reset();
        for (std::size_t i = 0; i < cells.size(); ++i)
          if (cells[i] == known[k]) column[k] = i;
        require(k > 1 || column[k], name, ":", line.number, ": found '", line.text.substr(0, 60),
                "', which names no column ", known[k], "; expected x, z and, optionally, time and heading");
      }
      return;
    }
    std::array<std::optional<double>, 4> value;
    for (std::size_t k = 0; k < known.size(); ++k) {
      if (!column[k] || *column[k] >= cells.size() || cells[*column[k]].empty()) {
        require(k > 1, name, ":", line.number, ": found '", line.text.substr(0, 60), "' without ", known[k],
                "; expected x and z");
        continue;
      }
      const std::string_view cell = cells[*column[k]];
      value[k] = detail::path_number(cell);
      require(value[k].has_value(), name, ":", line.number, ": found '", cell.substr(0, 40), "' as ",
              known[k], ", expected a number");
    }
    if (value[3]) value[3] = motion::radians(*value[3]);
    out.push_back({*value[0], *value[1], value[2], value[3]});
  });
  require(out.size() >= 2, name, " has ", out.size(), out.size() == 1 ? " point" : " points",
          ", expected a line of x and z for each of at least 2");
  return out;
}

}  // namespace motiongan

// The log of a training run: a CSV file, one row of numbers per logged iteration.
#pragma once
#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/io/atomic_file.hpp"
#include "motiongan/io/read_number.hpp"

namespace motiongan {

/// A log as CsvLog writes it.
struct CsvTable {
  std::vector<std::string> columns;       ///< the first one is "iteration"
  std::vector<std::vector<double>> rows;  ///< [rows][columns]

  /// The values of one column, [rows]. Throws Error if there is no such column.
  std::vector<double> column(std::string_view name) const {
    for (std::size_t c = 0; c < columns.size(); ++c) {
      if (columns[c] != name) continue;
      std::vector<double> out;
      for (const auto& row : rows) out.push_back(row[c]);
      return out;
    }
    throw Error("the log has no column '", name, "'");
  }
};

namespace detail {

inline std::vector<std::string_view> split_at_commas(std::string_view line) {
  std::vector<std::string_view> out;
  for (std::size_t from = 0;;) {
    const std::size_t comma = line.find(',', from);
    out.push_back(line.substr(from, comma == std::string_view::npos ? comma : comma - from));
    if (comma == std::string_view::npos) return out;
    from = comma + 1;
  }
}

/// The lines of a file that end in a newline; an unterminated last line is an incomplete write and is
/// dropped.
inline std::vector<std::string> whole_lines(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::vector<std::string> out;
  std::string line;
  while (std::getline(in, line) && !in.eof()) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    out.push_back(line);
  }
  require(!in.bad(), "cannot read the log ", path.string());
  return out;
}

/// Parses one line. Throws Error, naming file and line, unless it has `columns` numbers.
inline std::vector<double> csv_numbers(std::string_view line, std::size_t columns, std::size_t number,
                                       const std::filesystem::path& path) {
  std::vector<double> out;
  for (const std::string_view field : split_at_commas(line)) {
    double value = 0;
    const auto [end, problem] = io::read_number(field.data(), field.data() + field.size(), value);
    require(problem == std::errc{} && end == field.data() + field.size(), path.string(), ":", number, ": '",
            field, "' is not a number");
    out.push_back(value);
  }
  require(out.size() == columns, path.string(), ":", number, ": ", out.size(), " numbers, expected ", columns,
          " as in the header");
  return out;
}

}  // namespace detail

/// Reads a log that CsvLog wrote, without an incomplete last row. Throws Error for any other file.
inline CsvTable read_csv_log(const std::filesystem::path& path) {
  require(std::filesystem::is_regular_file(path), "there is no log at ", path.string());
  const std::vector<std::string> lines = detail::whole_lines(path);
  require(!lines.empty(), "the log ", path.string(), " has no header");
  CsvTable out;
  for (const std::string_view name : detail::split_at_commas(lines.front())) out.columns.emplace_back(name);
  for (std::size_t i = 1; i < lines.size(); ++i)
    out.rows.push_back(detail::csv_numbers(lines[i], out.columns.size(), i + 1, path));
  return out;
}

/// Appends rows of numbers to a CSV file, the iteration first. Each row is flushed, so that a run that dies
/// keeps its log.
class CsvLog {
 public:
  /// Opens the log at `path` with the columns "iteration" and `columns`. With `resume_after`, an existing log
  /// is continued: rows up to that iteration are kept; later rows, which a resumed run computes again, and an
  /// incomplete last row are removed. So is everything from the first line on that is no row, which a crash
  /// of the system can leave: see repair(). Throws Error if the header differs, if a new run would overwrite
  /// rows, or if the file cannot be written.
  CsvLog(std::filesystem::path path, const std::vector<std::string>& columns,
         std::optional<std::uint64_t> resume_after = std::nullopt)
      : path_(std::move(path)), columns_(columns.size()) {
    const std::string header = header_of(columns);
    std::vector<std::string> lines;
    if (std::filesystem::exists(path_)) lines = detail::whole_lines(path_);
    if (!lines.empty()) {
      require(lines.front() == header, path_.string(), ":1: the log has the columns '", lines.front(),
              "', this run has '", header, "'; move the file away or choose another folder");
      require(resume_after || lines.size() == 1, path_.string(), " already holds ", lines.size() - 1,
              " rows of another run; resume that run, move the file away or choose another folder");
    }
    std::string kept = header + "\n";
    for (std::size_t i = 1; i < lines.size(); ++i) {
      const std::optional<double> iteration = row_of(lines[i], i + 1);
      if (!iteration) break;
      if (*iteration > static_cast<double>(*resume_after)) continue;
      kept += lines[i] + "\n";
      last_ = static_cast<std::uint64_t>(*iteration);
    }
    io::AtomicFile file(path_);
    file.write(kept);
    file.commit();
    out_.open(path_, std::ios::binary | std::ios::app);
    require(out_.is_open(), "cannot append to the log ", path_.string(), "; check that it is writable");
  }

  /// What was removed because it was no row of the log; empty if nothing was.
  const std::string& repair() const { return repair_; }

  /// Appends a row; `values` are in the order of the columns. Throws Error if their number is wrong, if the
  /// iteration does not increase, or if writing fails.
  void append(std::uint64_t iteration, std::span<const double> values) {
    require(values.size() == columns_, "a row of ", values.size(), " values for the log ", path_.string(),
            ", expected ", columns_, " besides the iteration");
    require(!last_ || iteration > *last_, "iteration ", iteration, " comes after iteration ",
            last_.value_or(0), " in the log ", path_.string(), "; iterations must increase");
    std::string row = std::to_string(iteration);
    for (const double value : values) {
      char text[40];
      const auto [end, problem] = std::to_chars(text, text + sizeof text, value);  // shortest exact text
      row.append(",").append(text, problem == std::errc{} ? end : text);
    }
    row += "\n";
    out_.write(row.data(), static_cast<std::streamsize>(row.size()));
    out_.flush();
    require(out_.good(), "cannot write to the log ", path_.string(), "; the disk may be full");
    last_ = iteration;
  }

  /// The last iteration in the file, if there is one.
  std::optional<std::uint64_t> last_iteration() const { return last_; }

 private:
  static std::string header_of(const std::vector<std::string>& columns) {
    std::string header = "iteration";
    for (const std::string& name : columns) {
      require(!name.empty() && name.find_first_of(",\"\r\n") == std::string::npos, "'", name,
              "' is not a valid column name: it is empty or contains a comma, a quote or a line break");
      header += "," + name;
    }
    return header;
  }

  /// The iteration of line `number`; nothing, with repair() set, if the line is not a row that follows the
  /// rows before it.
  std::optional<double> row_of(const std::string& line, std::size_t number) {
    try {
      const double iteration = detail::csv_numbers(line, columns_ + 1, number, path_).front();
      require(iteration >= 0 && iteration < 1e18, path_.string(), ":", number, ": ", iteration,
              " is not an iteration number");
      return iteration;
    } catch (const Error& error) {
      repair_ = concat(error.what(), "; this line and all after it are removed");
      return std::nullopt;
    }
  }

  std::filesystem::path path_;
  std::size_t columns_;
  std::optional<std::uint64_t> last_;
  std::string repair_;
  std::ofstream out_;
};

/// The log of a run that is resumed after iteration `done`. `warn` receives what was repaired or is missing.
/// A log without a readable header is moved to `damaged`. Throws Error as CsvLog does.
inline std::shared_ptr<CsvLog> continued_log(const std::filesystem::path& path,
                                             const std::vector<std::string>& columns, std::uint64_t done,
                                             const std::filesystem::path& damaged,
                                             const std::function<void(const std::string&)>& warn) {
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 32 && c != '\r'; };
  if (std::filesystem::exists(path)) {
    const std::vector<std::string> lines = detail::whole_lines(path);
    if (lines.empty() || std::any_of(lines.front().begin(), lines.front().end(), is_control)) {
      std::filesystem::rename(path, damaged);
      warn(concat(path.string(), " has no readable header and is now ", damaged.string()));
    }
  }
  auto log = std::make_shared<CsvLog>(path, columns, done);
  if (!log->repair().empty()) warn(log->repair());
  if (done > 0 && !log->last_iteration())
    warn(concat(path.string(), " has no rows of iterations 1 to ", done, ": the curves begin after them"));
  return log;
}

}  // namespace motiongan

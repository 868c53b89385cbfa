// The numbers of a training run, row by row, in a file that any plotting tool reads.
#pragma once
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"

namespace motiongan {

/// A table of numbers as CsvLog writes it.
struct CsvTable {
  std::vector<std::string> columns;       ///< the first one is "iteration"
  std::vector<std::vector<double>> rows;  ///< [rows][columns]

  /// The values of one column, [rows]. Error where there is no such column.
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

/// The lines of a file that end in a newline: a last one without it was cut off while it was written.
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

/// The numbers of one line. Error with file and line number where it has not `columns` of them.
inline std::vector<double> csv_numbers(std::string_view line, std::size_t columns, std::size_t number,
                                       const std::filesystem::path& path) {
  std::vector<double> out;
  for (const std::string_view field : split_at_commas(line)) {
    double value = 0;
    const auto [end, problem] = std::from_chars(field.data(), field.data() + field.size(), value);
    require(problem == std::errc{} && end == field.data() + field.size(), path.string(), ":", number, ": '",
            field, "' is not a number");
    out.push_back(value);
  }
  require(out.size() == columns, path.string(), ":", number, ": ", out.size(), " numbers; the header names ",
          columns, " columns");
  return out;
}

}  // namespace detail

/// Reads a log that CsvLog wrote; a last row that was cut off is left out. Error for anything else.
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

/// Appends rows of numbers to a CSV file, the iteration first; a row is out of this process when append
/// returns, so that a run that dies keeps its log.
class CsvLog {
 public:
  /// Begins the log at `path` with the columns "iteration" and `columns`. With `resume_after`, a log that is
  /// there is continued: its rows up to that iteration stay, later ones (which a resumed run computes again)
  /// and one that was cut off go. Error where the file's header differs; where a new run would write over a
  /// log that has rows; where the file cannot be written.
  CsvLog(std::filesystem::path path, const std::vector<std::string>& columns,
         std::optional<std::uint64_t> resume_after = std::nullopt)
      : path_(std::move(path)), columns_(columns.size()) {
    std::string header = "iteration";
    for (const std::string& name : columns) {
      require(!name.empty() && name.find_first_of(",\"\r\n") == std::string::npos, "'", name,
              "' cannot name a column of a log: it is empty or has a comma, a quote or a line break");
      header += "," + name;
    }
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
      const double iteration = detail::csv_numbers(lines[i], columns_ + 1, i + 1, path_).front();
      require(iteration >= 0 && iteration < 1e18, path_.string(), ":", i + 1, ": ", iteration,
              " is not the number of an iteration");
      if (iteration > static_cast<double>(*resume_after)) continue;
      kept += lines[i] + "\n";
      last_ = static_cast<std::uint64_t>(iteration);
    }
    replace_with(kept);
    out_.open(path_, std::ios::binary | std::ios::app);
    require(out_.is_open(), "cannot append to the log ", path_.string(), "; check that it may be written to");
  }

  /// Adds a row. Iterations must grow; `values` are in the order of the columns.
  void append(std::uint64_t iteration, std::span<const double> values) {
    require(values.size() == columns_, "a row of ", values.size(), " values for the log ", path_.string(),
            ", which has ", columns_, " columns beside the iteration");
    require(!last_ || iteration > *last_, "iteration ", iteration, " comes after iteration ",
            last_.value_or(0), " in the log ", path_.string(), "; iterations must grow");
    std::string row = std::to_string(iteration);
    for (const double value : values) {
      char text[40];
      const auto [end, problem] = std::to_chars(text, text + sizeof text, value);  // shortest exact form
      row.append(",").append(text, problem == std::errc{} ? end : text);
    }
    row += "\n";
    out_.write(row.data(), static_cast<std::streamsize>(row.size()));
    out_.flush();
    require(out_.good(), "cannot write to the log ", path_.string(), "; is there room on the disk?");
    last_ = iteration;
  }

  /// The last iteration in the file, where there is one.
  std::optional<std::uint64_t> last_iteration() const { return last_; }

 private:
  void replace_with(const std::string& text) {
    std::filesystem::path beside = path_;
    beside += ".tmp";
    std::ofstream out(beside, std::ios::binary);
    out.write(text.data(), static_cast<std::streamsize>(text.size()));
    out.close();
    std::error_code problem;
    if (out) std::filesystem::rename(beside, path_, problem);
    if (out && !problem) return;
    std::error_code ignored;
    std::filesystem::remove(beside, ignored);
    throw Error("cannot write the log ", path_.string(),
                "; check that the folder exists and may be written to");
  }

  std::filesystem::path path_;
  std::size_t columns_;
  std::optional<std::uint64_t> last_;
  std::ofstream out_;
};

}  // namespace motiongan

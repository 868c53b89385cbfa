// Caption files in CSV, as spreadsheets write them.
#pragma once
#include <algorithm>
#include <cstddef>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/data/caption_file.hpp"

namespace motiongan::motion {

namespace caption_detail {

/// Reads the rows of a CSV text, skipping blank rows and lines that start with #. Fields are separated by the
/// first comma, semicolon or tab outside quotes; they may be quoted, with "" for a quote.
class CsvRows {
 public:
  CsvRows(std::string_view text, std::string_view name)
      : text_(without_byte_order_mark(text, name)), name_(name) {}

  std::size_t line() const { return first_line_; }  ///< where the row begins
  char separator() const { return separator_; }

  /// Reads the next row; false at the end. Throws Error as `name:line: ...`.
  bool next(std::vector<std::string>& row) {
    for (;;) {
      row.clear();
      if (text_.empty()) return false;
      first_line_ = line_ + 1;
      std::string_view rest = text_;
      const std::string_view line = take_line(rest);
      if (trimmed(line).empty() || trimmed(line).front() == '#') {
        text_ = rest;
        ++line_;
        continue;
      }
      if (separator_ == 0) separator_ = separator_of(line);
      const std::string_view before = text_;
      do row.push_back(field());
      while (!row_ends());
      require_utf8(before.substr(0, before.size() - text_.size()), name_, first_line_);
      return true;
    }
  }

 private:
  static char separator_of(std::string_view line) {
    bool quoted = false;
    for (const char c : line) {
      if (c == '"') quoted = !quoted;
      if (!quoted && (c == ',' || c == ';' || c == '\t')) return c;
    }
    return ',';
  }

  bool at_line_end() const { return text_.empty() || text_.front() == '\n' || text_.front() == '\r'; }

  /// Reads the separator or line end that follows a field.
  bool row_ends() {
    if (!at_line_end()) {
      text_.remove_prefix(1);
      return false;
    }
    take_line(text_);
    ++line_;
    return true;
  }

  std::string field() {
    while (!text_.empty() && text_.front() == ' ') text_.remove_prefix(1);
    if (!text_.starts_with('"')) {
      const char ends[] = {'\r', '\n', separator_};
      const std::string_view plain = text_.substr(0, text_.find_first_of(std::string_view(ends, 3)));
      text_.remove_prefix(plain.size());
      return std::string(trimmed(plain));
    }
    const std::size_t start = line_ + 1;
    text_.remove_prefix(1);
    std::string out;
    for (;;) {
      const std::string_view part = text_.substr(0, text_.find_first_of("\"\r\n"));
      out += part;
      text_.remove_prefix(part.size());
      require(!text_.empty(), name_, ":", start,
              ": found a quote that is not closed, expected \" at the end");
      if (text_.front() != '"') {
        take_line(text_);
        ++line_;
        out += ' ';
      } else if (text_.starts_with("\"\"")) {
        out += '"';
        text_.remove_prefix(2);
      } else {
        break;
      }
    }
    text_.remove_prefix(1);
    while (!text_.empty() && text_.front() == ' ') text_.remove_prefix(1);
    require(at_line_end() || text_.front() == separator_, name_, ":", line_ + 1, ": found '",
            text_.substr(0, std::min<std::size_t>(text_.find_first_of("\r\n"), 20)),
            "' after a closing quote, ", "expected a separator; write a quote inside quotes twice");
    return std::string(trimmed(out));
  }

  std::string_view text_, name_;
  std::size_t line_ = 0, first_line_ = 0;  // lines read; where the row began
  char separator_ = 0;
};

/// Where the first of `names` that is among the fields is.
template <class Names>
std::optional<std::size_t> column_of(const std::vector<std::string>& fields, const Names& names) {
  for (const std::string_view name : names)
    for (std::size_t c = 0; c < fields.size(); ++c)
      if (lower(fields[c]) == name) return c;
  return std::nullopt;
}

}  // namespace caption_detail

/// Reads rows of clip id and caption. Columns are separated by a comma, semicolon or tab, texts may be
/// quoted, and a header row may name the columns: id, clip, file or name, and caption, text or description;
/// others are ignored. Without one there are two columns. Throws Error as `name:line: ...`.
inline CaptionFile parse_caption_csv(std::string_view text, std::string_view name) {
  namespace detail = caption_detail;
  CaptionFile out{std::string(name), {}};
  detail::CsvRows rows(text, name);
  std::vector<std::string> row;
  std::size_t id = 0, caption = 1, columns = 2;
  bool has_header = false;
  for (bool first = true; rows.next(row); first = false) {
    if (first) {
      const auto id_column = detail::column_of(row, detail::id_names);
      const auto text_column = detail::column_of(row, detail::text_names);
      has_header = id_column && text_column;
      if (has_header) {
        id = *id_column, caption = *text_column, columns = row.size();
        continue;
      }
    }
    while (row.size() > columns && row.back().empty()) row.pop_back();
    const char separator[] = {rows.separator(), '\0'};
    require(row.size() <= columns && row.size() > std::max(id, caption), name, ":", rows.line(), ": found ",
            row.size(), row.size() == 1 ? " column" : " columns", ", expected ", columns,
            has_header ? std::string(" as in the header") : std::string(": clip id and caption"),
            row.size() > columns ? concat("; put a text that contains '", separator, "' in \"quotes\"",
                                          has_header ? "" : ", or name the columns in a header (id, caption)")
                                 : std::string());
    detail::add_caption(out, row[id], row[caption], rows.line());
  }
  return out;
}

}  // namespace motiongan::motion

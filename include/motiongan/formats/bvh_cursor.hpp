// A cursor over BVH text: words, names and numbers, and errors with line and column.
#pragma once
#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "motiongan/core/error.hpp"
#include "motiongan/formats/short_decimal.hpp"
#include "motiongan/io/read_number.hpp"

namespace motiongan::motion {

namespace bvh_detail {

inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }

/// LF, CRLF and CR alone (old Macintosh) end a line. Blank lines mean nothing, so CRLF needs no extra case.
inline bool is_line_end(char c) { return c == '\n' || c == '\r'; }

inline bool same_word(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) {
    return std::tolower(static_cast<unsigned char>(x)) == std::tolower(static_cast<unsigned char>(y));
  });
}

/// Reads through the text; errors give line and column.
class Cursor {
 public:
  Cursor(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {
    if (text_.starts_with("\xEF\xBB\xBF")) text_.remove_prefix(3);  // a UTF-8 byte order mark
  }

  /// Throws `file:line:column: parts` for the position `at`.
  template <class... Parts>
  [[noreturn]] void fail_at(std::size_t at, const Parts&... parts) const {
    const std::size_t start = text_.substr(0, at).find_last_of("\r\n") + 1;  // npos + 1 is 0
    throw Error(file_, ":", line_of(at), ":", at - start + 1, ": ", parts...);
  }

  /// `file:line: parts` for the position `at`.
  template <class... Parts>
  std::string note_at(std::size_t at, const Parts&... parts) const {
    return concat(file_, ":", line_of(at), ": ", parts...);
  }

  /// The number of the line that holds the position `at`.
  std::size_t line_of(std::size_t at) const {
    std::size_t line = 1;
    for (std::size_t i = 0; i < std::min(at, text_.size()); ++i)
      line += text_[i] == '\n' || (text_[i] == '\r' && (i + 1 == text_.size() || text_[i + 1] != '\n'));
    return line;
  }

  /// Removes NUL bytes and control-Z, which some programs pad files with, from the end of the text. Returns a
  /// note, empty if there were none.
  std::string drop_padding() {
    std::size_t stop = text_.size(), found = 0, first = 0;
    for (; stop > 0; --stop) {
      const char c = text_[stop - 1];
      if (c == '\0' || c == '\x1A')
        ++found, first = stop - 1;
      else if (!is_blank(c) && !is_line_end(c))
        break;
    }
    if (found == 0 || stop == 0) return {};
    std::string note = note_at(first, "the file ends in ", found,
                               found == 1 ? " NUL or control-Z byte, which is ignored"
                                          : " NUL or control-Z bytes, which are ignored");
    text_ = text_.substr(0, first);
    return note;
  }

  /// A piece of the file as shown in messages: quoted, shortened, without control characters.
  static std::string quoted(std::string_view piece) {
    if (piece.empty()) return "the end of the file";
    std::string out = "'";
    for (const char c : piece.substr(0, 40)) out += std::iscntrl(static_cast<unsigned char>(c)) ? '?' : c;
    return out + (piece.size() > 40 ? "...'" : "'");
  }

  void skip_space() {
    while (at_ < text_.size() && (is_blank(text_[at_]) || is_line_end(text_[at_]))) ++at_;
  }
  void skip_blanks() {
    while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
  }
  bool at_line_end() {
    skip_blanks();
    return at_ >= text_.size() || is_line_end(text_[at_]);
  }
  bool at_end() const { return at_ >= text_.size(); }
  std::size_t place() const { return at_; }
  std::size_t left() const { return text_.size() - at_; }

  /// The next word, without consuming it; each brace is a word of its own. Empty at the end.
  std::string_view peek() {
    skip_space();
    return peek_here();
  }
  std::string_view next() {
    const std::string_view word = peek();
    at_ += word.size();
    return word;
  }

  void expect(std::string_view word, std::string_view where) {
    const std::string_view found = peek();
    if (!same_word(found, word)) fail_at(at_, "found ", quoted(found), ", expected ", word, where);
    at_ += found.size();
  }

  /// `Frames:` and similar labels, with or without space before the colon.
  void expect_label(std::string_view label) {
    skip_space();
    const std::size_t start = at_;
    std::size_t p = at_;
    for (const char c : label) {
      while (c == ':' && p < text_.size() && is_blank(text_[p])) ++p;
      const bool gap = c == ' ';
      if (p >= text_.size() || !(gap ? is_blank(text_[p]) : same_word(text_.substr(p, 1), {&c, 1})))
        fail_at(start, "found ", quoted(peek_here()), ", expected '", label, "'");
      ++p;
      while (gap && p < text_.size() && is_blank(text_[p])) ++p;
    }
    at_ = p;
  }

  /// A joint's name: the rest of the line, up to an opening brace. It may contain spaces.
  std::string_view rest_of_name() {
    skip_blanks();
    std::size_t stop = line_stop();
    for (std::size_t p = at_; p < stop; ++p) {
      if (text_[p] != '{') continue;
      const bool after_blank = p == at_ || is_blank(text_[p - 1]);
      const bool last = std::all_of(text_.begin() + static_cast<std::ptrdiff_t>(p) + 1,
                                    text_.begin() + static_cast<std::ptrdiff_t>(stop), is_blank);
      if (after_blank || last) stop = p;
    }
    // A name does not end with a brace: `a{ {` opens twice, which is an error of the next word.
    std::string_view name = text_.substr(at_, stop - at_);
    while (!name.empty() && (is_blank(name.back()) || name.back() == '{')) name.remove_suffix(1);
    at_ += name.size();
    return name;
  }

  /// Skips the name of an End Site, which means nothing: all up to a brace or the end of the line.
  void skip_end_site_name() { at_ = std::min(text_.find('{', at_), line_stop()); }

  /// Where the last line with text starts if it cannot be a whole frame of `width` values because the file
  /// was cut off there: it holds numbers only, but too few, or the last one is incomplete. Otherwise npos.
  /// Looks only at lines that start at or after the current place.
  std::size_t incomplete_last_line(std::size_t width) const {
    std::size_t stop = text_.size();
    while (stop > at_ && (is_blank(text_[stop - 1]) || is_line_end(text_[stop - 1]))) --stop;
    std::size_t start = stop;
    while (start > at_ && !is_line_end(text_[start - 1])) --start;
    while (start < stop && is_blank(text_[start])) ++start;
    Cursor line(text_.substr(0, stop), {});
    line.at_ = start;
    std::size_t values = 0;
    for (std::string_view word = line.next(); !word.empty(); word = line.next()) {
      constexpr std::string_view digits = "+-.0123456789";
      const bool numeric =
          digits.find(word.front()) != digits.npos && word.find_first_not_of("+-.0123456789eE") == word.npos;
      if (!numeric || ++values > width) return text_.npos;
      if (values < width || line.left() > 0) continue;
      return stop == text_.size() && !is_number(word) ? start : text_.npos;
    }
    return values > 0 && values < width ? start : text_.npos;
  }

  /// Whether the next word starts as a number does.
  bool at_number() const {
    return at_ < text_.size() && std::string_view("+-.0123456789").find(text_[at_]) != std::string_view::npos;
  }

  /// A finite number.
  double number(std::string_view what) {
    skip_space();
    return number_here(what);
  }
  double number_here(std::string_view what) {
    const char* const end = text_.data() + text_.size();
    const char* start = text_.data() + at_;
    if (start != end && *start == '+' && start + 1 != end && start[1] != '-') ++start;
    double value = 0;
    const auto ends_word = [end](const char* c) {
      return c == end || is_blank(*c) || is_line_end(*c) || *c == '{' || *c == '}';
    };
    if (const char* stop = read_short_decimal(start, end, value); stop != nullptr && ends_word(stop)) {
      at_ = static_cast<std::size_t>(stop - text_.data());
      return value;
    }
    const auto [stop, error] = io::read_number(start, end, value);
    const bool whole = ends_word(stop);
    if (error == std::errc() && whole && std::isfinite(value)) {
      at_ = static_cast<std::size_t>(stop - text_.data());
      return value;
    }
    const std::string_view word = peek_here();
    if (error == std::errc::result_out_of_range && whole) {
      // Underflow reads as zero; overflow is an error.
      const bool tiny = word.find("e-") != word.npos || word.find("E-") != word.npos ||
                        word.find_first_not_of("+-0.") > word.find('.');
      if (tiny) {
        at_ += word.size();
        return 0;
      }
      fail_at(at_, "found ", quoted(word), ", which is too large, expected ", what);
    }
    fail_at(at_, "found ", word.empty() && !at_end() ? "the end of the line" : quoted(word), ", expected ",
            what, " (a finite number with a decimal point)");
  }

  /// A whole number of at least 0.
  std::size_t count(std::string_view what) {
    const std::string_view word = peek();
    unsigned long long value = 0;
    const char* const end = word.data() + word.size();
    const auto [stop, error] = std::from_chars(word.data(), end, value);
    if (word.empty() || error != std::errc() || stop != end)
      fail_at(at_, "found ", quoted(word), ", expected ", what, " (a whole number, 0 or more)");
    at_ += word.size();
    return static_cast<std::size_t>(value);
  }

 private:
  std::size_t line_stop() const { return std::min(text_.find_first_of("\r\n", at_), text_.size()); }

  /// Whether a number can be read from the whole word, if only as too large or too small.
  static bool is_number(std::string_view word) {
    if (word.starts_with('+')) word.remove_prefix(1);
    double value = 0;
    const auto [stop, error] = io::read_number(word.data(), word.data() + word.size(), value);
    return error != std::errc::invalid_argument && stop == word.data() + word.size();
  }

  std::string_view peek_here() const {
    std::size_t stop = at_;
    while (stop < text_.size() && !is_blank(text_[stop]) && !is_line_end(text_[stop])) {
      const bool brace = text_[stop] == '{' || text_[stop] == '}';
      if (brace && stop > at_) break;
      ++stop;
      if (brace) break;
    }
    return text_.substr(at_, stop - at_);
  }

  std::string_view text_;
  std::string file_;
  std::size_t at_ = 0;
};

}  // namespace bvh_detail

}  // namespace motiongan::motion

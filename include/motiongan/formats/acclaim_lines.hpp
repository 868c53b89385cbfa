// The lines of Acclaim's text files (ASF and AMC) as words, and errors with their line.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/io/read_number.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion::acclaim_detail {

inline std::string lower_case(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

/// Reads line by line. Commas and parentheses separate words like blanks do; `#` starts a comment. Lines end
/// in LF, CR LF or CR.
class Lines {
 public:
  Lines(std::string_view text, std::string_view file) : text_(text), file_(file) {
    if (text_.starts_with("\xEF\xBB\xBF")) text_.remove_prefix(3);  // a UTF-8 byte order mark
  }

  /// Moves on to the next line that has words; false at the end of the text.
  bool next() {
    while (at_ < text_.size()) {
      const std::size_t stop = std::min(text_.find_first_of("\r\n", at_), text_.size());
      split(text_.substr(at_, stop - at_));
      at_ = stop + (text_.substr(stop, 2) == "\r\n" ? 2 : 1);
      ++number_;
      if (!words_.empty()) return true;
    }
    words_.clear();
    return false;
  }

  const std::vector<std::string_view>& words() const { return words_; }  ///< of the current line
  std::size_t number() const { return number_; }                         ///< of the current line, from 1
  const std::string& file() const { return file_; }

  /// Throws Error as `file:line: parts`, for the current line or the line `number`.
  template <class... Parts>
  [[noreturn]] void fail(const Parts&... parts) const {
    fail_at(number_, parts...);
  }
  template <class... Parts>
  [[noreturn]] void fail_at(std::size_t number, const Parts&... parts) const {
    throw Error(file_, ":", number, ": ", parts...);
  }

  /// Word `i` as a number; `what` is what messages call it.
  double real(std::size_t i, std::string_view what) const {
    if (i >= words_.size()) fail("'", words_.front(), "' ends before ", what, ", expected a number");
    double value = 0;
    if (!parse(words_[i], value))
      fail("found ", quoted(words_[i]), ", expected ", what, " (a finite number)");
    return value;
  }

  /// Words `first` to `first` + 2 as numbers.
  Vec3 vector(std::size_t first, std::string_view what) const {
    return {real(first, what), real(first + 1, what), real(first + 2, what)};
  }

  /// Whether the word is a finite number, which goes to `value`. Numbers too small for a double are zero.
  static bool parse(std::string_view word, double& value) {
    if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
    const char* const end = word.data() + word.size();
    const auto [stop, problem] = io::read_number(word.data(), end, value);
    if (stop != end) return false;
    const bool tiny = word.find("e-") != word.npos || word.find("E-") != word.npos;
    if (problem == std::errc::result_out_of_range && tiny) value = 0;
    return (problem == std::errc() || tiny) && !word.empty() && std::isfinite(value);
  }

  /// A word as shown in messages: quoted, shortened, without control characters.
  static std::string quoted(std::string_view word) {
    std::string out = "'";
    for (const char c : word.substr(0, 40)) out += static_cast<unsigned char>(c) < 32 || c == 127 ? '?' : c;
    return out + (word.size() > 40 ? "...'" : "'");
  }

 private:
  void split(std::string_view line) {
    constexpr std::string_view blank = " \t\v\f,()";
    words_.clear();
    line = line.substr(0, line.find('#'));
    for (std::size_t at = line.find_first_not_of(blank); at < line.size();) {
      const std::size_t stop = std::min(line.find_first_of(blank, at), line.size());
      words_.push_back(line.substr(at, stop - at));
      at = line.find_first_not_of(blank, stop);
    }
  }

  std::string_view text_;
  std::string file_;
  std::vector<std::string_view> words_;
  std::size_t at_ = 0, number_ = 0;
};

/// The channels named by all words of the line after the first. `owner` is what messages call their joint.
inline std::vector<Channel> channels_of(const Lines& in, std::string_view owner) {
  constexpr std::array<std::string_view, 6> names{"tx", "ty", "tz", "rx", "ry", "rz"};
  std::vector<Channel> out;
  for (std::size_t i = 1; i < in.words().size(); ++i) {
    const std::string word = lower_case(in.words()[i]);
    if (word == "l")
      in.fail(owner, " can change its length ('l'), which is not supported: expected rx, ry and rz only");
    const auto at = static_cast<std::size_t>(std::find(names.begin(), names.end(), word) - names.begin());
    if (at == names.size()) in.fail("found ", Lines::quoted(word), ", expected tx, ty, tz, rx, ry or rz");
    if (std::find(out.begin(), out.end(), static_cast<Channel>(at)) != out.end())
      in.fail("found '", word, "' twice, expected it once");
    out.push_back(static_cast<Channel>(at));
  }
  return out;
}

/// Word `i` of the line, such as XYZ, as three axes.
inline std::array<std::size_t, 3> axis_order(const Lines& in, std::size_t i) {
  const std::string word = i < in.words().size() ? lower_case(in.words()[i]) : "";
  std::string sorted = word;
  std::sort(sorted.begin(), sorted.end());
  if (sorted != "xyz")
    in.fail("found ", Lines::quoted(word), " as the order of rotations, expected one such as XYZ");
  std::array<std::size_t, 3> out{};
  for (std::size_t k = 0; k < 3; ++k) out[k] = static_cast<std::size_t>(word[k] - 'x');
  return out;
}

}  // namespace motiongan::motion::acclaim_detail

// Progress display of a training run: a bar on a terminal, plain lines at intervals elsewhere.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "motiongan/core/clock.hpp"
#include "motiongan/core/os.hpp"
#include "motiongan/train/csv_log.hpp"

namespace motiongan {

/// A number shown next to the progress, with its name.
using NamedValue = std::pair<std::string_view, double>;

/// Options of ProgressBar.
struct ProgressOptions {
  std::string label = "iteration";        ///< what is counted
  std::FILE* out = stderr;                ///< where the bar is drawn
  double terminal_interval = 0.1;         ///< seconds between redraws on a terminal
  double plain_interval = 10;             ///< seconds between lines elsewhere
  std::optional<bool> terminal = {};      ///< whether `out` is a terminal; not set: asked of the system
  std::optional<std::size_t> width = {};  ///< columns of the terminal; not set: queried
  double smoothing = 20;                  ///< seconds over which the rate is averaged
  std::function<double()> now = {};       ///< clock in seconds; empty: clock_seconds()
};

namespace detail {

/// "01:42:10", "2d 01:42:10", or "--:--:--" if the time is not known.
inline std::string clock_text(double seconds) {
  if (!(seconds >= 0) || seconds > 1e8) return "--:--:--";
  const auto total = static_cast<unsigned long>(std::lround(seconds));
  char text[48];
  if (total >= 86400)
    std::snprintf(text, sizeof text, "%lud %02lu:%02lu:%02lu", total / 86400, total / 3600 % 24,
                  total / 60 % 60, total % 60);
  else
    std::snprintf(text, sizeof text, "%02lu:%02lu:%02lu", total / 3600, total / 60 % 60, total % 60);
  return text;
}

/// "3.2 it/s", or "4.1 s/it" if an iteration takes longer than a second.
inline std::string rate_text(double per_second) {
  if (!(per_second > 0)) return "- it/s";
  char text[32];
  const bool slow = per_second < 1;
  std::snprintf(text, sizeof text, "%.3g %s", slow ? 1 / per_second : per_second, slow ? "s/it" : "it/s");
  return text;
}

/// One line of at most `width` characters. To fit, the bar is shortened, then dropped, then values are
/// dropped from the end, and finally the text is truncated.
inline std::string progress_line(std::string_view label, std::size_t done, std::size_t total, double rate,
                                 std::span<const NamedValue> values, std::size_t width) {
  std::string head(label);
  head += " " + std::to_string(done);
  if (total > 0) head += "/" + std::to_string(total);
  std::string tail = rate_text(rate);
  if (total > 0)
    tail += "  ETA " + clock_text(rate > 0 ? static_cast<double>(total - std::min(done, total)) / rate : -1);
  std::vector<std::string> shown;
  std::size_t extra = 0;
  for (const auto& [name, value] : values) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", value);
    shown.push_back("  " + std::string(name) + " " + text);
    extra += shown.back().size();
  }
  const std::size_t fixed = head.size() + 2 + tail.size();
  while (!shown.empty() && fixed + extra > width) {
    extra -= shown.back().size();
    shown.pop_back();
  }
  std::string bar;
  if (total > 0 && fixed + extra + 13 <= width) {
    const std::size_t room = std::min<std::size_t>(30, width - fixed - extra - 3);
    const double part = std::min(1.0, static_cast<double>(done) / static_cast<double>(total));
    const auto filled = static_cast<std::size_t>(part * static_cast<double>(room));
    bar = std::string(filled, '=');
    if (filled < room) bar += '>';
    bar.resize(room, ' ');
    bar = " [" + bar + "]";
  }
  std::string line = head + bar + "  " + tail;
  for (const std::string& text : shown) line += text;
  return line.substr(0, width);
}

}  // namespace detail

/// Shows progress: on a terminal one line that is redrawn in place, otherwise a new line at intervals.
class ProgressBar {
 public:
  explicit ProgressBar(std::size_t total = 0, ProgressOptions options = {})
      : options_(std::move(options)), total_(total) {
    terminal_ = options_.terminal.value_or(os::is_terminal(options_.out));
  }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  ~ProgressBar() { end_line(); }

  /// Sets the number of steps in all and of those done before, in an earlier run; the rate ignores the
  /// latter.
  void start(std::size_t total, std::size_t done = 0) {
    total_ = total;
    done_ = done;
    counted_ = elapsed_ = 0;
    last_time_ = now();
    last_drawn_.reset();
  }

  /// Reports that `done` steps are done; redraws if the interval has passed. Cheap enough to call every step.
  void update(std::size_t done, std::span<const NamedValue> values = {}) {
    const double time = now();
    if (!last_time_) {
      // First report without start(): the time of these steps is not known.
      done_ = done;
    } else if (time > *last_time_ || done > done_) {
      const double passed = time - *last_time_, fade = std::exp(-passed / options_.smoothing);
      counted_ = counted_ * fade + static_cast<double>(done > done_ ? done - done_ : 0);
      elapsed_ = elapsed_ * fade + passed;
      done_ = done;
    }
    last_time_ = time;
    values_.clear();
    for (const auto& [name, value] : values) values_.emplace_back(std::string(name), value);
    const double interval = terminal_ ? options_.terminal_interval : options_.plain_interval;
    if (!last_drawn_ || time - *last_drawn_ >= interval) draw(time);
  }
  void update(std::size_t done, std::initializer_list<NamedValue> values) {
    update(done, std::span<const NamedValue>(values.begin(), values.size()));
  }

  /// Prints a separate line without disturbing the bar.
  void note(std::string_view text) {
    clear();
    std::fprintf(options_.out, "%.*s\n", static_cast<int>(text.size()), text.data());
    if (open_) draw(now());
    std::fflush(options_.out);
  }

  /// Draws the final state and ends the line. Call it once; without it the destructor only ends the line.
  void finish() {
    if (last_time_ && (!drawn_ || *drawn_ != done_ || terminal_)) draw(now());
    end_line();
    last_time_.reset();
  }

  /// Steps per second, a moving average; 0 if not known yet.
  double rate() const { return elapsed_ > 0 ? counted_ / elapsed_ : 0; }

 private:
  double now() const { return options_.now ? options_.now() : clock_seconds(); }

  /// Queried at every redraw, because the window may be resized.
  std::size_t width() const {
    if (options_.width) return *options_.width;
    const std::size_t columns = os::terminal_width(options_.out);
    return columns > 0 ? columns : 80;
  }

  void clear() {
    if (terminal_ && open_) std::fputs("\r\x1b[K", options_.out);
  }

  void draw(double time) {
    std::vector<NamedValue> values;
    for (const auto& [name, value] : values_) values.emplace_back(name, value);
    clear();
    // Some terminals wrap after the last column, so it stays free. A file has no width.
    const std::size_t room = terminal_ ? std::max<std::size_t>(width(), 2) - 1 : 1000;
    std::string line = detail::progress_line(options_.label, done_, total_, rate(), values, room);
    if (!terminal_) line += "\n";
    std::fputs(line.c_str(), options_.out);
    std::fflush(options_.out);
    open_ = terminal_;
    last_drawn_ = time;
    drawn_ = done_;
  }

  void end_line() {
    if (open_) std::fputs("\n", options_.out);
    if (open_) std::fflush(options_.out);
    open_ = false;
  }

  ProgressOptions options_;
  std::size_t total_ = 0, done_ = 0;
  bool terminal_ = false, open_ = false;
  double counted_ = 0,
         elapsed_ = 0;  // steps and seconds, exponentially decayed: their ratio is a moving average
  std::optional<double> last_time_, last_drawn_;
  std::optional<std::size_t> drawn_;
  std::vector<std::pair<std::string, double>> values_;
};

}  // namespace motiongan

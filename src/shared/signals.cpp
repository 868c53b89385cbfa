#include "shared/signals.hpp"

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <iterator>

#include "motiongan/core/error.hpp"
#include "motiongan/core/os.hpp"

namespace motiongan::command {
namespace {

constexpr int stop_signals[]{SIGINT, SIGTERM, SIGHUP};

std::atomic<int> signal_number = 0;
volatile std::sig_atomic_t takes_signal[std::size(stop_signals)];

extern "C" void take_signal(int number) {
  int none = 0;
  if (signal_number.compare_exchange_strong(none, number)) {
    for (std::size_t i = 0; i < std::size(stop_signals); ++i)
      if (takes_signal[i]) std::signal(stop_signals[i], SIG_DFL);
    std::signal(SIGPIPE, SIG_IGN);
  } else if (number != SIGPIPE) {  // what is printed while the run is saved must not prevent that
    // The second signal of any kind ends the process at once. Two may come at the same time, in two threads.
    os::end_by_signal(number);
  }
}

/// The stop signals that were ignored when the program started. Asked before main(): the compiler of an
/// OpenCL driver sets handlers of its own.
const std::array<bool, std::size(stop_signals)> ignored_at_start = [] {
  std::array<bool, std::size(stop_signals)> out{};
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = os::is_signal_ignored(stop_signals[i]);
  return out;
}();
const bool pipe_ignored_at_start = os::is_signal_ignored(SIGPIPE);

/// In the same thread a second signal waits until the handler of the first has ended.
bool take(int number) { return os::set_signal_handler(number, take_signal, stop_signals); }

}  // namespace

void catch_signals() {
  if (signal_number != 0) return;
  for (std::size_t i = 0; i < std::size(stop_signals); ++i)
    takes_signal[i] = !ignored_at_start[i] && take(stop_signals[i]);
  if (!pipe_ignored_at_start) take(SIGPIPE);
}

bool stop_requested() {
  // The compiler of an OpenCL driver may have set its handlers since: kernels are built when first used.
  for (std::size_t i = 0; i < std::size(stop_signals) && signal_number == 0; ++i)
    if (takes_signal[i]) {
      if (!os::is_signal_handler(stop_signals[i], take_signal)) catch_signals();
      break;
    }
  return signal_number != 0;
}

int caught_signal() { return signal_number; }

void flush_output() {
  std::cout.flush();
  errno = 0;
  if (std::fflush(stdout) == 0 && !std::ferror(stdout) && std::cout.good()) return;
  throw Error("cannot write to standard output", errno != 0 ? ": " : "",
              errno != 0 ? std::strerror(errno) : "");
}

}  // namespace motiongan::command

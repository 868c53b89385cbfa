// Ctrl-C and SIGTERM as requests to stop at the next safe point.
#include "shared/signals.hpp"

#include <csignal>

namespace motiongan::command {
namespace {

volatile std::sig_atomic_t signal_number = 0;

extern "C" void take_signal(int number) {
  signal_number = number;
  std::signal(number, SIG_DFL);  // the second one ends the process at once
}

}  // namespace

void catch_signals() {
  std::signal(SIGINT, take_signal);
  std::signal(SIGTERM, take_signal);
}

int caught_signal() { return signal_number; }

}  // namespace motiongan::command

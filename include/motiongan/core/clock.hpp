// The monotonic clock as a number: <chrono> costs every translation unit a quarter of a second.
#pragma once
#include <ctime>

namespace motiongan {

/// Seconds since an arbitrary start; only differences mean anything.
inline double clock_seconds() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace motiongan

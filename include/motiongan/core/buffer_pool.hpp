// A pool that caches freed device buffers, so that a steady-state training step allocates nothing.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <string>

#include "motiongan/core/opencl.hpp"

namespace motiongan {

/// Statistics of a Context: counters since it was made, and current byte counts.
struct ContextStatistics {
  std::size_t allocations = 0;   ///< buffers allocated by the driver
  std::size_t reads = 0;         ///< copies from device to host (each waits for the queue)
  std::size_t writes = 0;        ///< copies from host to device
  std::size_t launches = 0;      ///< kernels enqueued
  double gemm_flops = 0;         ///< floating-point operations in matrix products
  std::size_t bytes_in_use = 0;  ///< in live tensors
  std::size_t bytes_cached = 0;  ///< in free buffers of the pool
  std::size_t peak_bytes = 0;    ///< maximum of bytes_in_use + bytes_cached

  std::size_t peak_in_use = 0;     ///< maximum of bytes_in_use
  std::size_t largest_buffer = 0;  ///< bytes of the largest buffer
  std::size_t bytes_written = 0;   ///< in all writes
};

namespace detail {

/// Hands out buffers by size. A returned buffer can be reused at once: the queue runs in order, so every
/// kernel that still reads it finishes before its next owner writes to it. Without an OpenCL context the
/// buffers are only counted: all are null.
class BufferPool {
 public:
  BufferPool(cl_context context, std::size_t limit, std::size_t max_allocation, ContextStatistics& statistics)
      : context_(context), limit_(limit), max_allocation_(max_allocation), statistics_(statistics) {}

  /// A buffer of at least `bytes`; `granted` receives its size. Throws Error if the memory limit, or the
  /// largest allocation of the device, would be exceeded.
  ClBuffer take(std::size_t bytes, std::size_t& granted) {
    granted = round_up(bytes);
    // A slightly larger buffer will do; a much larger one would waste memory.
    if (const auto found = free_.lower_bound(granted);
        found != free_.end() && found->first <= granted + granted / 4) {
      granted = found->first;
      ClBuffer buffer = std::move(found->second);
      free_.erase(found);
      statistics_.bytes_cached -= granted;
      use(granted);
      return buffer;
    }
    if (granted > max_allocation_)
      throw Error("out of device memory: one buffer of ", mega(bytes), " requested, the device allows ",
                  mega(max_allocation_), " in one allocation; use a smaller batch or fewer frames");
    if (statistics_.bytes_in_use + statistics_.bytes_cached + granted > limit_) trim();
    if (statistics_.bytes_in_use + granted > limit_)
      throw Error("out of device memory: ", mega(bytes), " requested, ", mega(statistics_.bytes_in_use),
                  " already in use, limit ", mega(limit_),
                  "; use a smaller batch, or raise ContextOptions::memory_limit or MOTIONGAN_MEMORY_MB");
    if (context_ == nullptr) {
      ++statistics_.allocations;
      use(granted);
      return {};
    }
    cl_int code = CL_SUCCESS;
    cl_mem memory = clCreateBuffer(context_, CL_MEM_READ_WRITE, granted, nullptr, &code);
    if (code != CL_SUCCESS) {  // the pool may be caching memory that the driver needs
      trim();
      memory = clCreateBuffer(context_, CL_MEM_READ_WRITE, granted, nullptr, &code);
    }
    check_cl(code, "clCreateBuffer", ": ", mega(bytes), " requested, ", mega(statistics_.bytes_in_use),
             " already in use, limit ", mega(limit_));
    ++statistics_.allocations;
    use(granted);
    return ClBuffer(memory);
  }

  void give_back(ClBuffer buffer, std::size_t granted) {
    statistics_.bytes_in_use -= granted;
    statistics_.bytes_cached += granted;
    free_.emplace(granted, std::move(buffer));
  }

  std::size_t limit() const { return limit_; }

  /// Releases all free buffers to the driver.
  void trim() {
    free_.clear();
    statistics_.bytes_cached = 0;
  }

 private:
  static std::size_t round_up(std::size_t bytes) {
    const std::size_t step = bytes < 65536 ? 256 : 4096;
    return (std::max<std::size_t>(bytes, 1) + step - 1) / step * step;
  }
  static std::string mega(std::size_t bytes) {
    return concat(std::round(static_cast<double>(bytes) / 1e3) / 1e3, " MB");
  }

  void use(std::size_t granted) {
    statistics_.bytes_in_use += granted;
    statistics_.peak_in_use = std::max(statistics_.peak_in_use, statistics_.bytes_in_use);
    statistics_.peak_bytes =
        std::max(statistics_.peak_bytes, statistics_.bytes_in_use + statistics_.bytes_cached);
    statistics_.largest_buffer = std::max(statistics_.largest_buffer, granted);
  }

  cl_context context_;
  std::size_t limit_, max_allocation_;
  ContextStatistics& statistics_;
  std::multimap<std::size_t, ClBuffer> free_;
};

}  // namespace detail
}  // namespace motiongan

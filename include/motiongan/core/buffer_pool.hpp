// A pool that caches freed device buffers, so that a steady-state training step allocates nothing.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <new>
#include <string>

#include "motiongan/core/driver.hpp"

namespace motiongan {

/// Statistics of a Context: counters since it was made, and current byte counts.
struct ContextStatistics {
  std::size_t allocations = 0;  ///< buffers allocated by the driver
  std::size_t reads = 0;        ///< copies from device to host (each waits for the queue)
  std::size_t writes = 0;       ///< copies from host to device
  std::size_t launches = 0;     ///< kernels enqueued
  double gemm_flops = 0;        ///< floating-point operations in matrix products
  /// Bytes of the operands of matrix products and of the arguments of all other kernels, each counted once:
  /// an estimate of what a device without caches moves. Too high where a kernel touches part of an argument
  /// that does not say which (At::count), too low where it reads and writes one.
  double bytes_touched = 0;
  std::size_t bytes_in_use = 0;  ///< in live tensors
  std::size_t bytes_cached = 0;  ///< in free buffers of the pool
  std::size_t peak_bytes = 0;    ///< maximum of bytes_in_use + bytes_cached
  std::size_t bytes_staged = 0;  ///< of host memory, held for uploads

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
  BufferPool(cl_context context, std::size_t limit, std::size_t max_allocation, ContextStatistics& statistics,
             Driver& driver)
      : context_(context),
        limit_(limit),
        max_allocation_(max_allocation),
        statistics_(statistics),
        driver_(driver) {}

  /// For tests: the n-th request to the driver from now on fails; 0: none does.
  void fail_allocation(std::size_t n) { fail_in_ = n; }

  /// A buffer of at least `bytes`; `granted` receives its size. Throws DeviceError if the memory limit, or
  /// the largest allocation of the device, would be exceeded, or the driver has no memory.
  ClBuffer take(std::size_t bytes, std::size_t& granted) {
    if (bytes > max_allocation_) refuse(bytes);
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
    if (granted > max_allocation_) refuse(bytes);
    if (statistics_.bytes_in_use + statistics_.bytes_cached + granted > limit_) trim();
    if (statistics_.bytes_in_use + granted > limit_)
      throw DeviceError(
          "out of device memory: ", mega(bytes), " requested, ", mega(statistics_.bytes_in_use),
          " already in use, limit ", mega(limit_),
          "; use a smaller batch, or raise ContextOptions::memory_limit or MOTIONGAN_MEMORY_MB");
    ClBuffer buffer = context_ == nullptr ? ClBuffer() : allocate(granted, bytes);
    ++statistics_.allocations;
    use(granted);
    return buffer;
  }

  /// Keeps a buffer for the next take(); releases it to the driver if there is no memory to note it.
  void give_back(ClBuffer buffer, std::size_t granted) noexcept {
    statistics_.bytes_in_use -= granted;
    try {
      // Before its equals: the buffer used last, which the caches may still hold, is taken first.
      free_.emplace_hint(free_.lower_bound(granted), granted, std::move(buffer));
      statistics_.bytes_cached += granted;
    } catch (const std::bad_alloc&) {
    }
  }

  std::size_t limit() const { return limit_; }

  /// Releases all free buffers to the driver.
  void trim() {
    free_.clear();
    statistics_.bytes_cached = 0;
  }

 private:
  [[noreturn]] void refuse(std::size_t bytes) const {
    throw DeviceError("out of device memory: one buffer of ", mega(bytes), " requested, the device allows ",
                      mega(max_allocation_), " in one allocation; use a smaller batch or fewer frames");
  }
  ClBuffer allocate(std::size_t granted, std::size_t wanted) {
    const bool fails = fail_in_ > 0 && --fail_in_ == 0;
    cl_int code = CL_MEM_OBJECT_ALLOCATION_FAILURE;
    cl_mem memory = nullptr;
    for (int attempt = 0; attempt < 2 && code != CL_SUCCESS; ++attempt) {
      if (attempt > 0) trim();  // the pool may be caching memory that the driver needs
      if (!fails) memory = clCreateBuffer(context_, CL_MEM_READ_WRITE, granted, nullptr, &code);
    }
    if (code != CL_SUCCESS)
      driver_.fail(code, "clCreateBuffer",
                   concat(": ", mega(wanted), " requested, ", mega(statistics_.bytes_in_use),
                          " already in use, limit ", mega(limit_), fails ? " (as a test wants it)" : ""));
    return ClBuffer(memory);
  }

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
  Driver& driver_;
  std::size_t fail_in_ = 0;
  std::multimap<std::size_t, ClBuffer> free_;
};

}  // namespace detail
}  // namespace motiongan

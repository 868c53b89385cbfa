// Device buffers that are kept when they are given back, so that a training step in steady state allocates
// nothing.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <string>

#include "motiongan/core/opencl.hpp"

namespace motiongan {

/// What a Context has done so far; the counters only grow, the byte counts are of this moment.
struct ContextStatistics {
  std::size_t allocations = 0;   ///< buffers asked of the driver
  std::size_t reads = 0;         ///< read-backs from device to host (each waits for the queue)
  std::size_t writes = 0;        ///< uploads from host to device
  std::size_t launches = 0;      ///< kernels enqueued
  double gemm_flops = 0;         ///< multiplications and additions in matrix products
  std::size_t bytes_in_use = 0;  ///< in live tensors
  std::size_t bytes_cached = 0;  ///< in buffers that wait to be used again
  std::size_t peak_bytes = 0;    ///< most that was ever in use and cached together
};

namespace detail {

/// Hands out buffers by size. A returned buffer may be handed out at once: the queue runs in order, so
/// whatever still reads it has run before its next owner writes it.
class BufferPool {
 public:
  BufferPool(cl_context context, std::size_t limit, std::size_t max_allocation, ContextStatistics& statistics)
      : context_(context), limit_(limit), max_allocation_(max_allocation), statistics_(statistics) {}

  /// A buffer of at least `bytes`; `granted` is set to its size.
  ClBuffer take(std::size_t bytes, std::size_t& granted) {
    granted = round_up(bytes);
    // A slightly larger buffer serves too; a much larger one would waste what somebody else needs.
    if (const auto found = free_.lower_bound(granted);
        found != free_.end() && found->first <= granted + granted / 4) {
      granted = found->first;
      ClBuffer buffer = std::move(found->second);
      free_.erase(found);
      statistics_.bytes_cached -= granted;
      statistics_.bytes_in_use += granted;
      return buffer;
    }
    if (granted > max_allocation_)
      throw Error("out of device memory: one buffer of ", mega(bytes), " was asked, the device allows ",
                  mega(max_allocation_), " in one allocation; use a smaller batch or fewer frames");
    if (statistics_.bytes_in_use + statistics_.bytes_cached + granted > limit_) trim();
    if (statistics_.bytes_in_use + granted > limit_)
      throw Error("out of device memory: ", mega(bytes), " was asked, ", mega(statistics_.bytes_in_use),
                  " are in use of a limit of ", mega(limit_),
                  "; use a smaller batch, or raise ContextOptions::memory_limit or MOTIONGAN_MEMORY_MB");
    cl_int code = CL_SUCCESS;
    cl_mem memory = clCreateBuffer(context_, CL_MEM_READ_WRITE, granted, nullptr, &code);
    if (code != CL_SUCCESS) {  // the driver may be short of memory that the pool holds
      trim();
      memory = clCreateBuffer(context_, CL_MEM_READ_WRITE, granted, nullptr, &code);
    }
    check_cl(code, "clCreateBuffer", ": ", mega(bytes), " was asked, ", mega(statistics_.bytes_in_use),
             " are in use of a limit of ", mega(limit_));
    ++statistics_.allocations;
    statistics_.bytes_in_use += granted;
    statistics_.peak_bytes =
        std::max(statistics_.peak_bytes, statistics_.bytes_in_use + statistics_.bytes_cached);
    return ClBuffer(memory);
  }

  void give_back(ClBuffer buffer, std::size_t granted) {
    statistics_.bytes_in_use -= granted;
    statistics_.bytes_cached += granted;
    free_.emplace(granted, std::move(buffer));
  }

  /// Releases every buffer that is not in use.
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

  cl_context context_;
  std::size_t limit_, max_allocation_;
  ContextStatistics& statistics_;
  std::multimap<std::size_t, ClBuffer> free_;
};

}  // namespace detail
}  // namespace motiongan

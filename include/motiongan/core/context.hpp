// Context: one OpenCL device with its command queue, kernel programs and buffer pool.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "motiongan/core/buffer_pool.hpp"
#include "motiongan/core/program.hpp"

namespace motiongan {

struct ContextOptions {
  std::string device = {};  ///< see choose_device; empty: MOTIONGAN_DEVICE
  Precision precision = Precision::f32;
  std::size_t memory_limit = 0;  ///< bytes; 0: MOTIONGAN_MEMORY_MB, else the device's global memory
  bool verbose = false;          ///< print the chosen device to standard error
};

/// A scalar kernel argument, converted to the Context's precision.
struct KernelReal {
  double value;
};

/// Global and local sizes of a launch. Local sizes are fixed per kernel: PoCL recompiles for each new one.
struct LaunchGrid {
  cl_uint dimensions;
  std::array<std::size_t, 3> global, local;

  /// At least `n` work-items in one dimension, in work-groups of 64; kernels skip those past n.
  static LaunchGrid items(std::size_t n) { return {1, {(n + 63) / 64 * 64, 1, 1}, {64, 1, 1}}; }
  /// x * y * z work-groups of one work-item, for kernels that process one tile each.
  static LaunchGrid groups(std::size_t x, std::size_t y = 1, std::size_t z = 1) {
    return {3, {x, y, z}, {1, 1, 1}};
  }
};

class Context;

namespace detail {

/// Sets the arguments of one launch, in order.
struct KernelArguments {
  cl_kernel kernel;
  Precision precision;
  const char* name;
  cl_uint index = 0;

  template <class T>
  void set(const T& value) {
    check_cl(clSetKernelArg(kernel, index, sizeof value, &value), "clSetKernelArg", ": argument ", index,
             " of kernel ", name);
    ++index;
  }
};

inline void add_argument(KernelArguments& to, KernelReal real) {
  if (to.precision == Precision::f64)
    to.set(static_cast<cl_double>(real.value));
  else
    to.set(static_cast<cl_float>(real.value));
}
inline void add_argument(KernelArguments& to, std::size_t value) {
  require(value <= std::numeric_limits<cl_uint>::max(), "kernel ", to.name, ": ", value,
          " does not fit 32 bits; use a smaller batch or fewer frames");
  to.set(static_cast<cl_uint>(value));
}
inline void add_argument(KernelArguments& to, cl_uint value) { to.set(value); }
inline void add_argument(KernelArguments& to, cl_int value) { to.set(value); }
inline void add_argument(KernelArguments& to, cl_mem value) { to.set(value); }

struct ContextState {
  Device device;
  Precision precision;
  ClContext context;
  ClQueue queue;
  ContextStatistics statistics;
  std::unique_ptr<BufferPool> pool;
  std::unique_ptr<ProgramCache> programs;

  /// Uploads do not wait for the queue: each keeps its data in one of these until the copy has finished.
  struct Staging {
    std::vector<std::byte> bytes;
    ClEvent copied;
  };
  std::array<Staging, 64> staging;
  std::size_t next_staging = 0;

  struct KernelTime {
    std::size_t launches = 0;
    double nanoseconds = 0;
  };
  bool profiling = false;
  std::unordered_map<std::string, KernelTime> kernel_times;

  ~ContextState() {
    if (queue) clFinish(queue.get());
    for (const auto& [name, time] : kernel_times)
      std::fprintf(stderr, "%10.3f ms %8zu launches  %s\n", time.nanoseconds / 1e6, time.launches,
                   name.c_str());
  }
};

/// A pool buffer shared by tensors; returns to the pool with the last of them.
class Storage {
 public:
  Storage(std::shared_ptr<ContextState> state, std::size_t bytes)
      : state_(std::move(state)), buffer_(state_->pool->take(bytes, granted_)) {}
  ~Storage() { state_->pool->give_back(std::move(buffer_), granted_); }
  Storage(const Storage&) = delete;
  Storage& operator=(const Storage&) = delete;
  cl_mem buffer() const { return buffer_.get(); }

 private:
  std::shared_ptr<ContextState> state_;
  std::size_t granted_ = 0;
  ClBuffer buffer_;
};

}  // namespace detail

/// One device with its queue, programs and buffer pool. A cheap handle: copies share one context.
/// Not thread-safe: use one Context per thread.
class Context {
 public:
  /// The device of MOTIONGAN_DEVICE (see choose_device), in single precision.
  Context() : Context(ContextOptions{}) {}

  /// Throws Error if no device matches, the device lacks the requested precision, MOTIONGAN_MEMORY_MB is
  /// invalid or an OpenCL call fails.
  explicit Context(const ContextOptions& options) : state_(std::make_shared<detail::ContextState>()) {
    auto& s = *state_;
    s.device = options.device.empty() ? default_device() : choose_device(all_devices(), options.device);
    s.precision = options.precision;
    require(s.precision == Precision::f32 || s.device.has_double, "device ", s.device.name,
            " has no double precision (cl_khr_fp64): use Precision::f32");
    cl_int code = CL_SUCCESS;
    const cl_context_properties properties[] = {
        CL_CONTEXT_PLATFORM, reinterpret_cast<cl_context_properties>(s.device.platform), 0};
    s.context = ClContext(clCreateContext(properties, 1, &s.device.id, nullptr, nullptr, &code));
    check_cl(code, "clCreateContext", ": device ", s.device.name);
    const char* profile = std::getenv("MOTIONGAN_PROFILE");
    s.profiling = profile && std::strcmp(profile, "") != 0 && std::strcmp(profile, "0") != 0;
    s.queue = ClQueue(clCreateCommandQueue(s.context.get(), s.device.id,
                                           s.profiling ? CL_QUEUE_PROFILING_ENABLE : 0, &code));
    check_cl(code, "clCreateCommandQueue", ": device ", s.device.name);
    std::size_t limit = options.memory_limit;
    if (const char* megabytes = std::getenv("MOTIONGAN_MEMORY_MB"); limit == 0 && megabytes) {
      const auto [end, error] = std::from_chars(megabytes, megabytes + std::strlen(megabytes), limit);
      require(error == std::errc() && *end == '\0' && limit > 0 &&
                  limit <= std::numeric_limits<std::size_t>::max() / 1'000'000,
              "MOTIONGAN_MEMORY_MB is \"", megabytes, "\", expected a positive whole number of megabytes");
      limit *= 1'000'000;
    }
    s.pool = std::make_unique<detail::BufferPool>(s.context.get(), limit ? limit : s.device.global_memory,
                                                  s.device.max_allocation, s.statistics);
    s.programs = std::make_unique<detail::ProgramCache>(s.context.get(), s.device, s.precision);
    if (options.verbose) std::fprintf(stderr, "device: %s\n", description().c_str());
  }

  /// A context of the same device and precision that computes nothing, to learn what work would need:
  /// statistics() counts its buffers, launches and products as in a real one, but there is no memory behind
  /// them. Kernels are not built, written data are dropped, and read data are all 0. `limited`: allocations
  /// fail where they would in a real context; else there is no limit.
  Context counting(bool limited = false) const {
    constexpr std::size_t unlimited = std::numeric_limits<std::size_t>::max() / 2;
    auto state = std::make_shared<detail::ContextState>();
    state->device = state_->device;
    state->precision = state_->precision;
    state->pool = std::make_unique<detail::BufferPool>(nullptr, limited ? memory_limit() : unlimited,
                                                       limited ? device().max_allocation : unlimited,
                                                       state->statistics);
    state->programs = std::make_unique<detail::ProgramCache>(nullptr, state->device, state->precision);
    return Context(std::move(state));
  }
  /// Whether this is a context made by counting().
  bool only_counts() const { return !state_->queue; }

  /// Bytes that all buffers together may have.
  std::size_t memory_limit() const { return state_->pool->limit(); }
  const Device& device() const { return state_->device; }
  Precision precision() const { return state_->precision; }
  /// Bytes per element: 4 or 8.
  std::size_t real_size() const { return state_->precision == Precision::f64 ? 8 : 4; }
  unsigned vector_width() const { return state_->programs->vector_width(); }
  cl_command_queue queue() const { return state_->queue.get(); }
  const ContextStatistics& statistics() const { return state_->statistics; }
  /// Adds to statistics().gemm_flops, which benchmarks compare with the device's peak.
  void count_gemm_flops(double flops) const { state_->statistics.gemm_flops += flops; }
  bool operator==(const Context& other) const { return state_ == other.state_; }

  /// "NAME (PLATFORM), 2 compute units, 6.1 GB, float"
  std::string description() const {
    const Device& d = state_->device;
    return concat(d.name, " (", d.platform_name, "), ", d.compute_units, " compute units, ",
                  std::round(static_cast<double>(d.global_memory) / 1e8) / 10, " GB, ",
                  state_->precision == Precision::f64 ? "double" : "float");
  }

  /// An uninitialised buffer from the pool. Throws Error if the memory limit would be exceeded.
  std::shared_ptr<detail::Storage> allocate(std::size_t bytes) const {
    return std::make_shared<detail::Storage>(state_, bytes);
  }

  /// Releases cached buffers to the driver.
  void trim() const { state_->pool->trim(); }

  /// Waits until all enqueued work has finished.
  void finish() const {
    if (only_counts()) return;
    check_cl(clFinish(queue()), "clFinish");
  }

  /// Enqueues kernel `name` of cl/<file>.cl. A Tensor becomes two arguments (buffer, first element), a
  /// std::size_t a cl_uint, a KernelReal a scalar of the context's precision. An empty grid launches nothing.
  /// Throws Error if the kernel does not build or an OpenCL call fails.
  template <class... Arguments>
  void launch(const char* file, const char* name, const LaunchGrid& grid,
              const Arguments&... arguments) const {
    if (only_counts())
      return void(state_->statistics.launches += grid.global[0] * grid.global[1] * grid.global[2] > 0);
    if (grid.global[0] == 0 || grid.global[1] == 0 || grid.global[2] == 0) return;
    detail::KernelArguments to{state_->programs->kernel(file, name), state_->precision, name};
    (add_argument(to, arguments), ...);
    cl_event event = nullptr;
    const cl_int code =
        clEnqueueNDRangeKernel(queue(), to.kernel, grid.dimensions, nullptr, grid.global.data(),
                               grid.local.data(), 0, nullptr, state_->profiling ? &event : nullptr);
    if (code != CL_SUCCESS)
      throw Error("clEnqueueNDRangeKernel failed with ", opencl_error_name(code), ": kernel ", name,
                  " of cl/", file, ".cl, global size ", grid.global[0], "x", grid.global[1], "x",
                  grid.global[2], ", local size ", grid.local[0], ", arguments", describe(arguments)...);
    ++state_->statistics.launches;
    if (event) record_time(name, ClEvent(event));
  }

  /// Copies `bytes` to the device without waiting for the queue; `data` may be reused on return.
  void write(cl_mem buffer, std::size_t byte_offset, const void* data, std::size_t bytes) const {
    if (bytes == 0) return;
    ++state_->statistics.writes;
    state_->statistics.bytes_written += bytes;
    if (only_counts()) return;
    auto& slot = state_->staging[state_->next_staging++ % state_->staging.size()];
    if (slot.copied) {
      const cl_event event = slot.copied.get();
      check_cl(clWaitForEvents(1, &event), "clWaitForEvents");
    }
    const auto* first = static_cast<const std::byte*>(data);
    slot.bytes.assign(first, first + bytes);
    cl_event event = nullptr;
    check_cl(clEnqueueWriteBuffer(queue(), buffer, CL_FALSE, byte_offset, bytes, slot.bytes.data(), 0,
                                  nullptr, &event),
             "clEnqueueWriteBuffer", ": ", bytes, " bytes");
    slot.copied = ClEvent(event);
  }

  /// Copies `bytes` to the host; waits for all work enqueued before.
  void read(cl_mem buffer, std::size_t byte_offset, void* data, std::size_t bytes) const {
    if (bytes == 0) return;
    ++state_->statistics.reads;
    if (only_counts()) return void(std::memset(data, 0, bytes));
    check_cl(clEnqueueReadBuffer(queue(), buffer, CL_TRUE, byte_offset, bytes, data, 0, nullptr, nullptr),
             "clEnqueueReadBuffer", ": ", bytes, " bytes");
  }

 private:
  explicit Context(std::shared_ptr<detail::ContextState> state) : state_(std::move(state)) {}

  template <class T>
  static std::string describe(const T& argument) {
    if constexpr (requires { argument.describe(); })
      return " " + argument.describe();
    else if constexpr (std::is_same_v<T, KernelReal>)
      return concat(" ", argument.value);
    else
      return concat(" ", argument);
  }

  void record_time(const char* name, const ClEvent& done) const {
    const cl_event event = done.get();
    check_cl(clWaitForEvents(1, &event), "clWaitForEvents", ": kernel ", name);
    cl_ulong start = 0, end = 0;
    clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_START, sizeof start, &start, nullptr);
    clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_END, sizeof end, &end, nullptr);
    auto& time = state_->kernel_times[name];
    ++time.launches;
    time.nanoseconds += static_cast<double>(end - start);
  }

  std::shared_ptr<detail::ContextState> state_;
};

}  // namespace motiongan

// Context: one OpenCL device with its command queue, kernel programs and buffer pool.
#pragma once
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "motiongan/core/buffer_pool.hpp"
#include "motiongan/core/kernel_arguments.hpp"
#include "motiongan/core/program.hpp"
#include "motiongan/core/staging.hpp"

namespace motiongan {

/// Options of a Context.
struct ContextOptions {
  std::string device = {};               ///< see choose_device; empty: MOTIONGAN_DEVICE
  Precision precision = Precision::f32;  ///< of all tensors and kernels
  std::size_t memory_limit = 0;          ///< bytes; 0: MOTIONGAN_MEMORY_MB, else the device's global memory
  bool verbose = false;                  ///< print the chosen device to standard error
  /// Elements of one tensor; 0 or more than most_elements: most_elements. For tests.
  std::size_t element_limit = 0;
  /// Items of a work-group; 0 or more than Context::group() would have: as many as that. For tests.
  std::size_t group_limit = 0;
};

/// The most elements of one tensor: kernels count them in 32 bits. The difference from 2^32 is for the
/// work-groups, vectors and chunks that reach past the last element.
constexpr std::size_t most_elements = (std::size_t{1} << 32) - (std::size_t{1} << 20);

namespace detail {

/// The queues of all contexts of the process; see finish_all_contexts().
class LiveQueues {
 public:
  static void add(cl_command_queue queue) {
    LiveQueues& live = instance();
    const std::lock_guard hold(live.mutex_);
    live.queues_.push_back(queue);
  }
  static void remove(cl_command_queue queue) noexcept {
    LiveQueues& live = instance();
    const std::lock_guard hold(live.mutex_);
    std::erase(live.queues_, queue);
  }
  static void finish() {
    LiveQueues& live = instance();
    const std::lock_guard hold(live.mutex_);
    for (const cl_command_queue queue : live.queues_) clFinish(queue);
  }

 private:
  /// Never destroyed: contexts that are global variables use it at the end.
  static LiveQueues& instance() {
    static LiveQueues* const live = new LiveQueues;
    return *live;
  }

  std::mutex mutex_;
  std::vector<cl_command_queue> queues_;
};

struct ContextState {
  Device device;
  KernelTarget target;
  std::size_t element_limit = most_elements;
  Driver driver;
  ClContext context;
  ClQueue queue;
  ContextStatistics statistics;
  std::unique_ptr<BufferPool> pool;
  std::unique_ptr<ProgramCache> programs;
  Staging staging;

  struct KernelTime {
    std::size_t launches = 0;
    double nanoseconds = 0;
  };
  bool profiling = false;
  std::unordered_map<std::string, KernelTime> kernel_times;

  /// See Interruptible; null without one.
  const std::function<bool()>* interrupted = nullptr;
  std::size_t unmarked_launches = 0;
  ClEvent marker;

  ~ContextState() {
    if (queue) LiveQueues::remove(queue.get());
    if (queue) clFinish(queue.get());  // a failure here has nobody to report it to
    for (const auto& [name, time] : kernel_times)
      std::fprintf(stderr, "%10.3f ms %8zu launches  %s\n", time.nanoseconds / 1e6, time.launches,
                   name.c_str());
  }
};

/// The number in an environment variable, 0 if it is unset. Throws Error unless it is 1 to `most`.
inline std::size_t environment_count(const char* name, const char* unit,
                                     std::size_t most = std::numeric_limits<std::size_t>::max()) {
  const char* text = std::getenv(name);
  if (!text) return 0;
  std::size_t count = 0;
  const auto [end, error] = std::from_chars(text, text + std::strlen(text), count);
  require(error == std::errc() && *end == '\0' && count > 0 && count <= most, name, " is \"", text,
          "\", expected a positive whole number of ", unit);
  return count;
}

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
/// Not thread-safe: use one Context per thread. If one is a global variable, call finish_all_contexts() at
/// the end of main().
class Context {
 public:
  /// The device of MOTIONGAN_DEVICE (see choose_device), in single precision.
  Context() : Context(ContextOptions{}) {}

  /// Throws Error if no device matches, the device cannot be used or lacks the requested precision, or a
  /// variable of the environment is invalid; DeviceError if an OpenCL call fails.
  explicit Context(const ContextOptions& options) : state_(std::make_shared<detail::ContextState>()) {
    auto& s = *state_;
    s.device = options.device.empty() ? default_device() : choose_device(survey_devices(), options.device);
    s.driver.device = s.device.name;
    s.target = {options.precision, kernel_form(s.device), detail::group_size(s.device, options.group_limit)};
    if (options.element_limit > 0) s.element_limit = std::min(options.element_limit, most_elements);
    require_usable(s.device);
    require(options.precision == Precision::f32 || s.device.has_double, "device ", s.device.name,
            " has no double precision (cl_khr_fp64): use Precision::f32");
    cl_int code = CL_SUCCESS;
    const cl_context_properties properties[] = {
        CL_CONTEXT_PLATFORM, reinterpret_cast<cl_context_properties>(s.device.platform), 0};
    s.context = ClContext(clCreateContext(properties, 1, &s.device.id, &detail::DriverMessages::receive,
                                          s.driver.messages.user_data(), &code));
    s.driver.check(code, "clCreateContext");
    const char* profile = std::getenv("MOTIONGAN_PROFILE");
    s.profiling = profile && std::strcmp(profile, "") != 0 && std::strcmp(profile, "0") != 0;
    s.queue = ClQueue(clCreateCommandQueue(s.context.get(), s.device.id,
                                           s.profiling ? CL_QUEUE_PROFILING_ENABLE : 0, &code));
    s.driver.check(code, "clCreateCommandQueue");
    detail::LiveQueues::add(s.queue.get());
    std::size_t limit = options.memory_limit;
    if (limit == 0)
      limit = 1'000'000 * detail::environment_count("MOTIONGAN_MEMORY_MB", "megabytes",
                                                    std::numeric_limits<std::size_t>::max() / 1'000'000);
    s.pool = std::make_unique<detail::BufferPool>(s.context.get(), limit ? limit : s.device.global_memory,
                                                  s.device.max_allocation, s.statistics, s.driver);
    s.pool->fail_allocation(detail::environment_count("MOTIONGAN_FAIL_ALLOCATION", "buffers"));
    s.programs = std::make_unique<detail::ProgramCache>(s.context.get(), s.device, s.target, s.driver);
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
    state->target = state_->target;
    state->driver.device = state->device.name;
    state->element_limit = limited ? state_->element_limit : unlimited;
    state->pool = std::make_unique<detail::BufferPool>(nullptr, limited ? memory_limit() : unlimited,
                                                       limited ? device().max_allocation : unlimited,
                                                       state->statistics, state->driver);
    state->programs =
        std::make_unique<detail::ProgramCache>(nullptr, state->device, state->target, state->driver);
    return Context(std::move(state));
  }
  /// Whether this is a context made by counting().
  bool only_counts() const { return !state_->queue; }

  /// Bytes that all buffers together may have.
  std::size_t memory_limit() const { return state_->pool->limit(); }
  const Device& device() const { return state_->device; }
  Precision precision() const { return state_->target.precision; }
  /// Bytes per element: 4 or 8.
  std::size_t real_size() const { return precision() == Precision::f64 ? 8 : 4; }
  /// Whether the kernels have the wide form; see kernel_form().
  bool wide() const { return state_->target.wide(); }
  /// Whether they are compiled for a CPU's caches and vector registers.
  bool for_cpu() const { return state_->programs->for_cpu(); }
  /// Items of a work-group: 64, or the power of two below that the device allows.
  std::size_t group() const { return state_->target.group; }
  /// x * y * z work-groups of group() items, for kernels of the wide form.
  LaunchGrid groups(std::size_t x, std::size_t y = 1, std::size_t z = 1) const {
    return {3, {x * group(), y, z}, {group(), 1, 1}};
  }
  /// The most elements of a tensor.
  std::size_t element_limit() const { return state_->element_limit; }
  /// Elements that a work-item of an elementwise kernel handles.
  unsigned vector_width() const { return state_->programs->vector_width(); }
  cl_command_queue queue() const { return state_->queue.get(); }
  /// What was launched, copied and allocated so far.
  const ContextStatistics& statistics() const { return state_->statistics; }
  /// Adds to statistics().gemm_flops, which benchmarks compare with the device's peak.
  void count_gemm_flops(double flops) const { state_->statistics.gemm_flops += flops; }
  /// Add to statistics(), for what is not launched with tensors as arguments.
  /// \{
  void count_bytes(double bytes) const { state_->statistics.bytes_touched += bytes; }
  void count_launches(std::size_t launches) const { state_->statistics.launches += launches; }
  /// \}
  /// Whether both are copies of the same context.
  bool operator==(const Context& other) const { return state_ == other.state_; }

  /// "NAME (PLATFORM), 2 compute units, 6.1 GB, float"
  std::string description() const {
    const Device& d = state_->device;
    return concat(d.name, " (", d.platform_name, "), ", d.compute_units, " compute units, ",
                  std::round(static_cast<double>(d.global_memory) / 1e8) / 10, " GB, ",
                  precision() == Precision::f64 ? "double" : "float");
  }

  /// An uninitialised buffer from the pool. Throws Error if the memory limit would be exceeded.
  std::shared_ptr<detail::Storage> allocate(std::size_t bytes) const {
    return std::make_shared<detail::Storage>(state_, bytes);
  }

  /// Releases cached buffers to the driver.
  void trim() const { state_->pool->trim(); }

  /// For tests: the n-th buffer that the driver is asked for from now on fails; 0: none does. The variable
  /// MOTIONGAN_FAIL_ALLOCATION does the same from the start.
  void fail_allocation(std::size_t n) const { state_->pool->fail_allocation(n); }

  /// Throws DeviceError, with the device and what its driver reported, unless `code` is CL_SUCCESS.
  template <class... Details>
  void check(cl_int code, const char* call, const Details&... details) const {
    state_->driver.check(code, call, details...);
  }

  /// Waits until all enqueued work has finished.
  void finish() const {
    if (only_counts()) return;
    check(clFinish(queue()), "clFinish");
  }

  /// An event that is complete once all work enqueued so far has finished.
  ClEvent marker() const {
    cl_event event = nullptr;
    check(clEnqueueMarkerWithWaitList(queue(), 0, nullptr, &event), "clEnqueueMarkerWithWaitList");
    return ClEvent(event);
  }
  /// Blocks until the commands before the event are done.
  void wait_for(const ClEvent& done) const {
    const cl_event event = done.get();
    check(clWaitForEvents(1, &event), "clWaitForEvents");
  }

  /// Enqueues kernel `name` of cl/<file>.cl. A Tensor becomes two arguments (buffer, first element), a
  /// std::size_t a cl_uint, a KernelReal a scalar of the context's precision. An empty grid launches nothing.
  /// Throws Error if the kernel does not build or an OpenCL call fails.
  template <class... Arguments>
  void launch(const char* file, const char* name, const LaunchGrid& grid,
              const Arguments&... arguments) const {
    if (grid.global[0] == 0 || grid.global[1] == 0 || grid.global[2] == 0) return;
    if (only_counts()) return count(arguments...);
    if (state_->interrupted) stop_if_interrupted();
    require(grid.global[0] <= std::numeric_limits<cl_uint>::max(), "kernel ", name, ": ", grid.global[0],
            " work-items do not fit 32 bits; use a smaller batch or fewer frames");
    detail::KernelArguments to{state_->programs->kernel(file, name), state_->driver, precision(), name};
    (add_argument(to, arguments), ...);
    std::array<std::size_t, 3> local = grid.local;
    if (local[0] == 0) local[0] = group();
    cl_event event = nullptr;
    const cl_int code =
        clEnqueueNDRangeKernel(queue(), to.kernel, grid.dimensions, nullptr, grid.global.data(), local.data(),
                               0, nullptr, state_->profiling ? &event : nullptr);
    if (code != CL_SUCCESS)
      check(code, "clEnqueueNDRangeKernel", ": kernel ", name, " of cl/", file, ".cl, global size ",
            grid.global[0], "x", grid.global[1], "x", grid.global[2], ", local size ", local[0],
            ", arguments", describe(arguments)...);
    count(arguments...);
    if (event) record_time(name, ClEvent(event));
  }

  /// Copies `bytes` to the device; `data` may be reused on return. Waits for the queue only if it is many MB
  /// (see Staging).
  void write(cl_mem buffer, std::size_t byte_offset, const void* data, std::size_t bytes) const {
    if (bytes == 0) return;
    ++state_->statistics.writes;
    state_->statistics.bytes_written += bytes;
    if (only_counts()) return;
    state_->staging.upload(state_->driver, queue(), buffer, byte_offset, data, bytes);
    state_->statistics.bytes_staged = state_->staging.bytes();
  }

  /// Copies `bytes` to the host; waits for all work enqueued before.
  void read(cl_mem buffer, std::size_t byte_offset, void* data, std::size_t bytes) const {
    if (bytes == 0) return;
    ++state_->statistics.reads;
    if (only_counts()) return void(std::memset(data, 0, bytes));
    check(clEnqueueReadBuffer(queue(), buffer, CL_TRUE, byte_offset, bytes, data, 0, nullptr, nullptr),
          "clEnqueueReadBuffer", ": ", bytes, " bytes");
  }

 private:
  explicit Context(std::shared_ptr<detail::ContextState> state) : state_(std::move(state)) {}

  /// Counts a launch and the bytes of its arguments.
  template <class... Arguments>
  void count(const Arguments&... arguments) const {
    ++state_->statistics.launches;
    state_->statistics.bytes_touched += (0.0 + ... + bytes_of(arguments));
  }
  template <class T>
  static double bytes_of(const T& argument) {
    if constexpr (requires { argument.bytes(); })
      return static_cast<double>(argument.bytes());
    else
      return 0;
  }

  template <class T>
  static std::string describe(const T& argument) {
    if constexpr (requires { argument.describe(); })
      return " " + argument.describe();
    else if constexpr (std::is_same_v<T, KernelReal>)
      return concat(" ", argument.value);
    else
      return concat(" ", argument);
  }

  friend class Interruptible;

  /// Keeps the host at most two times `most` launches ahead of the device. Throws Interrupted.
  void stop_if_interrupted() const {
    constexpr std::size_t most = 8;
    if ((*state_->interrupted)()) throw Interrupted("interrupted");
    if (++state_->unmarked_launches < most) return;
    state_->unmarked_launches = 0;
    if (state_->marker) wait_for(state_->marker);
    state_->marker = marker();
  }

  void record_time(const char* name, const ClEvent& done) const {
    const cl_event event = done.get();
    check(clWaitForEvents(1, &event), "clWaitForEvents", ": kernel ", name);
    cl_ulong start = 0, end = 0;
    clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_START, sizeof start, &start, nullptr);
    clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_END, sizeof end, &end, nullptr);
    auto& time = state_->kernel_times[name];
    ++time.launches;
    time.nanoseconds += static_cast<double>(end - start);
  }

  std::shared_ptr<detail::ContextState> state_;
};

/// While an object of this class exists, each launch in `context` calls `interrupted` and throws Interrupted
/// if it returns true. The host then stays close to the device, so that little work is left in the queue.
class Interruptible {
 public:
  /// `interrupted` must outlive the object.
  Interruptible(const Context& context, const std::function<bool()>& interrupted)
      : context_(context), before_(std::exchange(context.state_->interrupted, &interrupted)) {}
  ~Interruptible() {
    context_.state_->interrupted = before_;
    context_.state_->marker = {};
  }
  Interruptible(const Interruptible&) = delete;
  Interruptible& operator=(const Interruptible&) = delete;

 private:
  Context context_;
  const std::function<bool()>* before_;
};

/// Waits for the work of all contexts of the process. For the end of main() in a program whose Context is a
/// global variable: such a context outlives parts of the driver, and PoCL crashes if a thread of its own
/// still builds a kernel then.
inline void finish_all_contexts() { detail::LiveQueues::finish(); }

}  // namespace motiongan

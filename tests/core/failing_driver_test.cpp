// What the library says and does when the driver fails. Functions of OpenCL that this program defines itself
// take precedence over those of the ICD loader: they fail when a test wants it and pass all else on.
#include <dlfcn.h>
#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <motiongan/core/tensor.hpp>
#include <thread>

#include "../support/messages.hpp"
#include "../support/setting.hpp"

using namespace motiongan;
using namespace motiongan::testing;

namespace {

using Notify = void(CL_CALLBACK*)(const char*, const void*, std::size_t, void*);

/// What the driver of this program does wrong.
struct Faults {
  Notify notify = nullptr;  ///< the callback of the last context, and its argument
  void* user_data = nullptr;
  cl_int write = CL_SUCCESS, read = CL_SUCCESS, finish = CL_SUCCESS, devices = CL_SUCCESS;
  const char* refused_option = nullptr;  ///< building with it is CL_INVALID_BUILD_OPTIONS
  cl_int build = CL_SUCCESS;
  bool second_platform = false;   ///< one whose devices cannot be listed
  cl_device_info unreadable = 0;  ///< a property that no device tells
  cl_device_info denied = 0;      ///< a property that is false
  const char* version = nullptr;  ///< of every device
} faults;

/// Faults for the length of one test.
struct Faulty {
  Faulty() { faults = {}; }
  ~Faulty() { faults = {}; }
};

template <class Function>
Function* real(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}
#define REAL(name) real<decltype(name)>(#name)

int made_up;
const auto second = reinterpret_cast<cl_platform_id>(&made_up);

}  // namespace

extern "C" {

cl_context clCreateContext(const cl_context_properties* properties, cl_uint count, const cl_device_id* ids,
                           Notify notify, void* user_data, cl_int* code) {
  faults.notify = notify;
  faults.user_data = user_data;
  return REAL(clCreateContext)(properties, count, ids, notify, user_data, code);
}

cl_int clEnqueueWriteBuffer(cl_command_queue queue, cl_mem buffer, cl_bool waits, std::size_t offset,
                            std::size_t size, const void* from, cl_uint count, const cl_event* list,
                            cl_event* event) {
  if (faults.write != CL_SUCCESS) return faults.write;
  return REAL(clEnqueueWriteBuffer)(queue, buffer, waits, offset, size, from, count, list, event);
}

cl_int clEnqueueReadBuffer(cl_command_queue queue, cl_mem buffer, cl_bool waits, std::size_t offset,
                           std::size_t size, void* to, cl_uint count, const cl_event* list, cl_event* event) {
  if (faults.read != CL_SUCCESS) return faults.read;
  return REAL(clEnqueueReadBuffer)(queue, buffer, waits, offset, size, to, count, list, event);
}

cl_int clFinish(cl_command_queue queue) {
  const cl_int code = REAL(clFinish)(queue);
  return faults.finish != CL_SUCCESS ? faults.finish : code;
}

cl_int clBuildProgram(cl_program program, cl_uint count, const cl_device_id* ids, const char* options,
                      void(CL_CALLBACK* notify)(cl_program, void*), void* user_data) {
  if (faults.build != CL_SUCCESS) return faults.build;
  if (faults.refused_option && std::strstr(options, faults.refused_option)) return CL_INVALID_BUILD_OPTIONS;
  return REAL(clBuildProgram)(program, count, ids, options, notify, user_data);
}

cl_int clGetPlatformIDs(cl_uint room, cl_platform_id* ids, cl_uint* count) {
  if (!faults.second_platform) return REAL(clGetPlatformIDs)(room, ids, count);
  if (count) *count = 2;
  if (!ids) return CL_SUCCESS;
  ids[0] = second;  // the failing one first
  return REAL(clGetPlatformIDs)(1, ids + 1, nullptr);
}

cl_int clGetPlatformInfo(cl_platform_id id, cl_platform_info what, std::size_t room, void* to,
                         std::size_t* size) {
  if (id != second) return REAL(clGetPlatformInfo)(id, what, room, to, size);
  const char name[] = "Broken Platform";
  if (to) std::memcpy(to, name, sizeof name);
  if (size) *size = sizeof name;
  return CL_SUCCESS;
}

cl_int clGetDeviceIDs(cl_platform_id id, cl_device_type type, cl_uint room, cl_device_id* ids,
                      cl_uint* count) {
  if (id == second) return CL_OUT_OF_HOST_MEMORY;
  if (faults.devices != CL_SUCCESS) return faults.devices;
  return REAL(clGetDeviceIDs)(id, type, room, ids, count);
}

cl_int clGetDeviceInfo(cl_device_id id, cl_device_info what, std::size_t room, void* to, std::size_t* size) {
  if (what == faults.unreadable) return CL_INVALID_DEVICE;
  if (what == faults.denied && to) return std::memset(to, 0, room), CL_SUCCESS;
  if (what == CL_DEVICE_VERSION && faults.version) {
    if (to) std::memcpy(to, faults.version, std::strlen(faults.version) + 1);
    if (size) *size = std::strlen(faults.version) + 1;
    return CL_SUCCESS;
  }
  return REAL(clGetDeviceInfo)(id, what, room, to, size);
}

}  // extern "C"

TEST_CASE("an error names the call, the code, the device and what to do") {
  const Faulty faulty;
  const Context context;
  Tensor x(context, {4});
  const std::vector<float> values{1, 2, 3, 4};
  struct {
    cl_int code;
    const char *name, *advice;
  } const codes[] = {{CL_MEM_OBJECT_ALLOCATION_FAILURE, "CL_MEM_OBJECT_ALLOCATION_FAILURE (-4)", "--batch"},
                     {CL_OUT_OF_RESOURCES, "CL_OUT_OF_RESOURCES (-5)", "MOTIONGAN_MEMORY_MB"},
                     {CL_OUT_OF_HOST_MEMORY, "CL_OUT_OF_HOST_MEMORY (-6)", "--device"},
                     {CL_INVALID_COMMAND_QUEUE, "CL_INVALID_COMMAND_QUEUE (-36)", "motiongan devices"},
                     {CL_DEVICE_NOT_AVAILABLE, "CL_DEVICE_NOT_AVAILABLE (-2)", "was lost"},
                     {-9999, "-9999", "was lost"},
                     {-777, "unknown OpenCL error (-777)", "on "}};
  for (const auto& expected : codes) {
    const char* const name = expected.name;
    CAPTURE(name);
    for (const bool reads : {false, true}) {
      (reads ? faults.read : faults.write) = expected.code;
      const std::string text = message_of([&] {
        if (reads)
          x.to_host();
        else
          x.write(std::span<const float>(values));
      });
      faults.read = faults.write = CL_SUCCESS;
      CAPTURE(text);
      CHECK(says(text, concat(reads ? "clEnqueueReadBuffer" : "clEnqueueWriteBuffer", " failed with ")));
      CHECK(says(text, name));
      CHECK(says(text, expected.advice));
      CHECK(says(text, "on " + context.device().name));
    }
  }
  x.write(std::span<const float>(values));
  CHECK(x.to_host() == values);
}

TEST_CASE("what the driver reports, from any thread, is in the error of the next failing call, once") {
  const Faulty faulty;
  const Context context;
  REQUIRE((faults.notify != nullptr));
  const Tensor x(context, {4});
  const auto read_fails = [&] {
    faults.read = CL_OUT_OF_RESOURCES;
    std::string text = message_of([&] { x.to_host(); });
    faults.read = CL_SUCCESS;
    return text;
  };
  CHECK_FALSE(says(read_fails(), "the driver reports"));
  const Notify notify = faults.notify;
  void* const user_data = faults.user_data;
  std::thread([&] { notify("page fault at 0x10", nullptr, 0, user_data); }).join();
  notify("kernel ended", nullptr, 0, user_data);
  CHECK(says(read_fails(), "; the driver reports: page fault at 0x10; kernel ended; "));
  CHECK_FALSE(says(read_fails(), "the driver reports"));

  std::vector<std::thread> threads;  // many at once: what is kept has a limit
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([&] {
      for (int n = 0; n < 500; ++n) notify("again and again", nullptr, 0, user_data);
    });
  for (std::thread& thread : threads) thread.join();
  CHECK(read_fails().size() < 2000);

  const auto late = [&] {
    const Context other;
    return faults.user_data;
  }();
  notify("after its context is gone", nullptr, 0, late);
  CHECK_FALSE(says(read_fails(), "the driver reports"));
}

TEST_CASE("a context whose last work fails is destroyed without an exception") {
  const Faulty faulty;
  {
    const Context context;
    const Tensor x = Tensor::from(context, {2}, std::vector<float>{1, 2});
    faults.finish = CL_INVALID_COMMAND_QUEUE;
    CHECK(says(message_of([&] { context.finish(); }), "clFinish failed with CL_INVALID_COMMAND_QUEUE"));
  }
  CHECK(faults.finish != CL_SUCCESS);
}

TEST_CASE("a driver that refuses the option of the language version builds without it") {
  const Faulty faulty;
  const Setting compiled_anew("MOTIONGAN_CACHE_DIR", "");
  const Context context;
  const Tensor x(context, {4});
  const auto fill = [&] {
    context.launch("elementwise", "fill", LaunchGrid::items(4), x, x.size(), KernelReal{2});
  };
  faults.refused_option = "-DREAL";  // not optional
  const std::string text = message_of(fill);
  CHECK(says(text, "clBuildProgram failed with CL_INVALID_BUILD_OPTIONS (-43) for cl/elementwise.cl on " +
                       context.device().name));
  CHECK(says(text, "(options -cl-std=CL1.2 -DREAL=float"));
  CHECK(says(text, ", and without the first)"));
  faults.refused_option = "-cl-std";
  fill();
  CHECK(x.to_host() == std::vector<float>(4, 2));
}

TEST_CASE("a build that fails without an error of the compiler points at the cache") {
  const Faulty faulty;
  const Context context;
  if (!says(context.device().platform_name, "Portable Computing Language")) return;
  const Tensor x(context, {4});
  faults.build = CL_BUILD_PROGRAM_FAILURE;
  CHECK(says(message_of([&] {
               context.launch("elementwise", "fill", LaunchGrid::items(4), x, x.size(), KernelReal{2});
             }),
             "POCL_CACHE_DIR"));
}

TEST_CASE("a platform that fails hides neither itself nor the others") {
  const Faulty faulty;
  const std::size_t before = all_devices().size();
  faults.second_platform = true;
  const DeviceSurvey survey = survey_devices();
  CHECK(survey.devices.size() == before);
  REQUIRE(survey.problems.size() == 1);
  CHECK(says(survey.problems[0],
             "Broken Platform: no device, clGetDeviceIDs failed with CL_OUT_OF_HOST_MEMORY (-6)"));
  CHECK(says(message_of([&] { choose_device(survey, "absent"); }), "Broken Platform: no device"));
  CHECK_NOTHROW(Context());
}

TEST_CASE("without a device the error has the code of every platform, and PoCL's cache") {
  const Faulty faulty;
  faults.second_platform = true;
  faults.devices = CL_DEVICE_NOT_FOUND;
  const std::string text = message_of([] { Context(); });
  CAPTURE(text);
  CHECK(says(text, "no OpenCL device found"));
  CHECK(says(text, "Broken Platform: no device, clGetDeviceIDs failed with CL_OUT_OF_HOST_MEMORY (-6)"));
  CHECK(says(text, "clGetDeviceIDs failed with CL_DEVICE_NOT_FOUND (-1)"));
  if (says(text, "Portable")) CHECK(says(text, "POCL_CACHE_DIR"));
}

TEST_CASE("a device that does not tell its properties is a problem of its own") {
  const Faulty faulty;
  const DeviceSurvey before = survey_devices();
  faults.unreadable = CL_DEVICE_GLOBAL_MEM_SIZE;
  const DeviceSurvey survey = survey_devices();
  CHECK(survey.devices.empty());
  CHECK(survey.problems.size() == before.problems.size() + before.devices.size());
  CHECK(std::any_of(survey.problems.begin(), survey.problems.end(), [](const std::string& problem) {
    return says(problem, "device 0 cannot be used: clGetDeviceInfo failed with CL_INVALID_DEVICE");
  }));
}

TEST_CASE("a device without a compiler, not available or too old is refused, with the reason") {
  const Faulty faulty;
  const auto refused = [] { return message_of([] { Context({.device = ":0"}); }); };
  faults.denied = CL_DEVICE_COMPILER_AVAILABLE;
  CHECK(says(refused(), "cannot be used: its driver has no compiler"));
  CHECK(says(refused(), "motiongan devices"));
  faults.denied = CL_DEVICE_AVAILABLE;
  CHECK(says(refused(), "cannot be used: it is not available"));
  faults.denied = 0;
  faults.version = "OpenCL 1.1 old";
  CHECK(says(refused(), "it has OpenCL 1.1 old, the kernels need OpenCL 1.2"));
  faults.version = "OpenCL 1.2 enough";
  CHECK_NOTHROW(Context());
}

TEST_CASE("MOTIONGAN_FAIL_ALLOCATION and fail_allocation() let the n-th buffer fail") {
  const Faulty faulty;
  {
    const Setting setting("MOTIONGAN_FAIL_ALLOCATION", "3");
    const Context context;
    const Tensor a(context, {1000}), b(context, {1000});
    const std::string text = message_of([&] { Tensor(context, {1000}); });
    CAPTURE(text);
    CHECK(says(text, "clCreateBuffer failed with CL_MEM_OBJECT_ALLOCATION_FAILURE (-4): 0.004 MB requested"));
    CHECK(says(text, "as a test wants it"));
    CHECK(says(text, "--batch"));
    CHECK(context.statistics().allocations == 2);
    CHECK_NOTHROW(Tensor(context, {1000}));
    context.fail_allocation(1);
    CHECK_NOTHROW(Tensor(context, {1000}));  // reused, not allocated
    CHECK_THROWS_AS(Tensor(context, {5000}), DeviceError);
  }
  const Setting setting("MOTIONGAN_FAIL_ALLOCATION", "first");
  CHECK(says(message_of([] { Context(); }), "MOTIONGAN_FAIL_ALLOCATION is \"first\""));
}

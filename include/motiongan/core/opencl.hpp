// OpenCL's C API, error names and RAII handles.
#pragma once
#ifndef CL_TARGET_OPENCL_VERSION
#define CL_TARGET_OPENCL_VERSION 120
#endif
#include <CL/cl.h>

#include <string>
#include <utility>

#include "motiongan/core/error.hpp"

namespace motiongan {

namespace detail {
struct OpenclCode {
  cl_int code;
  const char* name;
};
#define MOTIONGAN_CODE(name) \
  { name, #name }
inline constexpr OpenclCode opencl_codes[] = {
    MOTIONGAN_CODE(CL_SUCCESS),
    MOTIONGAN_CODE(CL_DEVICE_NOT_FOUND),
    MOTIONGAN_CODE(CL_DEVICE_NOT_AVAILABLE),
    MOTIONGAN_CODE(CL_COMPILER_NOT_AVAILABLE),
    MOTIONGAN_CODE(CL_MEM_OBJECT_ALLOCATION_FAILURE),
    MOTIONGAN_CODE(CL_OUT_OF_RESOURCES),
    MOTIONGAN_CODE(CL_OUT_OF_HOST_MEMORY),
    MOTIONGAN_CODE(CL_PROFILING_INFO_NOT_AVAILABLE),
    MOTIONGAN_CODE(CL_MEM_COPY_OVERLAP),
    MOTIONGAN_CODE(CL_BUILD_PROGRAM_FAILURE),
    MOTIONGAN_CODE(CL_MAP_FAILURE),
    MOTIONGAN_CODE(CL_MISALIGNED_SUB_BUFFER_OFFSET),
    MOTIONGAN_CODE(CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST),
    MOTIONGAN_CODE(CL_COMPILE_PROGRAM_FAILURE),
    MOTIONGAN_CODE(CL_LINKER_NOT_AVAILABLE),
    MOTIONGAN_CODE(CL_LINK_PROGRAM_FAILURE),
    MOTIONGAN_CODE(CL_KERNEL_ARG_INFO_NOT_AVAILABLE),
    MOTIONGAN_CODE(CL_INVALID_VALUE),
    MOTIONGAN_CODE(CL_INVALID_DEVICE_TYPE),
    MOTIONGAN_CODE(CL_INVALID_PLATFORM),
    MOTIONGAN_CODE(CL_INVALID_DEVICE),
    MOTIONGAN_CODE(CL_INVALID_CONTEXT),
    MOTIONGAN_CODE(CL_INVALID_QUEUE_PROPERTIES),
    MOTIONGAN_CODE(CL_INVALID_COMMAND_QUEUE),
    MOTIONGAN_CODE(CL_INVALID_HOST_PTR),
    MOTIONGAN_CODE(CL_INVALID_MEM_OBJECT),
    MOTIONGAN_CODE(CL_INVALID_BINARY),
    MOTIONGAN_CODE(CL_INVALID_BUILD_OPTIONS),
    MOTIONGAN_CODE(CL_INVALID_PROGRAM),
    MOTIONGAN_CODE(CL_INVALID_PROGRAM_EXECUTABLE),
    MOTIONGAN_CODE(CL_INVALID_KERNEL_NAME),
    MOTIONGAN_CODE(CL_INVALID_KERNEL_DEFINITION),
    MOTIONGAN_CODE(CL_INVALID_KERNEL),
    MOTIONGAN_CODE(CL_INVALID_ARG_INDEX),
    MOTIONGAN_CODE(CL_INVALID_ARG_VALUE),
    MOTIONGAN_CODE(CL_INVALID_ARG_SIZE),
    MOTIONGAN_CODE(CL_INVALID_KERNEL_ARGS),
    MOTIONGAN_CODE(CL_INVALID_WORK_DIMENSION),
    MOTIONGAN_CODE(CL_INVALID_WORK_GROUP_SIZE),
    MOTIONGAN_CODE(CL_INVALID_WORK_ITEM_SIZE),
    MOTIONGAN_CODE(CL_INVALID_GLOBAL_OFFSET),
    MOTIONGAN_CODE(CL_INVALID_EVENT_WAIT_LIST),
    MOTIONGAN_CODE(CL_INVALID_EVENT),
    MOTIONGAN_CODE(CL_INVALID_OPERATION),
    MOTIONGAN_CODE(CL_INVALID_BUFFER_SIZE),
    MOTIONGAN_CODE(CL_INVALID_GLOBAL_WORK_SIZE),
    MOTIONGAN_CODE(CL_INVALID_PROPERTY),
    MOTIONGAN_CODE(CL_INVALID_COMPILER_OPTIONS),
    MOTIONGAN_CODE(CL_INVALID_LINKER_OPTIONS),
    {-1001, "CL_PLATFORM_NOT_FOUND_KHR"},          // of the ICD loader
    {-9999, "illegal read or write by a kernel"},  // of NVIDIA's driver
};
#undef MOTIONGAN_CODE
}  // namespace detail

/// Name and value of an OpenCL error code: "CL_OUT_OF_RESOURCES (-5)".
inline std::string opencl_error_name(cl_int code) {
  for (const auto& known : detail::opencl_codes)
    if (known.code == code) return concat(known.name, " (", code, ")");
  return concat("unknown OpenCL error (", code, ")");
}

/// What to do about an error code, with the punctuation before it; "" if the code does not tell.
inline const char* opencl_advice(cl_int code) {
  switch (code) {
    case CL_MEM_OBJECT_ALLOCATION_FAILURE:
    case CL_OUT_OF_RESOURCES:
    case CL_OUT_OF_HOST_MEMORY:
      return "; the device or its driver is out of memory (some drivers also say so when a kernel crashed): "
             "use a smaller --batch or fewer --frames, end other programs on the device, set "
             "MOTIONGAN_MEMORY_MB to what is free, or choose another --device";
    case CL_DEVICE_NOT_AVAILABLE:
    case CL_INVALID_COMMAND_QUEUE:
    case CL_INVALID_CONTEXT:
    case CL_INVALID_DEVICE:
    case CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST:
    case -9999:
      return "; the device was lost or its driver was reset: see whether `motiongan devices` still lists it "
             "and start again, or choose another --device";
    case CL_COMPILER_NOT_AVAILABLE:
    case CL_LINKER_NOT_AVAILABLE:
      return "; the driver cannot compile kernels: install the vendor's full package, or choose another "
             "--device (see `motiongan devices`)";
    default:
      return "";
  }
}

/// Throws DeviceError, with the call, the error code and `details`, unless `code` is CL_SUCCESS.
template <class... Details>
void check_cl(cl_int code, const char* call, const Details&... details) {
  if (code != CL_SUCCESS)
    throw DeviceError(call, " failed with ", opencl_error_name(code), details..., opencl_advice(code));
}

/// Owns one OpenCL object and releases it on destruction; move-only.
template <class Handle, cl_int (*release)(Handle)>
class Owned {
 public:
  Owned() = default;
  explicit Owned(Handle handle) : handle_(handle) {}
  Owned(Owned&& other) noexcept : handle_(std::exchange(other.handle_, nullptr)) {}
  Owned& operator=(Owned&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  Owned(const Owned&) = delete;
  Owned& operator=(const Owned&) = delete;
  ~Owned() {
    if (handle_) release(handle_);
  }
  Handle get() const { return handle_; }
  explicit operator bool() const { return handle_ != nullptr; }

 private:
  Handle handle_ = nullptr;
};

/// OpenCL objects that are released with their owner.
/// \{
using ClContext = Owned<cl_context, clReleaseContext>;
using ClQueue = Owned<cl_command_queue, clReleaseCommandQueue>;
using ClProgram = Owned<cl_program, clReleaseProgram>;
using ClKernel = Owned<cl_kernel, clReleaseKernel>;
using ClBuffer = Owned<cl_mem, clReleaseMemObject>;
using ClEvent = Owned<cl_event, clReleaseEvent>;
/// \}

}  // namespace motiongan

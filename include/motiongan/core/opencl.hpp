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

/// Name and value of an OpenCL error code: "CL_OUT_OF_RESOURCES (-5)".
inline std::string opencl_error_name(cl_int code) {
  const auto name = [code]() -> const char* {
    switch (code) {
      case CL_SUCCESS:
        return "CL_SUCCESS";
      case CL_DEVICE_NOT_FOUND:
        return "CL_DEVICE_NOT_FOUND";
      case CL_DEVICE_NOT_AVAILABLE:
        return "CL_DEVICE_NOT_AVAILABLE";
      case CL_COMPILER_NOT_AVAILABLE:
        return "CL_COMPILER_NOT_AVAILABLE";
      case CL_MEM_OBJECT_ALLOCATION_FAILURE:
        return "CL_MEM_OBJECT_ALLOCATION_FAILURE";
      case CL_OUT_OF_RESOURCES:
        return "CL_OUT_OF_RESOURCES";
      case CL_OUT_OF_HOST_MEMORY:
        return "CL_OUT_OF_HOST_MEMORY";
      case CL_BUILD_PROGRAM_FAILURE:
        return "CL_BUILD_PROGRAM_FAILURE";
      case CL_INVALID_VALUE:
        return "CL_INVALID_VALUE";
      case CL_INVALID_DEVICE:
        return "CL_INVALID_DEVICE";
      case CL_INVALID_CONTEXT:
        return "CL_INVALID_CONTEXT";
      case CL_INVALID_COMMAND_QUEUE:
        return "CL_INVALID_COMMAND_QUEUE";
      case CL_INVALID_MEM_OBJECT:
        return "CL_INVALID_MEM_OBJECT";
      case CL_INVALID_BUILD_OPTIONS:
        return "CL_INVALID_BUILD_OPTIONS";
      case CL_INVALID_PROGRAM_EXECUTABLE:
        return "CL_INVALID_PROGRAM_EXECUTABLE";
      case CL_INVALID_KERNEL_NAME:
        return "CL_INVALID_KERNEL_NAME";
      case CL_INVALID_KERNEL:
        return "CL_INVALID_KERNEL";
      case CL_INVALID_ARG_INDEX:
        return "CL_INVALID_ARG_INDEX";
      case CL_INVALID_ARG_VALUE:
        return "CL_INVALID_ARG_VALUE";
      case CL_INVALID_ARG_SIZE:
        return "CL_INVALID_ARG_SIZE";
      case CL_INVALID_KERNEL_ARGS:
        return "CL_INVALID_KERNEL_ARGS";
      case CL_INVALID_WORK_DIMENSION:
        return "CL_INVALID_WORK_DIMENSION";
      case CL_INVALID_WORK_GROUP_SIZE:
        return "CL_INVALID_WORK_GROUP_SIZE";
      case CL_INVALID_WORK_ITEM_SIZE:
        return "CL_INVALID_WORK_ITEM_SIZE";
      case CL_INVALID_BUFFER_SIZE:
        return "CL_INVALID_BUFFER_SIZE";
      case CL_INVALID_GLOBAL_WORK_SIZE:
        return "CL_INVALID_GLOBAL_WORK_SIZE";
      case -1001:
        return "CL_PLATFORM_NOT_FOUND_KHR";
      default:
        return "OpenCL error";
    }
  }();
  return concat(name, " (", code, ")");
}

/// Throws Error, with the call, the error code and `details`, unless `code` is CL_SUCCESS.
template <class... Details>
void check_cl(cl_int code, const char* call, const Details&... details) {
  if (code != CL_SUCCESS) throw Error(call, " failed with ", opencl_error_name(code), details...);
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

using ClContext = Owned<cl_context, clReleaseContext>;
using ClQueue = Owned<cl_command_queue, clReleaseCommandQueue>;
using ClProgram = Owned<cl_program, clReleaseProgram>;
using ClKernel = Owned<cl_kernel, clReleaseKernel>;
using ClBuffer = Owned<cl_mem, clReleaseMemObject>;
using ClEvent = Owned<cl_event, clReleaseEvent>;

}  // namespace motiongan

// Enumerating and choosing OpenCL devices.
#pragma once
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "motiongan/core/opencl.hpp"

namespace motiongan {

/// One OpenCL device and its properties.
struct Device {
  cl_platform_id platform = nullptr;
  cl_device_id id = nullptr;
  std::string name;           ///< as reported by the driver
  std::string platform_name;  ///< "Portable Computing Language", "NVIDIA CUDA", ...
  std::string version;        ///< the device's OpenCL version string
  cl_device_type type = 0;
  cl_uint compute_units = 0;
  cl_ulong global_memory = 0;      ///< bytes
  cl_ulong max_allocation = 0;     ///< bytes in one buffer
  cl_uint native_float_width = 1;  ///< floats per vector register
  bool has_double = false;

  bool is_cpu() const { return (type & CL_DEVICE_TYPE_CPU) != 0; }
  bool is_gpu() const { return (type & CL_DEVICE_TYPE_GPU) != 0; }
};

namespace detail {

inline std::string device_string(cl_device_id id, cl_device_info what) {
  std::size_t size = 0;
  check_cl(clGetDeviceInfo(id, what, 0, nullptr, &size), "clGetDeviceInfo");
  std::string text(size, '\0');
  check_cl(clGetDeviceInfo(id, what, size, text.data(), nullptr), "clGetDeviceInfo");
  while (!text.empty() && (text.back() == '\0' || text.back() == ' ')) text.pop_back();
  return text;
}

template <class T>
T device_value(cl_device_id id, cl_device_info what) {
  T value{};
  check_cl(clGetDeviceInfo(id, what, sizeof value, &value, nullptr), "clGetDeviceInfo");
  return value;
}

inline std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

}  // namespace detail

/// All OpenCL devices of all platforms, in the ICD loader's order; empty if there are none.
inline std::vector<Device> all_devices() {
  std::vector<Device> found;
  cl_uint platform_count = 0;
  if (clGetPlatformIDs(0, nullptr, &platform_count) != CL_SUCCESS || platform_count == 0) return found;
  std::vector<cl_platform_id> platforms(platform_count);
  check_cl(clGetPlatformIDs(platform_count, platforms.data(), nullptr), "clGetPlatformIDs");
  for (cl_platform_id platform : platforms) {
    cl_uint count = 0;
    // A platform without devices returns CL_DEVICE_NOT_FOUND; skip it.
    if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 0, nullptr, &count) != CL_SUCCESS) continue;
    std::vector<cl_device_id> ids(count);
    if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, count, ids.data(), nullptr) != CL_SUCCESS) continue;
    std::string platform_name(256, '\0');
    std::size_t size = 0;
    if (clGetPlatformInfo(platform, CL_PLATFORM_NAME, platform_name.size(), platform_name.data(), &size) !=
        CL_SUCCESS)
      size = 1;
    platform_name.resize(size ? size - 1 : 0);
    for (cl_device_id id : ids) {
      Device d;
      d.platform = platform;
      d.id = id;
      d.platform_name = platform_name;
      d.name = detail::device_string(id, CL_DEVICE_NAME);
      d.version = detail::device_string(id, CL_DEVICE_VERSION);
      d.type = detail::device_value<cl_device_type>(id, CL_DEVICE_TYPE);
      d.compute_units = detail::device_value<cl_uint>(id, CL_DEVICE_MAX_COMPUTE_UNITS);
      d.global_memory = detail::device_value<cl_ulong>(id, CL_DEVICE_GLOBAL_MEM_SIZE);
      d.max_allocation = detail::device_value<cl_ulong>(id, CL_DEVICE_MAX_MEM_ALLOC_SIZE);
      d.native_float_width = detail::device_value<cl_uint>(id, CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT);
      d.has_double = detail::device_string(id, CL_DEVICE_EXTENSIONS).find("cl_khr_fp64") != std::string::npos;
      found.push_back(std::move(d));
    }
  }
  return found;
}

/// Chooses one of `devices` by `wish`: "" (the first GPU, else the first device), "cpu", "gpu" or part of the
/// device or platform name (case-insensitive), optionally followed by ":index" (from 0) to take a later
/// match. Throws Error, listing the devices, if none matches.
inline Device choose_device(const std::vector<Device>& devices, std::string_view wish) {
  if (devices.empty())
    throw Error(
        "no OpenCL device found: install a driver (on Debian for the CPU: apt install pocl-opencl-icd; for a "
        "GPU: its vendor's OpenCL "
        "package) and check that `clinfo -l` lists it");
  std::string kind = detail::lower(wish);
  std::size_t index = 0;
  if (const auto colon = kind.rfind(':'); colon != std::string::npos) {
    const char* end = kind.data() + kind.size();
    const auto [stop, code] = std::from_chars(kind.data() + colon + 1, end, index);
    if (code == std::errc() && stop == end)
      kind.resize(colon);
    else
      index = 0;  // the colon is part of the name
  }
  std::vector<Device> matches;
  for (const Device& d : devices) {
    const bool fits = kind.empty()    ? true
                      : kind == "cpu" ? d.is_cpu()
                      : kind == "gpu"
                          ? d.is_gpu()
                          : detail::lower(d.name + " " + d.platform_name).find(kind) != std::string::npos;
    if (fits) matches.push_back(d);
  }
  if (kind.empty())
    for (const Device& d : devices)
      if (d.is_gpu() && index == 0) return d;
  if (index < matches.size()) return matches[index];
  std::string list;
  for (const Device& d : devices)
    list += concat("\n  ",
                   d.is_gpu()   ? "gpu"
                   : d.is_cpu() ? "cpu"
                                : "other",
                   "  ", d.name, "  (", d.platform_name, ")");
  throw Error("no OpenCL device matches \"", wish, "\" (", matches.size(), " match the name, index ", index,
              " requested); use cpu, gpu, part of a name, or NAME:index. Available devices:", list);
}

/// The device that MOTIONGAN_DEVICE names, or that of choose_device("") if it is unset. Throws Error if none
/// matches.
inline Device default_device() {
  const char* wish = std::getenv("MOTIONGAN_DEVICE");
  return choose_device(all_devices(), wish ? wish : "");
}

}  // namespace motiongan

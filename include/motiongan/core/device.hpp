// Enumerating and choosing OpenCL devices.
#pragma once
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <mutex>
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
  std::string c_version;      ///< the version of OpenCL C that it compiles, as a string
  cl_device_type type = 0;    ///< a CPU, a GPU or another
  cl_uint compute_units = 0;
  cl_ulong global_memory = 0;      ///< bytes
  cl_ulong max_allocation = 0;     ///< bytes in one buffer
  cl_uint native_float_width = 1;  ///< floats per vector register
  std::size_t max_group = 1;       ///< work-items of one work-group
  bool has_double = false;         ///< whether Precision::f64 works
  bool available = true;           ///< CL_DEVICE_AVAILABLE
  bool has_compiler = true;        ///< CL_DEVICE_COMPILER_AVAILABLE

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

/// The devices found on all platforms, in the ICD loader's order, and what failed while looking: a line for
/// every platform and device that could not be listed.
struct DeviceSurvey {
  std::vector<Device> devices;        ///< those that could be listed
  std::vector<std::string> problems;  ///< one for each platform and device that could not
};

namespace detail {

inline constexpr const char* pocl_cache_advice =
    "PoCL fails so if it cannot write to its kernel cache: set POCL_CACHE_DIR to a folder that you can write";

inline bool is_pocl(const std::string& platform_name) {
  return platform_name == "Portable Computing Language" || lower(platform_name).starts_with("pocl");
}

/// Throws DeviceError if the driver does not tell one of the properties.
inline Device describe_device(cl_platform_id platform, const std::string& platform_name, cl_device_id id) {
  Device d;
  d.platform = platform;
  d.id = id;
  d.platform_name = platform_name;
  d.name = device_string(id, CL_DEVICE_NAME);
  d.version = device_string(id, CL_DEVICE_VERSION);
  d.c_version = device_string(id, CL_DEVICE_OPENCL_C_VERSION);
  d.type = device_value<cl_device_type>(id, CL_DEVICE_TYPE);
  d.compute_units = device_value<cl_uint>(id, CL_DEVICE_MAX_COMPUTE_UNITS);
  d.global_memory = device_value<cl_ulong>(id, CL_DEVICE_GLOBAL_MEM_SIZE);
  d.max_allocation = device_value<cl_ulong>(id, CL_DEVICE_MAX_MEM_ALLOC_SIZE);
  d.native_float_width = device_value<cl_uint>(id, CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT);
  d.max_group = device_value<std::size_t>(id, CL_DEVICE_MAX_WORK_GROUP_SIZE);
  d.has_double = device_string(id, CL_DEVICE_EXTENSIONS).find("cl_khr_fp64") != std::string::npos;
  d.available = device_value<cl_bool>(id, CL_DEVICE_AVAILABLE) != CL_FALSE;
  d.has_compiler = device_value<cl_bool>(id, CL_DEVICE_COMPILER_AVAILABLE) != CL_FALSE;
  return d;
}

inline std::string platform_string(cl_platform_id platform, std::size_t number) {
  std::string name(256, '\0');
  std::size_t size = 0;
  if (clGetPlatformInfo(platform, CL_PLATFORM_NAME, name.size(), name.data(), &size) != CL_SUCCESS ||
      size < 2)
    return concat("platform ", number);
  name.resize(size - 1);
  return name;
}

/// Adds the devices of one platform to `found`.
inline void survey_platform(cl_platform_id platform, const std::string& name, DeviceSurvey& found) {
  cl_uint count = 0;
  std::vector<cl_device_id> ids;
  cl_int code = clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 0, nullptr, &count);
  if (code == CL_SUCCESS && count > 0) {
    ids.resize(count);
    code = clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, count, ids.data(), nullptr);
  }
  if (code != CL_SUCCESS || count == 0) {
    found.problems.push_back(
        concat(name, ": no device",
               code == CL_SUCCESS ? "" : concat(", clGetDeviceIDs failed with ", opencl_error_name(code)),
               is_pocl(name) ? concat("; ", pocl_cache_advice) : ""));
    return;
  }
  for (cl_uint i = 0; i < count; ++i) {
    try {
      found.devices.push_back(describe_device(platform, name, ids[i]));
    } catch (const DeviceError& error) {
      found.problems.push_back(concat(name, ": device ", i, " cannot be used: ", error.what()));
    }
  }
}

}  // namespace detail

/// Lists the devices of all platforms; a platform or device that fails becomes a problem and does not hide
/// the others. May be called by several threads.
inline DeviceSurvey survey_devices() {
  static std::mutex one_at_a_time;  // PoCL crashes if two threads are the first to ask for its devices
  const std::lock_guard hold(one_at_a_time);
  DeviceSurvey found;
  cl_uint count = 0;
  std::vector<cl_platform_id> platforms;
  cl_int code = clGetPlatformIDs(0, nullptr, &count);
  if (code == CL_SUCCESS && count > 0) {
    platforms.resize(count);
    code = clGetPlatformIDs(count, platforms.data(), nullptr);
  }
  if (code != CL_SUCCESS) {
    found.problems.push_back(concat("no platform: clGetPlatformIDs failed with ", opencl_error_name(code)));
    return found;
  }
  for (std::size_t i = 0; i < platforms.size(); ++i)
    detail::survey_platform(platforms[i], detail::platform_string(platforms[i], i), found);
  return found;
}

/// All OpenCL devices of all platforms; empty if there are none. See survey_devices() for what failed.
inline std::vector<Device> all_devices() { return survey_devices().devices; }

namespace detail {

/// Whether a version string such as "OpenCL 3.0 PoCL" or "OpenCL C 1.2" is at least 1.2, or not understood.
inline bool is_at_least_1_2(std::string_view version) {
  const std::size_t digit = version.find_first_of("0123456789");
  unsigned major = 0, minor = 0;
  if (digit == std::string_view::npos) return true;
  const char* end = version.data() + version.size();
  const auto [dot, problem] = std::from_chars(version.data() + digit, end, major);
  if (problem != std::errc() || dot == end || *dot != '.') return true;
  if (std::from_chars(dot + 1, end, minor).ec != std::errc()) return true;
  return major > 1 || (major == 1 && minor >= 2);
}

}  // namespace detail

/// Why a Context cannot use the device; "" if it can.
inline std::string why_unusable(const Device& device) {
  if (!device.available) return "it is not available (CL_DEVICE_AVAILABLE): another program may hold it";
  if (!device.has_compiler) return "its driver has no compiler for kernels (CL_DEVICE_COMPILER_AVAILABLE)";
  for (const std::string& version : {device.version, device.c_version})
    if (!detail::is_at_least_1_2(version))
      return concat("it has ", version, ", the kernels need OpenCL 1.2 and OpenCL C 1.2");
  return {};
}

/// Throws DeviceError, with the reason, if a Context cannot use the device.
inline void require_usable(const Device& device) {
  if (const std::string reason = why_unusable(device); !reason.empty())
    throw DeviceError("device ", device.name, " (", device.platform_name, ") cannot be used: ", reason,
                      "; choose another with --device or MOTIONGAN_DEVICE (see `motiongan devices`), or "
                      "install the vendor's current driver");
}

/// Chooses one of the devices by `wish`: "" (the first usable GPU, else the first usable device), "cpu",
/// "gpu" or part of the device or platform name (case-insensitive), optionally followed by ":index" (from 0)
/// to take a later match. Throws Error, listing the devices and what failed while looking, if none matches.
inline Device choose_device(const DeviceSurvey& survey, std::string_view wish) {
  const std::vector<Device>& devices = survey.devices;
  std::string problems;
  for (const std::string& problem : survey.problems) problems += concat("\n  ", problem);
  if (devices.empty())
    throw Error(
        "no OpenCL device found: install a driver (on Debian for the CPU: apt install pocl-opencl-icd; for a "
        "GPU: its vendor's OpenCL package) and check that `clinfo -l` lists it",
        problems.empty() ? "" : ". What was found:", problems);
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
  if (kind.empty() && index == 0)
    for (const bool gpu : {true, false})
      for (const Device& d : devices)
        if ((d.is_gpu() || !gpu) && why_unusable(d).empty()) return d;
  if (index < matches.size()) return matches[index];
  std::string list;
  for (const Device& d : devices)
    list += concat("\n  ",
                   d.is_gpu()   ? "gpu"
                   : d.is_cpu() ? "cpu"
                                : "other",
                   "  ", d.name, "  (", d.platform_name, ")");
  throw Error("no OpenCL device matches \"", wish, "\" (", matches.size(), " match the name, index ", index,
              " requested); use cpu, gpu, part of a name, or NAME:index. Available devices:", list,
              problems.empty() ? "" : "\nWhat failed while looking for others:", problems);
}

/// The one of `devices` that `wish` selects.
inline Device choose_device(const std::vector<Device>& devices, std::string_view wish) {
  return choose_device(DeviceSurvey{devices, {}}, wish);
}

/// The device that MOTIONGAN_DEVICE names, or that of choose_device("") if it is unset. Throws Error if none
/// matches.
inline Device default_device() {
  const char* wish = std::getenv("MOTIONGAN_DEVICE");
  return choose_device(survey_devices(), wish ? wish : "");
}

}  // namespace motiongan

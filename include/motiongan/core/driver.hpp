// What a Context knows of its driver when a call fails: the device's name, and what the driver had to say.
#pragma once
#include <cstdint>
#include <map>
#include <mutex>
#include <string>

#include "motiongan/core/opencl.hpp"

namespace motiongan::detail {

/// The texts that a driver reports through clCreateContext's callback, from any thread, until they are taken.
/// The callback gets a number, not an address: the driver's context may outlive this object, because
/// libraries retain it.
class DriverMessages {
 public:
  DriverMessages() {
    const std::lock_guard hold(shared().lock);
    number_ = ++shared().last;
    shared().texts[number_];
  }
  DriverMessages(const DriverMessages&) = delete;
  DriverMessages& operator=(const DriverMessages&) = delete;
  ~DriverMessages() {
    const std::lock_guard hold(shared().lock);
    shared().texts.erase(number_);
  }

  /// The last two arguments of clCreateContext's callback: `receive` with `user_data()`.
  void* user_data() const {
    return reinterpret_cast<void*>(number_);  // NOLINT(performance-no-int-to-ptr): it is never followed
  }
  static void CL_CALLBACK receive(const char* text, const void*, std::size_t, void* user_data) noexcept {
    try {
      const std::lock_guard hold(shared().lock);
      const auto found = shared().texts.find(reinterpret_cast<std::uintptr_t>(user_data));
      if (found == shared().texts.end() || !text) return;
      std::string& all = found->second;
      if (!all.empty()) all += "; ";
      all += text;
      if (all.size() > kept) all.erase(0, all.size() - kept);
    } catch (...) {  // out of memory: the error code alone has to do
    }
  }

  /// What was reported since the last call; "" if nothing.
  std::string take() {
    const std::lock_guard hold(shared().lock);
    return std::exchange(shared().texts[number_], {});
  }

 private:
  static constexpr std::size_t kept = 1000;  // characters
  struct Shared {
    std::mutex lock;
    std::map<std::uintptr_t, std::string> texts;
    std::uintptr_t last = 0;
  };
  static Shared& shared() {
    static auto* all = new Shared;  // never destroyed: a driver's thread may report at the end of the program
    return *all;
  }
  std::uintptr_t number_ = 0;
};

/// Checks the calls of one context.
struct Driver {
  std::string device;  ///< its name
  DriverMessages messages{};

  /// Throws DeviceError unless `code` is CL_SUCCESS: the call, the code, `details`, the device, what the
  /// driver reported, and what to do.
  template <class... Details>
  void check(cl_int code, const char* call, const Details&... details) {
    if (code != CL_SUCCESS) [[unlikely]]
      fail(code, call, concat(details...));
  }
  [[noreturn]] void fail(cl_int code, const char* call, const std::string& details) {
    const std::string reported = messages.take();
    throw DeviceError(call, " failed with ", opencl_error_name(code), details, ", on ", device,
                      reported.empty() ? "" : "; the driver reports: ", reported, opencl_advice(code));
  }
};

}  // namespace motiongan::detail

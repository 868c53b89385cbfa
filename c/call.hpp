// What every call of the C interface does: arguments checked, exceptions turned into a status and a message.
#pragma once
#include <motiongan.h>

#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <utility>

#include "motiongan/core/error.hpp"

namespace motiongan::c {

/// An Error with a status of its own.
class CallError : public Error {
 public:
  template <class... Parts>
  explicit CallError(motiongan_status status, const Parts&... parts) : Error(parts...), status_(status) {}
  motiongan_status status() const { return status_; }

 private:
  motiongan_status status_;
};

template <class... Parts>
void require_argument(bool condition, const Parts&... parts) {
  if (!condition) throw CallError(MOTIONGAN_INVALID_ARGUMENT, parts...);
}

/// Throws CallError if the caller's pointer `name` is NULL.
inline void require_given(const void* pointer, const char* name) {
  require_argument(pointer != nullptr, name, " is NULL, expected an address");
}

/// Throws CallError unless the caller's array `name` has room for `needed` elements.
inline void require_room(const void* pointer, const char* name, std::size_t length, std::size_t needed) {
  if (length < needed)
    throw CallError(MOTIONGAN_BUFFER_TOO_SMALL, name, " has room for ", length, ", expected at least ",
                    needed);
  if (needed > 0) require_given(pointer, name);
}

/// The message of this thread's last failure, kept when there is no memory for it either.
class LastError {
 public:
  void set(const char* text) noexcept {
    try {
      text_ = text;
      fixed_ = nullptr;
    } catch (...) {
      fixed_ = "out of memory";
    }
  }
  const char* get() const noexcept { return fixed_ ? fixed_ : text_.c_str(); }

 private:
  std::string text_;
  const char* fixed_ = nullptr;
};

inline LastError& last_error() {
  thread_local LastError error;
  return error;
}

inline motiongan_status failed(motiongan_status status, const char* message) noexcept {
  last_error().set(message);
  return status;
}

/// Does the work of one call. Nothing that it throws gets past here.
template <class Work>
motiongan_status call(Work&& work) noexcept {
  try {
    std::forward<Work>(work)();
    return MOTIONGAN_OK;
  } catch (const CallError& error) {
    return failed(error.status(), error.what());
  } catch (const DeviceError& error) {
    return failed(MOTIONGAN_DEVICE_FAILED, error.what());
  } catch (const Error& error) {
    return failed(MOTIONGAN_FAILED, error.what());
  } catch (const std::filesystem::filesystem_error& error) {  // such as a name that is too long
    return failed(MOTIONGAN_FAILED, error.what());
  } catch (const std::bad_alloc&) {
    return failed(MOTIONGAN_OUT_OF_MEMORY, "out of memory");
  } catch (const std::exception& error) {
    return failed(MOTIONGAN_INTERNAL_ERROR, error.what());
  } catch (...) {
    return failed(MOTIONGAN_INTERNAL_ERROR, "an exception of unknown type");
  }
}

}  // namespace motiongan::c

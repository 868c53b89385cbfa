// Contexts of either precision, on devices that may have no double. Test cases that need it are in the suite
// "double": main() leaves them out where the device has none, and says so.
#pragma once
#include <cstdlib>
#include <motiongan/core/context.hpp>
#include <vector>

namespace motiongan::testing {

/// The device of a Context without options; a device of no name where there is none.
inline Device default_device() {
  const char* wish = std::getenv("MOTIONGAN_DEVICE");
  try {
    return choose_device(survey_devices(), wish ? wish : "");
  } catch (const Error&) {
    return {};
  }
}

/// Both precisions, or the one that the device has.
inline std::vector<Precision> precisions() {
  static const bool has_double = default_device().has_double;
  return has_double ? std::vector{Precision::f32, Precision::f64} : std::vector{Precision::f32};
}

/// A context shared by the tests of a program. Throws DeviceError if the device has no double, and it is
/// asked.
inline const Context& context_of(Precision precision) {
  if (precision == Precision::f32) {
    static const Context single({.precision = Precision::f32});
    return single;
  }
  static const Context twofold({.precision = Precision::f64});
  return twofold;
}

inline const Context& double_context() { return context_of(Precision::f64); }

}  // namespace motiongan::testing

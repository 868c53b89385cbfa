// Contexts of either precision, on devices that may have no double. Test cases that need it are in the suite
// "double": main() leaves them out where the device has none, and says so.
#pragma once
#include <cstdlib>
#include <motiongan/core/context.hpp>
#include <string>
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

/// Why nothing is tested in double: the device has none, or MOTIONGAN_TEST_SINGLE is set, as for a simulator
/// to which the precision makes no difference but time. Empty if it is tested.
inline const std::string& why_no_double() {
  static const std::string why = [] {
    if (std::getenv("MOTIONGAN_TEST_SINGLE")) return std::string("MOTIONGAN_TEST_SINGLE leaves out");
    const Device device = default_device();
    return device.name.empty() || device.has_double ? std::string() : device.name + " does not have";
  }();
  return why;
}

/// Both precisions, or the one that is tested.
inline std::vector<Precision> precisions() {
  return why_no_double().empty() ? std::vector{Precision::f32, Precision::f64} : std::vector{Precision::f32};
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

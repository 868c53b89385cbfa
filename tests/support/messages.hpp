// Error messages in tests.
#pragma once
#include <motiongan/core/error.hpp>
#include <string>

namespace motiongan::testing {

/// The message of the Error that `action` throws; "no error" if it throws none.
template <class Action>
std::string message_of(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

/// Whether `text` contains `part`.
inline bool says(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace motiongan::testing

// What errors say.
#pragma once
#include <motiongan/core/error.hpp>
#include <string>

namespace motiongan::testing {

/// What an action's Error says.
template <class Action>
std::string message_of(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

inline bool says(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace motiongan::testing

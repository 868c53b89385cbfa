// What a fuzz target is: a parser, and what must hold for everything that it reads.
#pragma once
#include <cstddef>
#include <functional>
#include <motiongan/core/error.hpp>
#include <random>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace motiongan::fuzz {

using Random = std::minstd_rand;

/// Changes bytes without knowing what they mean; libFuzzer's own mutations.
using ChangeBytes = std::function<std::string(std::string_view)>;

/// A parser under test. Each is defined in a file of its own, which has its name:
///     const Target bvh_target{"bvh", [](std::string_view bytes) { ... }};
/// Its seeds are in corpus/NAME, inputs that were once misread in regressions/NAME, and words of its format
/// in NAME.dict.
struct Target {
  /// Reads the input. motiongan::Error is the right answer to a bad one; any other exception is a finding.
  using Run = void (*)(std::string_view bytes);
  /// Changes an input so that it stays well-formed on the outside, to reach what lies behind.
  using Mutate = std::string (*)(std::string_view bytes, const ChangeBytes& change, Random& random);

  Target(const char* its_name, Run its_run, Mutate its_mutate = nullptr)
      : name(its_name), run(its_run), mutate(its_mutate) {
    all().push_back(this);
  }
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;

  /// All targets of the program, in no particular order.
  static std::vector<const Target*>& all() {
    static std::vector<const Target*> targets;
    return targets;
  }

  const char* name;
  Run run;
  Mutate mutate;  ///< null: bytes are changed blindly
};

/// Reads the input with the target; true if it was accepted, false if it was refused with an Error.
inline bool accepts(const Target& target, std::string_view bytes) {
  try {
    target.run(bytes);
    return true;
  } catch (const Error&) {
    return false;
  }
}

/// A property of the parser. Its violation is a finding.
inline void demand(bool holds, const std::string& what) {
  if (!holds) throw std::logic_error("violated: " + what);
}

/// The result of `action`, which must not throw Error: that would be a finding.
template <class Action>
auto must(const std::string& what, const Action& action) {
  try {
    return action();
  } catch (const Error& error) {
    throw std::logic_error("violated: " + what + ": " + error.what());
  }
}

/// A number from 0 to n - 1; n is at least 1.
inline std::size_t below(std::size_t n, Random& random) {
  return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
}

}  // namespace motiongan::fuzz

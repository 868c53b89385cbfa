// The main() of all test programs. Tests share contexts in static variables, with work that nobody waits for.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <cstdio>
#include <cstdlib>
#include <vector>

#include "support/precision.hpp"

int main(int argc, char** argv) {
  doctest::Context tests(argc, argv);
  if (const std::string& why = motiongan::testing::why_no_double(); !why.empty()) {
    tests.addFilter("test-suite-exclude", "double");
    std::printf("skipped: test cases that need double precision, which %s\n", why.c_str());
    std::fflush(stdout);
    // What doctest calls skipped has the cases of other files too.
    std::vector<const char*> arguments(argv, argv + argc);
    arguments.push_back("--list-test-cases");
    doctest::Context left_out(static_cast<int>(arguments.size()), arguments.data());
    left_out.addFilter("test-suite", "double");
    left_out.run();
  }
  const int result = tests.run();
  motiongan::finish_all_contexts();
  // A simulator may be gone before the contexts in static variables, and end the process with an error.
  std::fflush(nullptr);
  if (std::getenv("MOTIONGAN_TEST_SINGLE")) std::_Exit(result);
  return result;
}

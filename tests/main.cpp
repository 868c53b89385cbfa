// The main() of all test programs. Tests share contexts in static variables, with work that nobody waits for.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <cstdio>

#include "support/precision.hpp"

int main(int argc, char** argv) {
  doctest::Context tests(argc, argv);
  const motiongan::Device device = motiongan::testing::default_device();
  if (!device.name.empty() && !device.has_double) {
    tests.addFilter("test-suite-exclude", "double");
    std::printf("skipped: test cases that need double precision, which %s does not have\n",
                device.name.c_str());
  }
  const int result = tests.run();
  motiongan::finish_all_contexts();
  return result;
}

// The main() of all test programs. Tests share contexts in static variables, with work that nobody waits for.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <motiongan/core/context.hpp>

int main(int argc, char** argv) {
  const int result = doctest::Context(argc, argv).run();
  motiongan::finish_all_contexts();
  return result;
}

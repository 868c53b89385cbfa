// motiongan-golden FILE...: compares the models with files written by PyTorch; exits 1 if an error exceeds
// the tolerance.
#include <cstdio>

#include "compare.hpp"

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: motiongan-golden FILE.safetensors...\n");
    return 2;
  }
  bool passed = true;
  for (int i = 1; i < argc; ++i) {
    try {
      const motiongan::golden::Report r = motiongan::golden::compare(argv[i]);
      std::printf(
          "%s  %s %s: worst relative error %.2e (%s), %zu outputs and %zu gradients, tolerance %.0e: %s\n",
          argv[i], r.model.c_str(), r.dtype.c_str(), r.worst, r.worst_name.c_str(), r.outputs, r.gradients,
          r.tolerance, r.passed() ? "passed" : "FAILED");
      passed = passed && r.passed();
    } catch (const std::exception& error) {
      std::fprintf(stderr, "motiongan-golden: %s\n", error.what());
      passed = false;
    }
  }
  return passed ? 0 : 1;
}

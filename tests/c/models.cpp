// c_models FOLDER: writes the models with which programs in C and Python are tested.
#include "models.hpp"

#include <cstdio>

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: c_models FOLDER\n");
    return 2;
  }
  try {
    motiongan::testing::write_models({argv[1]});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "c_models: %s\n", error.what());
    return 1;
  }
}

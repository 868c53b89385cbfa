// The fuzz targets of the command over their seeds and regression inputs; cmake/Fuzz.cmake adds the targets.
#include "../replay.hpp"

TEST_CASE("the command reads or refuses every seed and regression input") { motiongan::fuzz::replay_all(); }

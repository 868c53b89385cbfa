// The fuzz targets of the library over their seeds and regression inputs; cmake/Fuzz.cmake adds the targets.
#include "replay.hpp"

namespace fuzz = motiongan::fuzz;

TEST_CASE("parsers read or refuse every seed and regression input") { fuzz::replay_all(); }

TEST_CASE("a violated property and an exception that is not an Error are findings") {
  CHECK(fuzz::accepts(fuzz::Target("good", [](std::string_view) {}), ""));
  CHECK_FALSE(fuzz::accepts(
      fuzz::Target("refusing", [](std::string_view) { motiongan::require(false, "bad input"); }), ""));
  CHECK_THROWS_AS(fuzz::accepts(fuzz::Target("bad",
                                             [](std::string_view) {
                                               fuzz::must("it reads back", [] { motiongan::require(false); });
                                             }),
                                ""),
                  std::logic_error);
  fuzz::Target::all().resize(fuzz::Target::all().size() - 3);
}

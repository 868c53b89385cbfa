// The version as the preprocessor sees it: its parts, its number and its text agree.
#include <doctest/doctest.h>

#include <motiongan/version.hpp>
#include <string>

namespace version_test {

#if MOTIONGAN_VERSION < MOTIONGAN_MAKE_VERSION(0, 1, 0)
#error "MOTIONGAN_VERSION cannot be compared"
#endif

static_assert(MOTIONGAN_MAKE_VERSION(1, 2, 3) == 10203);
static_assert(MOTIONGAN_MAKE_VERSION(0, 2, 0) > MOTIONGAN_MAKE_VERSION(0, 1, 99));
static_assert(MOTIONGAN_VERSION ==
              MOTIONGAN_VERSION_MAJOR * 10000 + MOTIONGAN_VERSION_MINOR * 100 + MOTIONGAN_VERSION_PATCH);

TEST_CASE("the text of the version is made of its parts") {
  std::string text;
  for (const int part : {MOTIONGAN_VERSION_MAJOR, MOTIONGAN_VERSION_MINOR, MOTIONGAN_VERSION_PATCH})
    text += (text.empty() ? "" : ".") + std::to_string(part);
  CHECK(text == MOTIONGAN_VERSION_STRING);
}

}  // namespace version_test

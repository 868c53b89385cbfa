// Reference values drawn with NumPy 1.24 for the same seeds.
#include <doctest/doctest.h>

#include <motiongan/experiments/numpy_random.hpp>
#include <vector>

#include "../support/messages.hpp"

namespace numpy_random_test {

using namespace motiongan;

namespace {

std::vector<std::int64_t> draw(NumpyRandom& random, std::int64_t low, std::int64_t high, std::size_t count) {
  std::vector<std::int64_t> out;
  for (std::size_t i = 0; i < count; ++i) out.push_back(random.randint(low, high));
  return out;
}

using Numbers = std::vector<std::int64_t>;

}  // namespace

TEST_CASE("the eight draws of the protocol, for two files of 1500 and 1400 frames") {
  NumpyRandom random(1234567890);
  Numbers found;
  for (int i = 0; i < 8; ++i) found.push_back(random.randint(16, (i % 2 == 0 ? 1500 : 1400) - 150));
  CHECK(found == Numbers{1087, 1180, 1329, 955, 1145, 332, 660, 304});
}

TEST_CASE("other seeds and ranges") {
  NumpyRandom a(42), b(0), c(4294967295), d(1234567890);
  CHECK(draw(a, 0, 10, 12) == Numbers{6, 3, 7, 4, 6, 9, 2, 6, 7, 4, 3, 7});
  CHECK(draw(b, -5, 1000003, 6) == Numbers{985767, 305706, 435824, 117947, 963390, 152310});
  CHECK(draw(c, 0, std::int64_t{1} << 32, 4) == Numbers{419326371, 479346978, 3918654476, 2416749639});
  CHECK(draw(c, 0, (std::int64_t{1} << 32) - 1, 2) == Numbers{3388880820, 2260532800});
  CHECK(draw(d, 0, 105, 8) == Numbers{2, 102, 47, 12, 51, 33, 43, 60});
}

TEST_CASE("a range wider than 32 bits takes two words per draw, a range of one value none") {
  NumpyRandom random(7);
  const std::int64_t far = std::int64_t{1} << 62;
  CHECK(draw(random, -far, far, 3) == Numbers{-3204046499487750972, 551904368352831990, 3475536756154880211});
  CHECK(random.randint(0, std::int64_t{1} << 33) == 6251689575);
  CHECK(random.randint(3, 4) == 3);
  CHECK(random.randint(0, 256) == 92);
  NumpyRandom fresh(7);
  CHECK(fresh.randint(3, 4) == 3);
  CHECK(fresh.randint(0, 256) == 175);
}

TEST_CASE("an empty range is refused") {
  NumpyRandom random(1);
  CHECK(testing::message_of([&] { random.randint(5, 5); }).find("randint(5, 5)") != std::string::npos);
  CHECK_THROWS_AS(random.randint(6, 5), Error);
}

}  // namespace numpy_random_test

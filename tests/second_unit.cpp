// One of two translation units that include the whole library; see second_unit_main.cpp.
#include <motiongan.hpp>

int joints_seen_from_the_second_unit(const motiongan::motion::Skeleton& skeleton) {
  return static_cast<int>(skeleton.size());
}

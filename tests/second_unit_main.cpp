// Links with second_unit.cpp: any function of the headers that is neither inline nor a template would be
// defined twice, and the two units must agree on what a type looks like.
#include <cstdio>
#include <motiongan.hpp>

int joints_seen_from_the_second_unit(const motiongan::motion::Skeleton& skeleton);

int main() {
  motiongan::motion::Skeleton skeleton;
  skeleton.joints.resize(3);
  const int joints = joints_seen_from_the_second_unit(skeleton);
  std::printf("two units of one program see %d of 3 joints\n", joints);
  return joints == 3 ? 0 : 1;
}

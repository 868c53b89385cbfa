// Compiled against an install tree: headers and embedded kernels must all have been installed.
#include <cstdio>
#include <cstring>
#include <motiongan.hpp>
#include <motiongan/generated/kernels.hpp>
#include <string_view>

int main() {
  motiongan::motion::Skeleton skeleton;
  skeleton.joints.resize(2);
  try {  // needs zlib at link time
    motiongan::motion::parse_amass("", "empty");
    return 1;
  } catch (const motiongan::Error&) {
  }
  static_assert(std::string_view(FOUND_VERSION) == MOTIONGAN_VERSION_STRING);
  const std::size_t kernel_bytes = std::strlen(motiongan::kernels::prelude);
  std::printf("consumer: %zu joints, %zu bytes of prelude.cl\n", skeleton.size(), kernel_bytes);
  return skeleton.size() == 2 && kernel_bytes > 0 ? 0 : 1;
}

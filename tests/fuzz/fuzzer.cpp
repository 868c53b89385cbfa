// The entry points that libFuzzer calls, for the one target that is linked with them.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "target.hpp"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace motiongan::fuzz {
namespace {

std::string change_bytes(std::string_view bytes) {
  std::string out(bytes);
  out.resize(bytes.size() + std::max<std::size_t>(bytes.size() / 2, 16));
  out.resize(LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(out.data()), bytes.size(), out.size()));
  return out;
}

}  // namespace
}  // namespace motiongan::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace motiongan::fuzz;
  accepts(*Target::all().at(0), {reinterpret_cast<const char*>(data), size});
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most,
                                               unsigned seed) {
  using namespace motiongan::fuzz;
  const Target& target = *Target::all().at(0);
  if (target.mutate == nullptr) return LLVMFuzzerMutate(data, size, most);
  Random random(seed);
  const std::string out = target.mutate({reinterpret_cast<const char*>(data), size}, change_bytes, random);
  if (out.empty() || out.size() > most) return LLVMFuzzerMutate(data, size, most);
  std::memcpy(data, out.data(), out.size());
  return out.size();
}

// A global context may still have work in its queue when main() ends, with kernels to build: after
// finish_all_contexts(), which the tests' main() calls, the program ends without a crash.
#include <doctest/doctest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <motiongan/ops/elementwise.hpp>
#include <motiongan/ops/reduce.hpp>
#include <string>

namespace exit_test {

using namespace motiongan;

namespace {

const std::filesystem::path cache =
    std::filesystem::temp_directory_path() / ("motiongan-exit-test-" + std::to_string(::getpid()));

const Context& global_context() {
  static const Context context;
  return context;
}

}  // namespace

TEST_CASE("work that nobody waits for") {
  std::filesystem::create_directories(cache);
  REQUIRE(setenv("POCL_CACHE_DIR", cache.c_str(), 1) == 0);
  std::atexit([] {  // registered before the context: runs after its queue is finished
    std::error_code ignored;
    std::filesystem::remove_all(cache, ignored);
  });
  const Var x = Var::leaf(Tensor::from(global_context(), {4, 3}, std::vector<float>(12, 2)));
  for (int i = 0; i < 3; ++i) sum(tanh(x) * x + affine(x, 2));
  CHECK(global_context().statistics().launches > 6);
}

}  // namespace exit_test

// How long ranks take to add up the gradients of a step. Run by mpirun:
//   mpirun -n 2 bench_ranks [VALUES=1060000]
// VALUES is the number of parameters, four bytes each. In any order is what a training without --shards does,
// in one order what it does with them.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <motiongan/distributed/mpi.hpp>

using namespace motiongan;

namespace {

template <class Work>
double median_ms(const Work& work) {
  std::vector<double> times;
  for (int i = 0; i < 30; ++i) {
    const auto start = std::chrono::steady_clock::now();
    work();
    times.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  }
  std::sort(times.begin(), times.end());
  return times[times.size() / 2];
}

}  // namespace

int main(int count, char** arguments) {
  try {
    const std::size_t values = count > 1 ? std::strtoul(arguments[1], nullptr, 10) : 1'060'000;
    MpiRanks ranks;
    std::vector<float> numbers(values, 1);
    float flag = 0;
    const double any = median_ms([&] { ranks.all_reduce(numbers); }),
                 tree = (ranks.size() & (ranks.size() - 1)) == 0
                            ? median_ms([&] { all_reduce_in_order(ranks, numbers); })
                            : 0,
                 small = median_ms([&] { ranks.all_reduce(std::span(&flag, 1)); });
    if (ranks.rank() == 0)
      std::printf("%zu ranks, %.1f MB: %.2f ms in any order, %.2f ms in one order; one value %.3f ms\n",
                  ranks.size(), 4e-6 * static_cast<double>(values), any, tree, small);
  } catch (const Error& error) {
    std::fprintf(stderr, "bench_ranks: %s\n", error.what());
    return 1;
  }
  return 0;
}

// Speed of gemm() compared with the device's measured peak, and with OpenBLAS if the build found it.
//   bench_gemm [--json] [NAME...]     a table, or one JSON object per line; NAMEs select shapes
// Calls are queued without waiting, as in training; a result is the best of all samples taken in at least
// 0.4 s. OpenBLAS runs first and in a separate process, because its threads keep spinning after a call and
// would slow ours.
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <motiongan/core/gemm.hpp>
#include <vector>

#include "peak.hpp"
#ifdef MOTIONGAN_HAVE_OPENBLAS
#include <cblas.h>
#endif

using namespace motiongan;

namespace {

struct Shape3 {
  const char* name;  ///< m x n x k
  std::size_t m, n, k;
  bool a_transposed = false, b_transposed = false;
  std::size_t taps = 1;  ///< products that are summed: GemmCall::segments
  double flops() const { return 2.0 * static_cast<double>(m * n * k * taps); }
};

// _bt: B is stored [n, k], as PyTorch's weights are: the forward pass of Linear, LSTM and Conv1d (3 taps).
constexpr Shape3 shapes[] = {{"4096x256x256", 4096, 256, 256},
                             {"256x256x4096", 256, 256, 4096, true},
                             {"64x1024x512", 64, 1024, 512},
                             {"64x256x256", 64, 256, 256},
                             {"8x1024x512", 8, 1024, 512},
                             {"1x1024x512", 1, 1024, 512},
                             {"93x256x4096", 93, 256, 4096, true},
                             {"4096x93x256", 4096, 93, 256},
                             {"1000x77x53", 1000, 77, 53},
                             {"4096x256x256_bt", 4096, 256, 256, false, true},
                             {"2048x256x256_taps3", 2048, 256, 256, false, false, 3},
                             {"2048x256x256_taps3_bt", 2048, 256, 256, false, true, 3},
                             {"64x1024x512_bt", 64, 1024, 512, false, true},
                             {"64x1024x256_bt", 64, 1024, 256, false, true},
                             {"64x256x256_bt", 64, 256, 256, false, true},
                             {"8x1024x512_bt", 8, 1024, 512, false, true},
                             {"1x1024x512_bt", 1, 1024, 512, false, true},
                             {"1x1024x256_bt", 1, 1024, 256, false, true}};

std::vector<float> operand(std::size_t n, unsigned seed) {
  std::vector<float> values(n);
  for (float& v : values) {
    seed = seed * 1664525u + 1013904223u;
    v = static_cast<float>(seed >> 8) / 16777216.0f - 0.5f;
  }
  return values;
}

/// The best GFLOP/s of `many(n)`, which runs n products and waits for them.
template <class Many>
double best_rate(double flops, const Many& many) {
  many(1);
  std::size_t count = 1;
  double took = 0;
  while (true) {  // double the count until a sample takes more than a millisecond
    const double start = bench::seconds();
    many(count);
    took = bench::seconds() - start;
    if (took > 1e-3) break;
    count *= 2;
  }
  double best = took / static_cast<double>(count);
  const double begin = bench::seconds();
  for (int samples = 0; samples < 12 || bench::seconds() - begin < 0.4; ++samples) {
    const double start = bench::seconds();
    many(count);
    best = std::min(best, (bench::seconds() - start) / static_cast<double>(count));
  }
  return flops / best / 1e9;
}

bool chosen(const Shape3& shape, const std::vector<std::string>& names) {
  if (names.empty()) return true;
  return std::find(names.begin(), names.end(), shape.name) != names.end();
}

double ours(const Context& context, const Shape3& s) {
  GemmCall g;
  g.m = s.m, g.n = s.n, g.k = s.k, g.a_transposed = s.a_transposed, g.b_transposed = s.b_transposed;
  g.a = Tensor::from(context, {s.taps * s.m * s.k}, operand(s.taps * s.m * s.k, 1));
  g.b = Tensor::from(context, {s.taps * s.k * s.n}, operand(s.taps * s.k * s.n, 2));
  g.c = Tensor(context, {s.m * s.n});
  g.a_ld = s.a_transposed ? s.m : s.k, g.b_ld = s.b_transposed ? s.k : s.n, g.c_ld = s.n;
  g.segments = s.taps;
  for (std::size_t t = 0; t < s.taps; ++t) g.a_offset[t] = t * s.m * s.k, g.b_offset[t] = t * s.k * s.n;
  return best_rate(s.flops(), [&](std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) gemm(context, g);
    context.finish();
  });
}

#ifdef MOTIONGAN_HAVE_OPENBLAS
void openblas(const std::vector<std::string>& names) {
  for (const Shape3& s : shapes) {
    if (!chosen(s, names)) continue;
    const auto a = operand(s.taps * s.m * s.k, 1), b = operand(s.taps * s.k * s.n, 2);
    std::vector<float> c(s.m * s.n);
    const auto size = [](std::size_t n) { return static_cast<int>(n); };
    const double rate = best_rate(s.flops(), [&](std::size_t n) {
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t t = 0; t < s.taps; ++t)
          cblas_sgemm(CblasRowMajor, s.a_transposed ? CblasTrans : CblasNoTrans,
                      s.b_transposed ? CblasTrans : CblasNoTrans, size(s.m), size(s.n), size(s.k), 1,
                      a.data() + t * s.m * s.k, size(s.a_transposed ? s.m : s.k), b.data() + t * s.k * s.n,
                      size(s.b_transposed ? s.k : s.n), t == 0 ? 0.0f : 1.0f, c.data(), size(s.n));
    });
    std::printf("%s %.17g\n", s.name, rate);
  }
}
#endif

/// OpenBLAS's GFLOP/s by shape, measured in a child process; empty if it is not compiled in.
std::map<std::string, double> openblas_rates([[maybe_unused]] const std::vector<std::string>& names) {
  std::map<std::string, double> rates;
#ifdef MOTIONGAN_HAVE_OPENBLAS
  int ends[2];
  require(pipe(ends) == 0, "pipe() failed: ", std::strerror(errno));
  const pid_t child = fork();
  require(child >= 0, "fork() failed: ", std::strerror(errno));
  if (child == 0) {
    dup2(ends[1], STDOUT_FILENO);
    close(ends[0]);
#ifdef __x86_64__
    // An OpenBLAS older than the processor takes kernels of 256 bits.
    if (__builtin_cpu_supports("avx512f")) setenv("OPENBLAS_CORETYPE", "SkylakeX", 0);
#endif
    std::vector<char*> arguments;
    std::vector<std::string> texts{"bench_gemm", "--openblas"};
    texts.insert(texts.end(), names.begin(), names.end());
    for (std::string& text : texts) arguments.push_back(text.data());
    arguments.push_back(nullptr);
    execv("/proc/self/exe", arguments.data());
    _exit(127);
  }
  close(ends[1]);
  std::FILE* from = fdopen(ends[0], "r");
  char name[64];
  double rate = 0;
  while (std::fscanf(from, "%63s %lf", name, &rate) == 2) rates[name] = rate;
  std::fclose(from);
  int status = 0;
  waitpid(child, &status, 0);
  require(status == 0, "the child process that times OpenBLAS ended with status ", status);
#else
  std::fprintf(stderr,
               "OpenBLAS is not compiled in (on Debian: apt-get install libopenblas-dev, then configure "
               "again): its results are null\n");
#endif
  return rates;
}

void print(bool json, const Shape3& shape, double rate, double peak, const double* openblas_rate) {
  if (json) {
    std::printf("{\"name\":\"gemm_%s\",\"gflops\":%.2f,\"peak_gflops\":%.2f,\"share_of_peak\":%.3f,",
                shape.name, rate, peak, rate / peak);
    if (openblas_rate)
      std::printf("\"openblas_gflops\":%.2f,\"ratio_openblas\":%.3f}\n", *openblas_rate,
                  rate / *openblas_rate);
    else
      std::printf("\"openblas_gflops\":null,\"ratio_openblas\":null}\n");
  } else {
    std::printf("%-22s %9.1f %8.1f %6.0f%%", shape.name, rate, peak, 100 * rate / peak);
    if (openblas_rate) std::printf(" %9.1f %6.2fx", *openblas_rate, rate / *openblas_rate);
    std::printf("\n");
  }
}

int run(const std::vector<std::string>& arguments) {
  bool json = false;
  std::vector<std::string> names;
  for (const std::string& argument : arguments) {
    if (argument == "--json") json = true;
#ifdef MOTIONGAN_HAVE_OPENBLAS
    else if (argument == "--openblas")
      return openblas({arguments.begin() + 1, arguments.end()}), 0;
#endif
    else if (std::any_of(std::begin(shapes), std::end(shapes),
                         [&](const Shape3& s) { return argument == s.name; }))
      names.push_back(argument);
    else
      throw Error("unknown argument \"", argument, "\", expected --json or a shape such as ", shapes[0].name);
  }
  const std::map<std::string, double> peer = openblas_rates(names);
  const Context context;
  std::fprintf(stderr, "device: %s\n", context.description().c_str());
  bench::Peak peak(context);
  peak.measure();
  std::vector<double> rates;
  for (const Shape3& shape : shapes) {
    if (!chosen(shape, names)) continue;
    rates.push_back(ours(context, shape));
    peak.measure();
  }
  const double ceiling = peak.measure();  // the best of all measurements so far
  if (!json)
    std::printf("%-22s %9s %8s %7s %9s %7s\n", "m x n x k", "GFLOP/s", "peak", "of peak", "OpenBLAS",
                "ratio");
  std::size_t next = 0;
  for (const Shape3& shape : shapes) {
    if (!chosen(shape, names)) continue;
    const auto found = peer.find(shape.name);
    print(json, shape, rates[next++], ceiling, found == peer.end() ? nullptr : &found->second);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run({argv + 1, argv + argc});
  } catch (const Error& error) {
    std::fprintf(stderr, "bench_gemm: %s\n", error.what());
    return 1;
  }
}

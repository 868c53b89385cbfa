// Generative search over 10,000 clips: 16 hypotheses of 32 frames, 69 dof, of which three (x, z and yaw) are
// recomputed relative to the overlap at each of the 33 shifts.
//   bench_search [--json] [--seconds 4] [--peer none|benchmarks/ranker_peer.py [--python PYTHON]...]
//                [--model MODEL --collection DIR [--command motiongan]]
// Poses are generated in memory; no file is read. The reference is the same search as plain C++ loops over
// windows, hypotheses and dimensions (-O3, single precision, two threads), on fewer windows. With --model and
// --collection the command itself is timed: the first query, which builds the index of the collection's
// files, and later ones. Also times a ranker's training step, compared with PyTorch by --peer
// benchmarks/ranker_peer.py.
#include <cstdlib>
#include <filesystem>
#include <motiongan/search/windows.hpp>
#include <random>
#include <thread>

#include "ranker_steps.hpp"
#ifdef MOTIONGAN_HAVE_OPENBLAS
#include <cblas.h>
#endif

using namespace motiongan;

namespace {

constexpr std::size_t clips = 10'000, frames = 32, dof = 69, hypotheses = 16;

/// A format with 69 dof: a root with position and heading, and 21 more joints. The poses themselves are
/// random.
motion::MotionFormat make_format() {
  motion::Skeleton skeleton;
  for (std::size_t j = 0; j < 22; ++j)
    skeleton.joints.push_back({"joint" + std::to_string(j), static_cast<int>(j) - 1, {0, 1, 0}, {}, {}});
  motion::MotionFormat format;
  format.layout = motion::PoseLayout(skeleton, true, 0, motion::RootRotation::heading);
  format.normalizer = motion::Normalizer(std::vector<double>(dof, 0.0), std::vector<double>(dof, 1.0));
  format.rate = 12.5;
  format.frames = frames;
  format.relative_dims = {1, 66, 68};  // yaw, x, z
  format.check();
  return format;
}

std::vector<float> numbers(std::size_t count, unsigned seed) {
  std::mt19937 generator(seed);
  std::vector<float> out(count);
  for (float& value : out) value = static_cast<float>(generator() >> 8) / 8388608.0f - 1;
  return out;
}

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC push_options
#pragma GCC optimize("O3")
#endif
/// The reference: for each window and hypothesis the distances of all pairs of frames that any shift aligns,
/// then their sum for each shift. Squared differences, so that no precision is lost. The root is relative to
/// the window's first frame only; the search recomputes it at every shift, which would cost more here.
float plain_search(const std::vector<float>& poses, std::size_t first, std::size_t last,
                   const std::vector<std::vector<float>>& made) {
  float total = 0;
  constexpr int reach = frames / 2;
  for (std::size_t w = first; w < last; ++w)
    for (const std::vector<float>& hypothesis : made) {
      float sums[2 * reach + 1] = {};
      for (int t = 0; t < static_cast<int>(frames); ++t)
        for (int u = std::max(0, t - reach); u <= std::min(static_cast<int>(frames) - 1, t + reach); ++u) {
          const float* const a = &poses[(w * frames + static_cast<std::size_t>(t)) * dof];
          const float* const b = &hypothesis[static_cast<std::size_t>(u) * dof];
          float lanes[16] = {};
          std::size_t k = 0;
          for (; k + 16 <= dof; k += 16)
            for (std::size_t l = 0; l < 16; ++l) lanes[l] += (a[k + l] - b[k + l]) * (a[k + l] - b[k + l]);
          float sum = 0;
          for (; k < dof; ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
          for (const float lane : lanes) sum += lane;
          sums[t - u + reach] += sum;
        }
      float best = std::numeric_limits<float>::infinity();
      for (int s = -reach; s <= reach; ++s)
        best = std::min(best,
                        sums[s + reach] / static_cast<float>((static_cast<int>(frames) - std::abs(s)) * 69));
      total += best;
    }
  return total;
}
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC pop_options
#endif

/// Milliseconds of the loops for all clips, extrapolated from 1/100 of them.
double peer_ms(const std::vector<float>& poses, const std::vector<std::vector<float>>& made) {
  constexpr std::size_t share = 100;
  double best = std::numeric_limits<double>::infinity();
  volatile float sink = 0;
  for (int i = 0; i < 3; ++i) {
    const double start = bench::seconds();
    {
      std::thread second([&] { sink = sink + plain_search(poses, 0, clips / share / 2, made); });
      const float mine = plain_search(poses, clips / share / 2, clips / share, made);
      second.join();
      sink = sink + mine;
    }
    best = std::min(best, bench::seconds() - start);
  }
  return 1e3 * best * share;
}

#ifdef MOTIONGAN_HAVE_OPENBLAS
/// Milliseconds of OpenBLAS for the products of all frames of the clips with all frames of the hypotheses, in
/// blocks that fit the caches, and nothing else: a lower bound for a search without spectra.
double openblas_ms(const std::vector<float>& poses, const std::vector<std::vector<float>>& made) {
  constexpr std::size_t rows = 2000, columns = hypotheses * frames;
  std::vector<float> all, products(rows * columns);
  for (const std::vector<float>& one : made) all.insert(all.end(), one.begin(), one.end());
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 5; ++i) {
    const double start = bench::seconds();
    for (std::size_t row = 0; row < clips * frames; row += rows)
      cblas_sgemm(CblasRowMajor, CblasNoTrans, CblasTrans, static_cast<int>(rows), static_cast<int>(columns),
                  static_cast<int>(dof), 1, &poses[row * dof], static_cast<int>(dof), all.data(),
                  static_cast<int>(dof), 0, products.data(), static_cast<int>(columns));
    best = std::min(best, bench::seconds() - start);
  }
  return 1e3 * best;
}
#endif

/// Wall-clock milliseconds of the command.
double command_ms(const std::string& line) {
  const double start = bench::seconds();
  require(std::system(line.c_str()) == 0, "this command failed: ", line);
  return 1e3 * (bench::seconds() - start);
}

struct Options {
  bool json = false, peer = true;
  std::string torch;  // a script that times PyTorch's rankers
  std::vector<std::string> pythons;
  double seconds = 4;
  std::string model, collection, command = "motiongan";
};

int run(const Options& options) {
  const Context context;
  bench::Peak peak(context);
  peak.measure();
  const motion::MotionFormat format = make_format();
  const std::vector<float> poses = numbers(clips * frames * dof, 1);
  SearchFrames all;
  all.add(SearchLayout(format), poses);
  std::vector<std::size_t> starts;
  for (std::size_t c = 0; c < clips; ++c) starts.push_back(c * frames);
  std::vector<std::vector<float>> made;
  for (unsigned h = 0; h < hypotheses; ++h) {
    made.push_back(numbers(frames * dof, 100 + h));
    format.make_relative(std::span<float>(made.back()));
  }
  const SearchWindows kept(context, format, all, starts),
      once(context, format, all, starts, {.keep_bytes = 0});
  std::vector<bench::Measured> lines{
      bench::measure(context, "search_10000_query", options.seconds, [&] { kept(made); }),
      bench::measure(context, "search_10000_load_and_query", options.seconds, [&] { once(made); })};
  // In addition to the products of spectra, which gemm counts: two sums over frequencies per shift and
  // hypothesis (one multiply-add each for the real and the imaginary part), five multiply-adds per
  // overlapping frame for the root; and the spectra of the windows where these are loaded.
  constexpr std::size_t half = frames / 2, spectrum = (frames + half) / 2 + 1;
  constexpr double n = frames, reach = half, frequencies = spectrum;
  const double nearest =
      2.0 * clips * hypotheses *
      ((reach + 1) * frequencies * 2 + 5 * (n + 2 * (n * reach - reach * (reach + 1) / 2)));
  for (bench::Measured& line : lines) line.gflop += nearest / 1e9;
  lines[1].gflop += 2.0 * clips * (dof - 3) * frequencies * 2 * n / 1e9;
  const double pairs = n * n - (n - reach) * (n - reach - 1);  // pairs of frames, at shifts up to `reach`
  for (bench::Measured& line : lines) {
    line.extra["queries_per_second"] = 1e3 / line.ms;
    line.extra["gflop_of_all_pairs"] = 2.0 * clips * hypotheses * pairs * dof / 1e9;
  }
  lines[0].extra["spectra_mb"] = static_cast<double>(kept.kept_bytes()) / 1e6;
  if (options.peer) {
    const double ms = peer_ms(poses, made);
    for (bench::Measured& line : lines) {
      line.extra["loops_ms"] = ms;
      line.extra["ratio_loops"] = ms / line.ms;
    }
#ifdef MOTIONGAN_HAVE_OPENBLAS
    const double products = openblas_ms(poses, made);  // last, because its threads keep spinning
    for (bench::Measured& line : lines) {
      line.extra["openblas_all_pairs_ms"] = products;
      line.extra["ratio_openblas"] = products / line.ms;
    }
#endif
  }
  if (!options.model.empty()) {
    const std::string index = (std::filesystem::temp_directory_path() / "bench_search.safetensors").string();
    std::filesystem::remove(index);
    const std::string line = "'" + options.command + "' search --model '" + options.model +
                             "' --collection '" + options.collection + "' --text walk --index '" + index +
                             "' > /dev/null 2>&1";
    bench::Measured first{"search_command_first", command_ms(line), 0};
    bench::Measured later{"search_command_later", std::numeric_limits<double>::infinity(), 0};
    for (int i = 0; i < 5; ++i) later.ms = std::min(later.ms, command_ms(line));
    first.extra["includes"] = "reading all files, writing the index";
    later.extra["includes"] = "start, model, index, hypotheses, distances, ranking; best of five";
    std::filesystem::remove(index);
    lines.push_back(first), lines.push_back(later);
  }
  for (bench::Measured& line : bench::ranker_steps(context, options.seconds))
    lines.push_back(std::move(line));
  const double ceiling = peak.measure();
  if (!options.torch.empty()) {
    for (const bench::Python& python : bench::find_pythons(options.pythons)) {
      const auto theirs = bench::peer_times(python, options.torch, "ranker");
      for (bench::Measured& line : lines)
        if (const auto found = theirs.find(line.name); found != theirs.end()) {
          line.extra["torch_ms"][python.torch] = found->second;
          const double ratio = found->second / line.ms;
          line.extra["ratio_torch"] = std::min(ratio, line.extra.value("ratio_torch", ratio));
        }
    }
  }
  for (const bench::Measured& line : lines) {
    const double gflops = line.gflop / line.ms * 1e3;
    nlohmann::ordered_json json{{"name", line.name}, {"ms", line.ms}};
    if (line.gflop > 0) {
      json["gflop"] = line.gflop, json["gflops"] = gflops;
      json["peak_gflops"] = ceiling, json["share_of_peak"] = gflops / ceiling;
    }
    json.update(line.extra);
    if (options.json) {
      std::printf("%s\n", json.dump().c_str());
      continue;
    }
    std::printf("%-30s %8.1f ms\n", line.name.c_str(), line.ms);
    for (const auto& [key, value] : json.items())
      if (key != "name" && key != "ms") std::printf("%30s %s\n", key.c_str(), value.dump().c_str());
  }
  return 0;
}

Options read_options(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    if (name == "--json") {
      options.json = true;
      continue;
    }
    require(i + 1 < argc, "unknown argument ", name,
            "; usage: bench_search [--json] [--seconds 4] [--peer none|ranker_peer.py [--python PYTHON]...] "
            "[--model MODEL --collection DIR [--command motiongan]]");
    const std::string value = argv[++i];
    if (name == "--seconds")
      options.seconds = std::atof(value.c_str());
    else if (name == "--peer")
      options.peer = value != "none", options.torch = options.peer ? value : "";
    else if (name == "--python")
      options.pythons.push_back(value);
    else if (name == "--model")
      options.model = value;
    else if (name == "--collection")
      options.collection = value;
    else if (name == "--command")
      options.command = value;
    else
      throw Error("unknown argument ", name);
  }
  require(options.model.empty() == options.collection.empty(),
          "only one of --model and --collection was given, expected both");
  return options;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(read_options(argc, argv));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_search: %s\n", error.what());
    return 1;
  }
}

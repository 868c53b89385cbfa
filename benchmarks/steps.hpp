// Timing of training and sampling steps, compared with PyTorch: measuring in rounds, printing.
#pragma once
#include <algorithm>
#include <cstdio>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "peak.hpp"
#include "peer.hpp"

namespace motiongan::bench {

/// One measurement; `extra` is added to its line unchanged. launches and bytes: see ContextStatistics.
struct Measured {
  std::string name;
  double ms = 0, gflop = 0, launches = 0, bytes = 0;
  nlohmann::ordered_json extra = nlohmann::ordered_json::object();
};

/// The median time of a step, including waiting for the device, and what it counts. With 0 seconds the step
/// runs as few times as give any.
template <class Step>
Measured measure(const Context& context, std::string name, double seconds, Step step) {
  for (int i = 0; i < (seconds > 0 ? 3 : 1); ++i) step();
  context.finish();
  const ContextStatistics before = context.statistics();
  step();
  context.finish();
  const ContextStatistics& now = context.statistics();
  const double flops = now.gemm_flops - before.gemm_flops, bytes = now.bytes_touched - before.bytes_touched,
               launches = static_cast<double>(now.launches - before.launches);
  std::vector<double> times;
  const std::size_t least = seconds > 0 ? 5 : 1;
  for (const double start = bench::seconds(); times.size() < least || bench::seconds() - start < seconds;) {
    const double t = bench::seconds();
    step();
    context.finish();
    times.push_back(bench::seconds() - t);
  }
  std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
  return {std::move(name), 1e3 * times[times.size() / 2], flops / 1e9, launches, bytes};
}

/// The times of one measurement in all rounds, ours and those of each PyTorch.
struct Rounds {
  Measured first;
  std::vector<double> ours;
  std::map<std::string, std::vector<double>> torch;  // by version
};

inline double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 == 1 ? values[n / 2] : (values[n / 2 - 1] + values[n / 2]) / 2;
}

/// The line of one measurement: medians over the rounds, our spread, and the ratio to the faster PyTorch.
inline nlohmann::ordered_json line_of(const Rounds& rounds, double peak_gflops) {
  const double ms = median(rounds.ours), gflops = rounds.first.gflop / ms * 1e3;
  const auto [least, most] = std::minmax_element(rounds.ours.begin(), rounds.ours.end());
  nlohmann::ordered_json line{{"name", rounds.first.name},
                              {"ms", ms},
                              {"ms_least", *least},
                              {"ms_most", *most},
                              {"rounds", rounds.ours.size()},
                              {"gflop", rounds.first.gflop},
                              {"gflops", gflops},
                              {"peak_gflops", peak_gflops},
                              {"share_of_peak", gflops / peak_gflops}};
  double best = 0;
  for (const auto& [version, times] : rounds.torch) {
    const double theirs = median(times);
    line["torch_ms"][version] = theirs;
    best = best == 0 ? theirs : std::min(best, theirs);
  }
  if (best > 0) line["ratio_torch"] = best / ms;
  line.update(rounds.first.extra);
  return line;
}

inline void print_line(const nlohmann::ordered_json& line, const nlohmann::ordered_json& extra) {
  std::printf("%-34s %8.1f ms (%.1f-%.1f)  %6.1f GFLOP  %5.0f GFLOP/s  %3.0f%% of peak",
              line.at("name").get<std::string>().c_str(), line.at("ms").get<double>(),
              line.at("ms_least").get<double>(), line.at("ms_most").get<double>(),
              line.at("gflop").get<double>(), line.at("gflops").get<double>(),
              100 * line.at("share_of_peak").get<double>());
  if (line.contains("torch_ms"))
    for (const auto& [version, ms] : line.at("torch_ms").items())
      std::printf("  PyTorch %s %.1f ms", version.c_str(), ms.get<double>());
  if (line.contains("ratio_torch")) std::printf("  %.2fx", line.at("ratio_torch").get<double>());
  std::printf("\n");
  for (const auto& [key, value] : extra.items()) std::printf("%34s %s\n", key.c_str(), value.dump().c_str());
}

struct Arguments {
  bool json = false;
  double seconds = 4;
  std::size_t rounds = 0;
  std::string peer;
  std::vector<std::string> pythons;
};

/// Throws Error, with the usage, for unknown arguments.
inline Arguments parse(const char* program, int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    const bool has_value = i + 1 < argc;
    if (name == "--json")
      arguments.json = true;
    else if (name == "--peer" && has_value)
      arguments.peer = argv[++i];
    else if (name == "--python" && has_value)
      arguments.pythons.emplace_back(argv[++i]);
    else if (name == "--seconds" && has_value)
      arguments.seconds = std::atof(argv[++i]);
    else if (name == "--rounds" && has_value)
      arguments.rounds = static_cast<std::size_t>(std::max(1, std::atoi(argv[++i])));
    else
      throw Error("unknown argument ", name, "; usage: ", program,
                  " [--json] [--peer torch_peer.py [--python PYTHON]...] [--seconds 4] [--rounds 5]");
  }
  if (arguments.rounds == 0) arguments.rounds = arguments.peer.empty() ? 1 : 5;
  return arguments;
}

/// Parses the arguments, measures and prints; `models` is passed to the peer. With a peer, ours and theirs
/// are measured in turn, round after round, so that a slow minute of the machine meets both.
inline int run(const char* program, const std::string& models,
               const std::function<std::vector<Measured>(const Context&, double seconds)>& measure_all,
               int argc, char** argv) {
  const Arguments arguments = parse(program, argc, argv);
  std::vector<Python> pythons;
  if (!arguments.peer.empty()) pythons = find_pythons(arguments.pythons);
  for (const Python& python : pythons)
    std::fprintf(stderr, "%s: comparing with PyTorch %s of %s\n", program, python.torch.c_str(),
                 python.program.c_str());
  double peak_gflops = 0;
  std::vector<Rounds> all;
  for (std::size_t round = 0; round < arguments.rounds; ++round) {
    {
      const Context context;
      Peak peak(context);
      const std::vector<Measured> ours =
          measure_all(context, arguments.seconds / static_cast<double>(arguments.rounds));
      peak_gflops = std::max(peak_gflops, peak.measure());
      all.resize(ours.size());
      for (std::size_t i = 0; i < ours.size(); ++i) {
        if (round == 0) all[i].first = ours[i];
        all[i].ours.push_back(ours[i].ms);
      }
    }
    for (const Python& python : pythons)
      for (const auto& [name, ms] : peer_times(python, arguments.peer, models))
        for (Rounds& rounds : all)
          if (rounds.first.name == name) rounds.torch[python.torch].push_back(ms);
  }
  for (const Rounds& rounds : all) {
    const nlohmann::ordered_json line = line_of(rounds, peak_gflops);
    if (arguments.json)
      std::printf("%s\n", line.dump().c_str());
    else
      print_line(line, rounds.first.extra);
  }
  return 0;
}

/// The main() of a benchmark.
inline int main(const char* program, const std::string& models,
                const std::function<std::vector<Measured>(const Context&, double seconds)>& measure_all,
                int argc, char** argv) {
  try {
    return run(program, models, measure_all, argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", program, error.what());
    return 1;
  }
}

}  // namespace motiongan::bench

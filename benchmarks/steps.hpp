// Timing of training and sampling steps, compared with PyTorch: measuring, running the peer script, printing.
#pragma once
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "peak.hpp"

namespace motiongan::bench {

/// One measurement; `extra` is added to its line unchanged.
struct Measured {
  std::string name;
  double ms = 0, gflop = 0;
  nlohmann::ordered_json extra = nlohmann::ordered_json::object();
};

/// The median time of a step, including waiting for the device, and the GFLOP of its matrix products.
template <class Step>
Measured measure(const Context& context, std::string name, double seconds, Step step) {
  for (int i = 0; i < 3; ++i) step();
  context.finish();
  const double before = context.statistics().gemm_flops;
  step();
  context.finish();
  const double flops = context.statistics().gemm_flops - before;
  std::vector<double> times;
  for (const double start = bench::seconds(); times.size() < 7 || bench::seconds() - start < seconds;) {
    const double t = bench::seconds();
    step();
    context.finish();
    times.push_back(bench::seconds() - t);
  }
  std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
  return {std::move(name), 1e3 * times[times.size() / 2], flops / 1e9};
}

/// The peer's milliseconds by name; empty if it could not be run.
inline std::map<std::string, double> peer_times(const std::string& script, const std::string& models,
                                                std::string& version) {
  std::map<std::string, double> times;
  const std::string command = "/usr/bin/python3 '" + script + "' speed --models " + models;
  FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) return times;
  std::array<char, 4096> line{};
  while (std::fgets(line.data(), static_cast<int>(line.size()), pipe)) {
    const auto json = nlohmann::json::parse(line.data(), nullptr, false);
    if (!json.is_object() || !json.contains("name") || !json.contains("ms")) continue;
    times[json.at("name").get<std::string>()] = json.at("ms").get<double>();
    version = json.value("torch", "");
  }
  pclose(pipe);
  return times;
}

/// Parses the arguments, measures and prints; `models` is passed to the peer.
inline int run(const char* program, const std::string& models,
               const std::function<std::vector<Measured>(const Context&, double seconds)>& measure_all,
               int argc, char** argv) {
  bool json = false;
  double seconds = 4;
  std::string peer;
  for (int i = 1; i < argc; ++i) {
    const bool has_value = i + 1 < argc;
    if (!std::strcmp(argv[i], "--json"))
      json = true;
    else if (!std::strcmp(argv[i], "--peer") && has_value)
      peer = argv[++i];
    else if (!std::strcmp(argv[i], "--seconds") && has_value)
      seconds = std::atof(argv[++i]);
    else
      throw Error("unknown argument ", argv[i], "; usage: ", program,
                  " [--json] [--peer torch_peer.py] [--seconds 4]");
  }
  const Context context;
  Peak peak(context);
  peak.measure();
  const std::vector<Measured> all = measure_all(context, seconds);
  const double peak_gflops = peak.measure();
  std::string version;
  const auto theirs = peer.empty() ? std::map<std::string, double>() : peer_times(peer, models, version);
  if (!peer.empty() && theirs.empty())
    std::fprintf(stderr, "%s: %s printed no times (it needs python3 with torch)\n", program, peer.c_str());
  for (const Measured& m : all) {
    const double gflops = m.gflop / m.ms * 1e3;
    nlohmann::ordered_json line{{"name", m.name},
                                {"ms", m.ms},
                                {"gflop", m.gflop},
                                {"gflops", gflops},
                                {"peak_gflops", peak_gflops},
                                {"share_of_peak", gflops / peak_gflops}};
    if (const auto found = theirs.find(m.name); found != theirs.end()) {
      line["torch_ms"] = found->second;
      line["torch"] = version;
      line["ratio_torch"] = found->second / m.ms;
    }
    line.update(m.extra);
    if (json)
      std::printf("%s\n", line.dump().c_str());
    else if (line.contains("torch_ms"))
      std::printf("%-30s %8.1f ms  %6.1f GFLOP  %5.0f GFLOP/s  %3.0f%% of peak  PyTorch %8.1f ms  %.2fx\n",
                  m.name.c_str(), m.ms, m.gflop, gflops, 100 * gflops / peak_gflops,
                  line["torch_ms"].get<double>(), line["ratio_torch"].get<double>());
    else
      std::printf("%-30s %8.1f ms  %6.1f GFLOP  %5.0f GFLOP/s  %3.0f%% of peak (%.0f)\n", m.name.c_str(),
                  m.ms, m.gflop, gflops, 100 * gflops / peak_gflops, peak_gflops);
    if (!json)
      for (const auto& [key, value] : m.extra.items())
        std::printf("%30s %s\n", key.c_str(), value.dump().c_str());
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

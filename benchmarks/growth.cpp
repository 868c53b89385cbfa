// How the time of DVGAN's CNN training steps grows with the batch, the hidden width and the frames.
//   bench_growth [--json] [--seconds 1] [--svg growth.svg]
// Prints a Markdown table for each of the three, or with --json one object per line; --svg writes a plot of
// all. POCL_MAX_PTHREAD_COUNT=1 measures on one core (with PoCL).
#include <cmath>
#include <fstream>

#include "cnn_steps.hpp"

using namespace motiongan;
using bench::CnnSize;
using bench::Measured;

namespace {

constexpr std::array<const char*, 3> step_names{"critic step", "generator step", "sample"};

/// One quantity that grows while the others stay.
struct Growth {
  std::string quantity;
  std::vector<std::size_t> values;
  std::vector<std::vector<Measured>> steps;  // for each value, in the order of step_names
};

Growth measure_growth(const Context& context, double seconds, const std::string& quantity,
                      const std::vector<std::size_t>& values, std::size_t CnnSize::*member) {
  Growth growth{quantity, values, {}};
  for (const std::size_t value : values) {
    CnnSize size;
    size.*member = value;
    growth.steps.push_back(bench::cnn_steps(context, seconds, size, concat("_", quantity, "_", value)));
  }
  return growth;
}

void print_table(const Growth& growth) {
  std::printf("| %s |", growth.quantity.c_str());
  for (const char* name : step_names) std::printf(" %s ms | GFLOP/s |", name);
  std::printf("\n|---|---|---|---|---|---|---|\n");
  for (std::size_t i = 0; i < growth.values.size(); ++i) {
    std::printf("| %zu |", growth.values[i]);
    for (const Measured& m : growth.steps[i]) std::printf(" %.1f | %.0f |", m.ms, m.gflop / m.ms * 1e3);
    std::printf("\n");
  }
  std::printf("\n");
}

/// Three plots beside each other, both axes logarithmic, one line per step.
std::string plot(const std::vector<Growth>& all) {
  constexpr double width = 300, height = 240, margin = 50;
  constexpr std::array<const char*, 3> colours{"#1f77b4", "#d62728", "#2ca02c"};
  double least = 1e9, most = 0;
  for (const Growth& growth : all)
    for (const auto& steps : growth.steps)
      for (const Measured& m : steps) least = std::min(least, m.ms), most = std::max(most, m.ms);
  const double low = std::floor(std::log10(least)), high = std::ceil(std::log10(most));
  const auto y_of = [&](double ms) { return margin + height * (high - std::log10(ms)) / (high - low); };
  std::string out =
      concat("<svg xmlns=\"http://www.w3.org/2000/svg\" font-family=\"sans-serif\" font-size=\"12\" ",
             "viewBox=\"0 0 ", static_cast<double>(all.size()) * (width + margin) + margin, " ",
             height + 2 * margin, "\"><rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n");
  for (std::size_t g = 0; g < all.size(); ++g) {
    const Growth& growth = all[g];
    const double left = margin + static_cast<double>(g) * (width + margin);
    const double first = std::log2(growth.values.front()), last = std::log2(growth.values.back());
    const auto x_of = [&](std::size_t value) {
      return left + width * (std::log2(static_cast<double>(value)) - first) / (last - first);
    };
    for (double decade = low; decade <= high; ++decade) {
      const double y = y_of(std::pow(10, decade));
      out += concat("<line x1=\"", left, "\" x2=\"", left + width, "\" y1=\"", y, "\" y2=\"", y,
                    "\" stroke=\"#ddd\"/><text x=\"", left - 4, "\" y=\"", y + 4, "\" text-anchor=\"end\">",
                    std::pow(10, decade), "</text>\n");
    }
    for (const std::size_t value : growth.values)
      out += concat("<text x=\"", x_of(value), "\" y=\"", margin + height + 16, "\" text-anchor=\"middle\">",
                    value, "</text>\n");
    out += concat("<text x=\"", left + width / 2, "\" y=\"", margin + height + 34,
                  "\" text-anchor=\"middle\">", growth.quantity, "</text>\n");
    for (std::size_t s = 0; s < step_names.size(); ++s) {
      out += concat("<polyline fill=\"none\" stroke-width=\"2\" stroke=\"", colours[s], "\" points=\"");
      for (std::size_t i = 0; i < growth.values.size(); ++i)
        out += concat(x_of(growth.values[i]), ",", y_of(growth.steps[i][s].ms), " ");
      out += "\"/>\n";
      if (g == 0)
        out += concat("<text x=\"", left + 10, "\" y=\"", margin + 14.0 * static_cast<double>(s) + 4,
                      "\" fill=\"", colours[s], "\">", step_names[s], ", ms</text>\n");
    }
  }
  return out + "</svg>\n";
}

int run(int argc, char** argv) {
  bool json = false;
  double seconds = 1;
  std::string svg;
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    if (name == "--json")
      json = true;
    else if (name == "--seconds" && i + 1 < argc)
      seconds = std::atof(argv[++i]);
    else if (name == "--svg" && i + 1 < argc)
      svg = argv[++i];
    else
      throw Error("unknown argument ", name,
                  "; usage: bench_growth [--json] [--seconds 1] [--svg growth.svg]");
  }
  const Context context;
  const std::vector<Growth> all{
      measure_growth(context, seconds, "batch", {1, 2, 4, 8, 16, 32, 64, 128, 256}, &CnnSize::batch),
      measure_growth(context, seconds, "hidden", {128, 256, 512, 1024}, &CnnSize::hidden),
      measure_growth(context, seconds, "frames", {8, 16, 32, 64, 128}, &CnnSize::frames)};
  if (!json)
    std::printf("Batch 64, hidden width 256, 32 frames but for the quantity that grows; %s, %u cores.\n\n",
                context.device().name.c_str(), static_cast<unsigned>(context.device().compute_units));
  for (const Growth& growth : all) {
    if (!json) {
      print_table(growth);
      continue;
    }
    for (const auto& steps : growth.steps)
      for (const Measured& m : steps)
        std::printf("%s\n",
                    nlohmann::ordered_json{
                        {"name", m.name}, {"ms", m.ms}, {"gflop", m.gflop}, {"gflops", m.gflop / m.ms * 1e3}}
                        .dump()
                        .c_str());
  }
  if (svg.empty()) return 0;
  std::ofstream file(svg);
  file << plot(all);
  require(file.flush().good(), "cannot write ", svg);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_growth: %s\n", error.what());
    return 1;
  }
}

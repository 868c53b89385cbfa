// What the training and sampling steps ask of a device, and the time that a GPU would take for it: to be
// compared with the first run on one. Steps and names are those of bench_train, bench_rnn and
// bench_attention, in the wide form of the kernels unless MOTIONGAN_KERNELS says otherwise.
//   bench_prediction [--json] [--seconds 0] [--bandwidth 3000] [--flops 60000] [--launch 5]
// --bandwidth in GB/s, --flops in GFLOP/s, --launch in microseconds: those of the predicted
// device. --seconds of measuring each step on the device at hand; 0: it runs three times.
//
// The prediction is the time to move the bytes or that to do the arithmetic, whichever is longer, and apart
// from it that of the launches; a device that overlaps them takes the longer of the two, one that does not
// their sum. Bytes are those of all arguments (ContextStatistics::bytes_touched): caches save some of them.
#include "attention_steps.hpp"
#include "cnn_steps.hpp"
#include "rnn_steps.hpp"

using namespace motiongan;

namespace {

struct Options {
  bool json = false;
  double seconds = 0, bandwidth = 3000, flops = 60'000, launch = 5;
};

Options read_options(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    double* const to = name == "--seconds"     ? &options.seconds
                       : name == "--bandwidth" ? &options.bandwidth
                       : name == "--flops"     ? &options.flops
                       : name == "--launch"    ? &options.launch
                                               : nullptr;
    if (name == "--json") {
      options.json = true;
      continue;
    }
    require(
        to && i + 1 < argc, "unknown argument ", name,
        "; usage: bench_prediction [--json] [--seconds 0] [--bandwidth 3000] [--flops 60000] [--launch 5]");
    *to = std::atof(argv[++i]);
    require(*to > 0 || to == &options.seconds, name, " is ", argv[i], ", expected a number above 0");
  }
  return options;
}

/// One step's counts and milliseconds.
nlohmann::ordered_json line_of(const bench::Measured& step, const Options& options) {
  const double moving = step.bytes / options.bandwidth / 1e6, computing = step.gflop / options.flops * 1e3,
               launching = step.launches * options.launch / 1e3;
  return {{"name", step.name},
          {"launches", step.launches},
          {"mb", step.bytes / 1e6},
          {"gflop", step.gflop},
          {"bytes_ms", moving},
          {"flops_ms", computing},
          {"work_ms", std::max(moving, computing)},
          {"launch_ms", launching},
          {"measured_ms", step.ms}};
}

int run(const Options& options) {
  setenv("MOTIONGAN_KERNELS", "wide", 0);
  const Context context;
  std::fprintf(stderr, "%s, the kernels' %s form; predicted: %g GB/s, %g GFLOP/s, %g us a launch\n",
               context.description().c_str(), context.wide() ? "wide" : "narrow", options.bandwidth,
               options.flops, options.launch);
  if (!options.json)
    std::printf("%-34s %8s %9s %8s %9s %9s %9s %11s\n", "step", "launches", "MB", "GFLOP", "bytes ms",
                "flops ms", "launch ms", "measured ms");
  for (const auto& steps : {std::function<std::vector<bench::Measured>()>(
                                [&] { return bench::cnn_steps(context, options.seconds, {}, "_b64"); }),
                            {[&] { return bench::attention_steps(context, options.seconds); }},
                            {[&] { return bench::rnn_steps(context, options.seconds); }}})
    for (const bench::Measured& step : steps()) {
      const nlohmann::ordered_json line = line_of(step, options);
      const auto number = [&](const char* key) { return line.at(key).get<double>(); };
      if (options.json)
        std::printf("%s\n", line.dump().c_str());
      else
        std::printf("%-34s %8.0f %9.1f %8.2f %9.3f %9.3f %9.3f %11.1f\n", step.name.c_str(),
                    number("launches"), number("mb"), number("gflop"), number("bytes_ms"), number("flops_ms"),
                    number("launch_ms"), number("measured_ms"));
      std::fflush(stdout);
    }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(read_options(argc, argv));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_prediction: %s\n", error.what());
    return 1;
  }
}

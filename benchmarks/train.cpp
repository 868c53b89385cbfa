// The steps of DVGAN's training beside PyTorch: the names and the work of `torch_peer.py speed --models cnn`
// (500 words, 93 dof, 32 frames, final cut, k = 256, batch 64; the critic's step makes its fakes and includes
// Adam).
//   bench_train [--json] [--peer torch_peer.py] [--seconds 4]
// With --peer the same steps are timed in PyTorch afterwards, in a process of its own, and the ratio is
// given.
#include <array>
#include <cstring>
#include <map>
#include <motiongan/models/cnn_critic.hpp>
#include <motiongan/models/cnn_generator.hpp>
#include <motiongan/optim/adam.hpp>
#include <motiongan/train/wgan_gp.hpp>
#include <nlohmann/json.hpp>

#include "peak.hpp"

using namespace motiongan;

namespace {

struct Measured {
  std::string name;
  double ms = 0, gflop = 0;
};

/// Median time of a step that ends when the device has run it, and the arithmetic of its matrix products.
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

std::vector<Measured> ours(const Context& context, double seconds) {
  constexpr std::size_t batch = 64, frames = 32, dof = 93, vocabulary = 500, hidden = 256;
  CnnGenerator generator(Initializer(context, 1),
                         {.vocabulary = vocabulary, .dof = dof, .frames = frames, .hidden = hidden});
  CnnCritic critic(Initializer(context, 2),
                   {.vocabulary = vocabulary, .dof = dof, .frames = frames, .hidden = hidden});
  Adam generator_adam(named_parameters(generator)), critic_adam(named_parameters(critic));
  std::vector<std::vector<int>> sentences(batch);
  for (std::uint32_t b = 0; b < batch; ++b)
    for (std::uint32_t i = 0; i < 6; ++i)
      sentences[b].push_back(
          static_cast<int>(random_below({.seed = 9, .stream = Stream::captions}, b, vocabulary, i)));
  const Sentences text(context, sentences, vocabulary);
  const Tensor real = random_normal(context, {.seed = 5}, frames, batch, dof);
  std::uint32_t step = 0;
  const auto fake = [&] {
    const RandomKey key{.seed = 1, .step = ++step};
    const Indices cut = generator.cuts(context, key, batch);
    return generator(text, generator.noise(context, key, batch, cut), cut);
  };
  const auto sample = [&] {
    const NoGrad values_only;
    return fake().value();
  };
  const auto critic_step = [&] {
    const Tensor made = sample();
    const Var h_txt = critic.encode_text(text), pairs = concat_axis({h_txt, h_txt}, 0);
    const CriticLoss loss = critic_loss(
        [&](const Var& x) { return critic(x, pairs); }, [&](const Var& x) { return critic(x, h_txt); }, real,
        made, random_uniform(context, {.seed = 1, .stream = Stream::mix, .step = step}, batch), 10);
    critic_adam.step(grad(loss.loss, critic_adam.parameters()));
  };
  const auto generator_step = [&] {
    Var h_txt;
    {
      const NoGrad values_only;
      h_txt = critic.encode_text(text);
    }
    generator_adam.step(grad(generator_loss(critic(fake(), h_txt)), generator_adam.parameters()));
  };
  return {measure(context, "dvgan_cnn_critic_step_b64", seconds, critic_step),
          measure(context, "dvgan_cnn_generator_step_b64", seconds, generator_step),
          measure(context, "dvgan_cnn_sample_b64", seconds, sample)};
}

/// The peer's milliseconds by name; empty when it could not be run.
std::map<std::string, double> peer_times(const std::string& script, std::string& version) {
  std::map<std::string, double> times;
  const std::string command = "/usr/bin/python3 '" + script + "' speed --models cnn";
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

int run(int argc, char** argv) {
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
      throw Error("unknown argument ", argv[i],
                  "; usage: bench_train [--json] [--peer torch_peer.py] [--seconds 4]");
  }
  const Context context;
  bench::Peak peak(context);
  peak.measure();
  const std::vector<Measured> all = ours(context, seconds);
  const double peak_gflops = peak.measure();
  std::string version;
  const auto theirs = peer.empty() ? std::map<std::string, double>() : peer_times(peer, version);
  if (!peer.empty() && theirs.empty())
    std::fprintf(stderr, "bench_train: %s printed no times (it needs python3 with torch)\n", peer.c_str());
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
    if (json)
      std::printf("%s\n", line.dump().c_str());
    else if (line.contains("torch_ms"))
      std::printf("%-30s %8.1f ms  %6.1f GFLOP  %5.0f GFLOP/s  %3.0f%% of peak  PyTorch %8.1f ms  %.2fx\n",
                  m.name.c_str(), m.ms, m.gflop, gflops, 100 * gflops / peak_gflops,
                  line["torch_ms"].get<double>(), line["ratio_torch"].get<double>());
    else
      std::printf("%-30s %8.1f ms  %6.1f GFLOP  %5.0f GFLOP/s  %3.0f%% of peak (%.0f)\n", m.name.c_str(),
                  m.ms, m.gflop, gflops, 100 * gflops / peak_gflops, peak_gflops);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_train: %s\n", error.what());
    return 1;
  }
}

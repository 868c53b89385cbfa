// DVGAN's training steps compared with PyTorch: the same names and workload as `torch_peer.py speed --models
// cnn` (500 words, 93 dof, 32 frames, final cut, k = 256, batch 64; steps include Adam, the critic step
// includes generating the fakes).
//   bench_train [--json] [--peer torch_peer.py [--python PYTHON]...] [--seconds 4] [--rounds 5]
// With --peer the script times the same steps in PyTorch, in a process of its own, in turn with ours: medians
// over the rounds, and the ratio to the fastest PyTorch, are printed.
#include "cnn_steps.hpp"

using namespace motiongan;

int main(int argc, char** argv) {
  const auto ours = [](const Context& context, double seconds) {
    return bench::cnn_steps(context, seconds, {}, "_b64");
  };
  return bench::main("bench_train", "cnn", ours, argc, argv);
}

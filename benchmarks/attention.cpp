// The attention WGAN-GP compared with PyTorch: the same names and workload as
// `torch_peer.py speed --models attention` (30 frames, 93 dof, 4 classes, C = 256). The critic step includes
// generating the fakes and Adam; a rollout is 30 seconds of motion, each second the prior of the next.
//   bench_attention [--json] [--peer torch_peer.py [--python PYTHON]...] [--seconds 4] [--rounds 5]
// With --peer the script times the same work in PyTorch, in a process of its own, in turn with ours: medians
// over the rounds, and the ratio to the fastest PyTorch, are printed.
#include "attention_steps.hpp"

int main(int argc, char** argv) {
  return motiongan::bench::main("bench_attention", "attention", motiongan::bench::attention_steps, argc,
                                argv);
}

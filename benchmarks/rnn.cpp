// The recurrent networks of DVGAN compared with PyTorch: the same names and workload as `torch_peer.py speed
// --models rnn,rnn_critic` (500 words, 93 dof, 64 frames, k = 256; steps include Adam, the critic step
// includes generating the fakes), and the frames per second when streaming characters frame by frame.
//   bench_rnn [--json] [--peer torch_peer.py [--python PYTHON]...] [--seconds 4] [--rounds 5]
// With --peer the script times the same steps in PyTorch, in a process of its own, in turn with ours: medians
// over the rounds, and the ratio to the fastest PyTorch, are printed.
#include "rnn_steps.hpp"

int main(int argc, char** argv) {
  return motiongan::bench::main("bench_rnn", "rnn,rnn_critic", motiongan::bench::rnn_steps, argc, argv);
}

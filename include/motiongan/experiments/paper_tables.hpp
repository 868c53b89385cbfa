// The published results of Lin & Amer (Tables 1, 2 and S1), for comparison. They were measured with other
// clips, captions and rankers; with another K or other data they are not comparable.
#pragma once
#include <array>
#include <span>
#include <string_view>

#include "motiongan/metrics/retrieval.hpp"

namespace motiongan::paper {

/// A row of Table 1: R@1, 3, 5 and 10 of a ranker on held-out clips, in percent, among K = 250 descriptions
/// of CMU or 15 actions of Human3.6M.
struct RankerRow {
  std::string_view name;
  Recall cmu, h36m;  ///< percent
};
/// Table 1: random guessing and the rankers.
inline constexpr std::array<RankerRow, 3> table1{
    {{"random", {0.4, 1.2, 2.0, 4.0}, {6.7, 20, 33.3, 66.7}},
     {"CNN ranker", {36.5, 45.6, 49.1, 53.8}, {44.5, 69.4, 82.6, 96.4}},
     {"RNN ranker", {39.7, 48.3, 51.4, 58.7}, {47.2, 73.9, 85.2, 97.0}}}};

/// A row of Table 2: inception score in nats, and R@1, 3, 5 and 10 of generated motion in percent.
struct GeneratorRow {
  std::string_view generator, critic;  ///< "cnn" or "rnn"
  std::string_view validation;         ///< of the CNN critic
  bool shift, cut;                     ///< input shift and final cut
  double inception_score;              ///< nats
  Recall recall;                       ///< percent
};
/// Table 2, CMU: generators and critics.
inline constexpr std::array<GeneratorRow, 8> table2_cmu{
    {{"cnn", "cnn", "final", false, false, 3.62, {40.6, 50.4, 53.1, 56.5}},
     {"cnn", "cnn", "mod2", false, false, 3.80, {47.6, 56.6, 58.4, 60.9}},
     {"cnn", "cnn", "dense", false, false, 3.88, {51.0, 58.0, 59.7, 61.9}},
     {"cnn", "cnn", "dense", true, false, 3.85, {52.2, 58.4, 60.3, 63.0}},
     {"cnn", "cnn", "dense", true, true, 3.89, {52.3, 57.6, 58.8, 60.7}},
     {"rnn", "cnn", "dense", false, false, 3.62, {50.4, 58.3, 60.9, 63.5}},
     {"rnn", "cnn", "dense", true, false, 3.61, {49.9, 59.0, 61.2, 64.2}},
     {"rnn", "cnn", "dense", true, true, 3.53, {47.3, 56.5, 59.6, 62.9}}}};
/// Table 2, CMU: the real motion.
inline constexpr GeneratorRow real_cmu{"real", "", "", false, false, 3.74, {39.7, 48.3, 51.4, 58.7}};
/// Table 2, Human3.6M: generators and critics.
inline constexpr std::array<GeneratorRow, 8> table2_h36m{
    {{"cnn", "cnn", "final", false, false, 2.49, {91.5, 97.2, 98.6, 99.8}},
     {"cnn", "cnn", "mod2", false, false, 2.55, {97.2, 99.8, 99.9, 100}},
     {"cnn", "cnn", "dense", false, false, 2.53, {97.5, 99.8, 100, 100}},
     {"cnn", "cnn", "dense", true, false, 2.56, {98.6, 100, 100, 100}},
     {"cnn", "cnn", "dense", true, true, 2.58, {98.7, 100, 100, 100}},
     {"rnn", "cnn", "dense", false, false, 2.51, {97.7, 99.9, 99.9, 100}},
     {"rnn", "cnn", "dense", true, false, 2.50, {96.5, 99.7, 99.9, 100}},
     {"rnn", "cnn", "dense", true, true, 2.36, {88.5, 98.3, 99.9, 100}}}};
/// Table 2, Human3.6M: the real motion.
inline constexpr GeneratorRow real_h36m{"real", "", "", false, false, 1.48, {47.2, 73.9, 85.2, 97.0}};

/// Table S1, Human3.6M: combinations of generators and critics.
inline constexpr std::array<GeneratorRow, 4> table_s1_h36m{
    {{"cnn", "rnn", "", false, false, 1.87, {64.7, 87.4, 93.4, 99.3}},
     {"rnn", "rnn", "", false, false, 1.85, {70.8, 86.7, 100, 100}},
     {"cnn", "cnn", "dense", false, false, 2.53, {97.5, 99.8, 100, 100}},
     {"rnn", "cnn", "dense", false, false, 2.36, {90.1, 98.7, 99.7, 99.9}}}};

}  // namespace motiongan::paper

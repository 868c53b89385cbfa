// The language model of both generator and critic (SPEC 1).
#pragma once
#include "motiongan/nn/lstm.hpp"

namespace motiongan {

/// A batch of sentences on the device, one column a sample.
struct Sentences {
  Indices words;    ///< [longest, batch], word numbers; anything behind a sentence's end
  Indices lengths;  ///< [batch]
  std::size_t longest = 0, batch = 0;

  Sentences() = default;

  /// Throws when a sentence is empty or a word is not in a vocabulary of `vocabulary` words.
  Sentences(const Context& context, const std::vector<std::vector<int>>& sentences, std::size_t vocabulary)
      : batch(sentences.size()) {
    for (const auto& sentence : sentences) {
      require(!sentence.empty(), "a sentence without a word: every sample needs a description");
      longest = std::max(longest, sentence.size());
    }
    std::vector<cl_int> grid(longest * batch, 0), length;
    for (std::size_t b = 0; b < batch; ++b) {
      length.push_back(static_cast<cl_int>(sentences[b].size()));
      for (std::size_t t = 0; t < sentences[b].size(); ++t) {
        require(sentences[b][t] >= 0 && static_cast<std::size_t>(sentences[b][t]) < vocabulary,
                "word number ", sentences[b][t], " is outside the vocabulary of ", vocabulary, " words");
        grid[t * batch + b] = sentences[b][t];
      }
    }
    words = Indices(context, grid);
    lengths = Indices(context, length);
  }
};

/// Embedding, two-layer LSTM, then both layers' h and c after the last real word through a linear layer: [B,
/// k].
struct TextEncoder {
  Embedding embedding;
  Lstm lstm;
  Linear proj;

  TextEncoder() = default;
  TextEncoder(Initializer& init, std::size_t vocabulary, std::size_t k)
      : embedding(init, vocabulary, k), lstm(init, k, k, 2), proj(init, 4 * k, k) {}

  Var operator()(const Sentences& text) const {
    const std::size_t k = lstm.hidden();
    const Var x = reshape(embedding(text.words), {text.longest, text.batch, k});
    const std::vector<Var> states = lstm(x, text.lengths);
    std::vector<Var> last;
    for (std::size_t kind : {0, 1})
      for (const Var& layer : states) last.push_back(last_state(layer, kind));
    return proj(concatenate(last, 1));
  }

  void list_parameters(ParameterList& list) {
    list.add_module("embedding", embedding);
    list.add_module("lstm", lstm);
    list.add_module("proj", proj);
  }
};

}  // namespace motiongan

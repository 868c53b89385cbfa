// The text encoder (LanguageModel) of DVGAN's generators, critics and rankers (Lin & Amer, eq. 4-10).
#pragma once
#include "motiongan/nn/lstm.hpp"

namespace motiongan {

/// A batch of sentences on the device, one column per sample.
struct Sentences {
  Indices words;    ///< word ids [longest, batch]; padding past a sentence's end is never used
  Indices lengths;  ///< in words, [batch]
  std::size_t longest = 0, batch = 0;

  Sentences() = default;

  /// Throws Error if a sentence is empty or a word id is not in 0 .. vocabulary - 1.
  Sentences(const Context& context, const std::vector<std::vector<int>>& sentences, std::size_t vocabulary)
      : batch(sentences.size()) {
    for (const auto& sentence : sentences) {
      require(!sentence.empty(), "a sentence is empty: every sample needs a description");
      longest = std::max(longest, sentence.size());
    }
    std::vector<cl_int> grid(longest * batch, 0), length;
    for (std::size_t b = 0; b < batch; ++b) {
      length.push_back(static_cast<cl_int>(sentences[b].size()));
      for (std::size_t t = 0; t < sentences[b].size(); ++t) {
        require(sentences[b][t] >= 0 && static_cast<std::size_t>(sentences[b][t]) < vocabulary, "word id ",
                sentences[b][t], " is outside the vocabulary of ", vocabulary, " words");
        grid[t * batch + b] = sentences[b][t];
      }
    }
    words = Indices(context, grid);
    lengths = Indices(context, length);
  }
};

/// Word embedding, two LSTM layers of k, then a linear layer on the concatenated h and c of both layers after
/// each sentence's last word. Returns h_txt, [B, k].
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

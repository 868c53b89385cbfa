// The text encoder (LanguageModel) of DVGAN's generators, critics and rankers (Lin & Amer, eq. 4-10).
#pragma once
#include <map>

#include "motiongan/nn/lstm.hpp"

namespace motiongan {

/// A batch of sentences on the device. In batches of 16 and more, sentences that samples share are there
/// once; their number is rounded up to quarters of the batch by copies of the first, so that the sizes of a
/// training's tensors soon repeat and no memory is allocated any more.
struct Sentences {
  Indices words;      ///< word ids [longest, rows]; padding past a sentence's end is never used
  Indices lengths;    ///< in words, [rows]
  Indices of_sample;  ///< which row each sample has, [batch]; empty if each has its own
  std::size_t longest = 0, rows = 0, batch = 0;  ///< words of the longest sentence; sentences; samples

  Sentences() = default;

  /// Throws Error if a sentence is empty or a word id is not in 0 .. vocabulary - 1.
  Sentences(const Context& context, const std::vector<std::vector<int>>& sentences, std::size_t vocabulary)
      : batch(sentences.size()) {
    std::map<std::vector<int>, cl_int> index;  // of each sentence among the distinct ones
    std::vector<std::size_t> first;            // the first sample that has it
    std::vector<cl_int> row_of_sample;
    for (std::size_t b = 0; b < batch; ++b) {
      require(!sentences[b].empty(), "a sentence is empty: every sample needs a description");
      for (const int word : sentences[b])
        require(word >= 0 && static_cast<std::size_t>(word) < vocabulary, "word id ", word,
                " is outside the vocabulary of ", vocabulary, " words");
      longest = std::max(longest, sentences[b].size());
      const auto [place, fresh] = index.emplace(sentences[b], static_cast<cl_int>(first.size()));
      if (fresh) first.push_back(b);
      row_of_sample.push_back(place->second);
    }
    const std::size_t quarter = (batch + 3) / 4;
    rows = batch < 16 ? batch : std::min(batch, (first.size() + quarter - 1) / quarter * quarter);
    std::vector<cl_int> grid(longest * rows, 0), length;
    for (std::size_t i = 0; i < rows; ++i) {
      const auto& sentence = sentences[rows == batch ? i : i < first.size() ? first[i] : 0];
      length.push_back(static_cast<cl_int>(sentence.size()));
      for (std::size_t t = 0; t < sentence.size(); ++t) grid[t * rows + i] = sentence[t];
    }
    words = Indices(context, grid);
    lengths = Indices(context, length);
    if (rows < batch) of_sample = Indices(context, row_of_sample);
  }
};

/// Word embedding, two LSTM layers of k, then a linear layer on the concatenated h and c of both layers after
/// each sentence's last word. Returns h_txt, [B, k].
struct TextEncoder {
  Embedding embedding;  ///< of the words
  Lstm lstm;
  Linear proj;  ///< of the last states of both layers

  TextEncoder() = default;
  TextEncoder(Initializer& init, std::size_t vocabulary, std::size_t k)
      : embedding(init, vocabulary, k), lstm(init, k, k, 2), proj(init, 4 * k, k) {}

  Var operator()(const Sentences& text) const {
    const std::size_t k = lstm.hidden();
    const Var x = reshape(embedding(text.words), {text.longest, text.rows, k});
    const std::vector<Var> states = lstm(x, text.lengths);
    std::vector<Var> last;
    for (std::size_t kind : {0, 1})
      for (const Var& layer : states) last.push_back(last_state(layer, kind));
    const Var encoded = proj(concatenate(last, 1));
    return text.rows == text.batch ? encoded : gather_rows(encoded, text.of_sample);
  }

  void list_parameters(ParameterList& list) {
    list.add_module("embedding", embedding);
    list.add_module("lstm", lstm);
    list.add_module("proj", proj);
  }
};

}  // namespace motiongan

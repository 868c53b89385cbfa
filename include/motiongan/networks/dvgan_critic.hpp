// Either critic of DVGAN, by option.
#pragma once
#include <variant>

#include "motiongan/networks/cnn_critic.hpp"
#include "motiongan/networks/rnn_critic.hpp"

namespace motiongan {

/// The CNN judges windows of N frames at every time scale, the RNN poses and their changes.
enum class CriticKind { cnn, rnn };

struct DvganCriticOptions {
  CriticKind critic = CriticKind::cnn;
  Validation validation = Validation::dense;       ///< of the CNN critic
  LevelWeights level_weights = LevelWeights::exp;  ///< of the CNN critic
  DiffInput diff_input = DiffInput::hidden;        ///< of the RNN critic
};

/// What both critics have in common.
class DvganCritic {
 public:
  /// Sizes as CnnCriticOptions has them; `taps` counts for the CNN alone.
  DvganCritic(const Initializer& init, const CnnCriticOptions& sizes, const DvganCriticOptions& options)
      : critic_(make(init, sizes, options)) {}

  /// [B, k]; computed once a step, it serves real, fake and mixed motion alike.
  Var encode_text(const Sentences& text) const {
    return std::visit([&](const auto& critic) { return critic.encode_text(text); }, critic_);
  }

  /// One score per sample, [B], of motion [N, B, M] with encoded text [B, k].
  Var operator()(const Var& motion, const Var& h_txt) const {
    return std::visit([&](const auto& critic) { return critic(motion, h_txt); }, critic_);
  }

  void list_parameters(ParameterList& list) {
    std::visit([&](auto& critic) { critic.list_parameters(list); }, critic_);
  }

 private:
  using Network = std::variant<CnnCritic, RnnCritic>;

  static Network make(const Initializer& init, CnnCriticOptions sizes, const DvganCriticOptions& options) {
    if (options.critic == CriticKind::rnn)
      return RnnCritic(init, {.vocabulary = sizes.vocabulary,
                              .dof = sizes.dof,
                              .hidden = sizes.hidden,
                              .diff_input = options.diff_input});
    sizes.validation = options.validation;
    sizes.level_weights = options.level_weights;
    return CnnCritic(init, sizes);
  }

  Network critic_;
};

}  // namespace motiongan

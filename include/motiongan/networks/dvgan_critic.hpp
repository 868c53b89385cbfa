// DVGAN's critic, CNN or RNN by option.
#pragma once
#include <optional>
#include <variant>

#include "motiongan/core/fields.hpp"
#include "motiongan/networks/body_view.hpp"
#include "motiongan/networks/cnn_critic.hpp"
#include "motiongan/networks/rnn_critic.hpp"

namespace motiongan {

/// The CNN scores windows of N frames at several time scales, the RNN scores poses and frame differences.
enum class CriticKind { cnn, rnn };
constexpr NameTable<CriticKind, 2> enum_names(CriticKind) {
  return {{{CriticKind::cnn, "cnn"}, {CriticKind::rnn, "rnn"}}};
}

/// What a critic is given of a motion: its pose vectors (the papers), what BodyView computes from them, or
/// both.
enum class CriticSees { rotations, positions, both };
constexpr NameTable<CriticSees, 3> enum_names(CriticSees) {
  return {{{CriticSees::rotations, "rotations"},
           {CriticSees::positions, "positions"},
           {CriticSees::both, "both"}}};
}

/// Options of a DvganCritic: which network it is, and what it sees of the motion.
struct DvganCriticOptions {
  CriticKind critic = CriticKind::cnn;
  CriticSees sees = CriticSees::rotations;
  Validation validation = Validation::dense;       ///< of the CNN critic
  LevelWeights level_weights = LevelWeights::exp;  ///< of the CNN critic
  DiffInput diff_input = DiffInput::hidden;        ///< of the RNN critic

  void list_fields(FieldList& list) {
    list.add(critic, {.key = "critic",
                      .help = "cnn: scores several time scales; rnn: scores poses and frame differences",
                      .group = "Model"});
    list.add(sees, {.key = "critic_sees",
                    .help = "rotations: pose vectors, as the paper; positions: places and velocities of the "
                            "joints, by forward kinematics",
                    .group = "Model"});
    list.add(validation, {.key = "validation",
                          .help = "time scales that the CNN critic scores: all, every second, the coarsest",
                          .group = "Model"});
    list.add(level_weights, {.key = "level_weights",
                             .help = "how the CNN critic weights the scores of its time scales",
                             .group = "Model"});
    list.add(diff_input, {.key = "diff_input",
                          .help = "input of the RNN critic's second score: LSTM states or differences",
                          .group = "Model"});
  }
};

/// A motion as a critic sees it.
class CriticView {
 public:
  /// Throws Error as BodyView does.
  CriticView(const Context& context, const motion::MotionFormat& format, CriticSees sees) : sees_(sees) {
    size_ = sees == CriticSees::positions ? 0 : format.dof();
    if (sees == CriticSees::rotations) return;
    body_.emplace(context, format);
    size_ += body_->size();
  }

  /// Values per frame.
  std::size_t size() const { return size_; }

  /// [N, B, size()] of normalised motion [N, B, M] in window form.
  Var operator()(const Var& motion) const {
    if (!body_) return motion;
    const Var seen = (*body_)(motion);
    return sees_ == CriticSees::both ? concatenate({motion, seen}, 2) : seen;
  }

 private:
  CriticSees sees_;
  std::size_t size_;
  std::optional<BodyView> body_;
};

/// A CnnCritic or an RnnCritic behind one interface.
class DvganCritic {
 public:
  /// `sizes` gives the sizes of either critic; taps and frames apply to the CNN only. Throws Error as the
  /// critic's own constructor does.
  DvganCritic(const Initializer& init, const CnnCriticOptions& sizes, const DvganCriticOptions& options)
      : critic_(make(init, sizes, options)) {}

  /// Text encoding [B, k]. Compute it once per step and share it between real, fake and interpolated motion.
  Var encode_text(const Sentences& text) const {
    return std::visit([&](const auto& critic) { return critic.encode_text(text); }, critic_);
  }

  /// One score per sample, [B], of motion as it sees it, [N, B, M], and the text encoding [B, k].
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
    sizes.composes = options.sees == CriticSees::rotations || sizes.dof < sizes.hidden;
    return CnnCritic(init, sizes);
  }

  Network critic_;
};

}  // namespace motiongan

// The model that `motiongan serve` makes motion with, of any kind.
#pragma once
#include <nlohmann/json.hpp>
#include <optional>

#include "motiongan/core/context.hpp"
#include "serve/crowd.hpp"
#include "shared/action_data.hpp"
#include "shared/weights.hpp"

namespace motiongan::command {

struct ServedModelArgs {
  std::string model, data;         // a file or a run's folder; the folder of the clips to draw priors from
  std::vector<std::string> clips;  // priors of a model of classes
  motion::ClipOptions reading;     // how they are read
  Weights weights;
};

/// What a text lacks in the eyes of the model.
struct PromptNotes {
  std::vector<std::string> unknown;  ///< words that it never saw
  std::vector<std::string> nearest;  ///< its descriptions that are nearest, if there are unknown words
  std::string remark;                ///< such as that the text is too long; may be empty
};

class ServedModel {
 public:
  /// Opens the model, and the priors if it is one of classes. Throws Error for options of another kind of
  /// model, and if there is no prior.
  ServedModel(const Context& context, const ServedModelArgs& args, const CLI::App& verb);
  ServedModel(const ServedModel&) = delete;
  ServedModel& operator=(const ServedModel&) = delete;

  bool has_classes() const { return actions_.has_value(); }
  double rate() const { return has_classes() ? actions_->format().rate : texts_->format().rate; }
  double unit_metres() const {
    return has_classes() ? actions_->format().space.unit_metres : texts_->format().space.unit_metres;
  }

  /// Makes a frame, so that kernels are built before the first character waits for them.
  void warm_up() const;

  /// No characters yet. The model must outlive them.
  std::unique_ptr<Crowd> new_crowd() const;

  /// What the page needs to know.
  nlohmann::json describe() const;

  PromptNotes notes_on(const std::string& prompt) const;

 private:
  void find_priors(const ServedModelArgs& args, const CLI::App& verb);

  std::string name_;
  std::optional<Dvgan> texts_;
  std::optional<ActionGan> actions_;
  std::vector<std::vector<motion::Motion>> priors_;  // by class; empty: the model's own starts
};

}  // namespace motiongan::command

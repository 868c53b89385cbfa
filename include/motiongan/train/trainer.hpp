// The interface of all trainers: iterations, networks with their optimizers, named losses, options.
#pragma once
#include <filesystem>
#include <initializer_list>
#include <span>
#include <string>
#include <vector>

#include "motiongan/core/fields.hpp"
#include "motiongan/data/motion_format.hpp"
#include "motiongan/data/position_format.hpp"
#include "motiongan/distributed/parallel.hpp"
#include "motiongan/models/model_file.hpp"
#include "motiongan/optim/optimizer.hpp"
#include "motiongan/optim/schedule.hpp"
#include "motiongan/optim/weight_mean.hpp"

namespace motiongan {

/// A loss, or another number of an iteration, under its name in the log and the progress line.
struct NamedLoss {
  const char* name;  ///< in the log
  double value;
};

/// One network of a training run and the optimizer that updates it.
struct TrainedPart {
  std::string name;  ///< prefix of its tensors in a checkpoint
  std::vector<NamedParameter> parameters;
  Optimizer* optimizer = nullptr;  ///< steps them
  WeightMean* mean = nullptr;      ///< of its weights, which are then what generates; or none
};

/// The sum of the steps of an iteration, or the largest number there is if that would be exceeded.
inline std::size_t total_steps(std::initializer_list<std::size_t> parts) {
  std::size_t sum = 0;
  for (const std::size_t part : parts) sum = part > ~std::size_t{0} - sum ? ~std::size_t{0} : sum + part;
  return sum;
}

/// The largest number of iterations of `steps` steps each that the 24-bit step of a RandomKey allows. Throws
/// Error if that is none.
inline std::size_t max_iterations(std::size_t steps) {
  constexpr std::size_t all = std::size_t{1} << 24;
  require(steps <= all / 3, "an iteration has ", steps, " steps, expected at most ", all / 3,
          ": random numbers count 2^24 steps; lower critic_steps or generator_steps");
  return all / std::max<std::size_t>(steps, 1) - 2;
}

/// Throws Error if `iterations` of `steps` steps each exceed max_iterations().
inline void check_iterations(std::size_t iterations, std::size_t steps) {
  require(iterations <= max_iterations(steps), "iterations is ", iterations, ", expected at most ",
          max_iterations(steps), " with ", steps, " steps each: random numbers count 2^24 steps");
}

/// The training of one model. run_training() drives it; save_checkpoint() and load_checkpoint() save and
/// restore it.
class Trainer {
 public:
  virtual ~Trainer() = default;
  Trainer(const Trainer&) = delete;
  Trainer& operator=(const Trainer&) = delete;

  /// One iteration: one or more updates of every network, as the options say.
  virtual void iterate() = 0;
  /// Iterations done so far.
  std::size_t iteration() const { return iteration_; }
  /// For a run that resumes.
  void set_iteration(std::size_t iteration) { iteration_ = iteration; }
  /// Total number of iterations.
  virtual std::size_t iterations() const = 0;

  /// Divides batches among ranks. All ranks set it alike, before the first iteration.
  void set_parallel(Parallel parallel) {
    check_parallel(parallel, batch());
    parallel_ = std::move(parallel);
  }
  /// How batches are divided among processes.
  const Parallel& parallel() const { return parallel_; }
  /// Samples in a step, on all ranks together.
  virtual std::size_t batch() const = 0;

  /// The networks and their optimizers; the model comes first.
  virtual std::vector<TrainedPart> parts() = 0;
  /// Losses of the last iteration; reading them waits for the device.
  virtual std::vector<NamedLoss> named_losses() const = 0;
  /// The names of the losses, in the same order.
  virtual std::vector<std::string> loss_names() const = 0;

  /// Adds the model's metadata and the training options ("training") to a checkpoint.
  virtual void describe(io::SafeTensors& file) const = 0;
  /// Throws Error, naming what differs, unless the checkpoint belongs to the same model, data and options.
  virtual void require_same_run(const io::SafeTensors& file, const std::string& where) const = 0;

 protected:
  /// Throws Error as check_iterations().
  Trainer(std::size_t iterations, std::size_t steps) { check_iterations(iterations, steps); }

  /// Sets the learning rates for the next iteration.
  void follow_schedule(const ScheduleOptions& schedule) {
    if (schedule.shape == LearningSchedule::constant) return;
    for (const TrainedPart& part : parts())
      part.optimizer->set_rate_factor(schedule.factor(iteration_, iterations()));
  }

  std::size_t iteration_ = 0;
  Parallel parallel_;
};

/// Gives each network that has a running mean of its weights that mean. For the end of a training: the
/// trainer should not go on from there.
inline void use_means(Trainer& trainer) {
  for (const TrainedPart& part : trainer.parts())
    if (part.mean != nullptr) part.mean->apply();
}

namespace detail {

/// Throws Error unless the saved fields of the run (`then`) equal those given now.
inline void require_same_options(const FieldList& then, const FieldList& now, const std::string& where) {
  for (auto a = then.begin(), b = now.begin(); a != then.end(); ++a, ++b)
    require(!a->info.saved || a->equals(*b), where, ": the run was started with ", a->info.key, " = ",
            a->text(), ", now it is ", b->text(), "; give the same, or choose another folder for a new run");
}

/// Throws Error unless a data set fits the model: same dof, frames, and `same_names` (words or classes).
template <class Format>
void require_same_format(const Format& data, const Format& model, const char* names, std::size_t data_names,
                         std::size_t model_names, bool same_names) {
  require(data.dof() == model.dof() && data.frames == model.frames && same_names, "the data set (",
          data.dof(), " dof, ", data.frames, " frames, ", data_names, " ", names,
          ") does not fit the model (", model.dof(), " dof, ", model.frames, " frames, ", model_names, " ",
          names, ")");
}
inline void require_same_format(const motion::MotionFormat& data, const motion::MotionFormat& model) {
  const std::size_t words = data.vocabulary.size(), known = model.vocabulary.size();
  require_same_format(data, model, "words", words, known, words == known);
}
inline void require_same_format(const motion::PositionFormat& data, const motion::PositionFormat& model) {
  require_same_format(data, model, "classes", data.classes.size(), model.classes.size(),
                      data.classes == model.classes);
}

}  // namespace detail

/// Base of the trainers of a `Model`. `TrainOptions` has list_fields(), iterations and steps(); `Losses` has
/// named().
template <class Model, class TrainOptions, class Losses>
class ModelTrainer : public Trainer {
 public:
  Model& model() { return model_; }
  const TrainOptions& options() const { return options_; }
  std::size_t iterations() const override { return options_.iterations; }
  std::size_t batch() const override { return options_.batch; }

  /// Losses of the last iteration; reading them waits for the device. Throws Error before the first.
  virtual Losses losses() const = 0;

  std::vector<NamedLoss> named_losses() const override { return losses().named(); }
  std::vector<std::string> loss_names() const override {
    std::vector<std::string> names;
    for (const NamedLoss& loss : Losses{}.named()) names.emplace_back(loss.name);
    return names;
  }

  void describe(io::SafeTensors& file) const override {
    describe_model(model_, file);
    TrainOptions options = options_;
    file.metadata["training"] = io::fields_to_text(fields_of(options));
  }
  void require_same_run(const io::SafeTensors& file, const std::string& where) const override {
    auto model_then = model_options<Model>(file, where), model_now = model_.options();
    require(Model::kind_of(model_then) == Model::kind_of(model_now), where,
            ": the run trains another model, ", model_kind(file, where),
            "; give the options of its first start, or choose another folder");
    detail::require_same_options(fields_of(model_then), fields_of(model_now), where);
    const auto format = file.metadata.find("format");
    require(format != file.metadata.end() &&
                io::same_format(format->second, Model::write_format(model_.format())),
            where,
            ": the run was started with other data (\"format\" differs); give the data and options of its "
            "first start, or choose another folder for a new run");
    const auto text = file.metadata.find("training");
    require(text != file.metadata.end(), where,
            ": not a checkpoint of a training run (no \"training\" in its metadata)");
    TrainOptions then{}, now = options_;
    io::fields_from_text(fields_of(then), text->second, where + ": the training options");
    detail::require_same_options(fields_of(then), fields_of(now), where);
  }

 protected:
  /// Throws Error if an option is out of range.
  ModelTrainer(Model& model, const TrainOptions& options)
      : Trainer(options.iterations, (check_options(options), options.steps())),
        model_(model),
        options_(options) {}

  Model& model_;
  TrainOptions options_;
};

}  // namespace motiongan

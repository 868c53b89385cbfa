// A whole training run with any trainer: iterations, log, checkpoints, stopping and resuming.
#pragma once
#include <cmath>
#include <cstdio>
#include <exception>
#include <functional>
#include <memory>
#include <new>

#include "motiongan/core/clock.hpp"
#include "motiongan/train/checkpoint.hpp"
#include "motiongan/train/csv_log.hpp"
#include "motiongan/train/interruption.hpp"
#include "motiongan/train/ranks.hpp"
#include "motiongan/train/run_folder.hpp"

namespace motiongan {

/// Called after every iteration; returns true to stop the run.
using RunCallback = std::function<bool(const Trainer& trainer)>;

/// How a run is saved and monitored; none of it changes the result of training.
struct RunOptions {
  std::filesystem::path
      save_dir{};                 ///< folder of model, checkpoint, log and split; empty: nothing is written
  bool resume = false;            ///< continue the run in save_dir
  double save_every_minutes = 5;  ///< a checkpoint is also written when the run ends or is stopped
  std::size_t log_every = 1;      ///< iterations between rows of the log; each row waits for the device
  double max_minutes = 0;         ///< stop after this time; 0: no limit
  std::function<bool()> should_stop = {};  ///< called after every iteration; true stops the run
  /// Called often, also within an iteration; true stops the run at once. An iteration that takes longer than
  /// long_iteration is given up then, and the run is saved as it was before it.
  std::function<bool()> interrupted = {};
  double long_iteration = 0.5;                      ///< seconds
  Warn warn = {};                                   ///< receives warnings; empty: they go to standard error
  std::shared_ptr<const io::FolderLock> lock = {};  ///< the lock of save_dir, if the caller holds it already
  /// Called with every row of the log.
  std::function<void(std::size_t iteration, std::span<const NamedLoss> losses)> report = {};
  std::vector<RunCallback> callbacks = {};  ///< called in this order, before a periodic checkpoint
  RunNotes notes{};                         ///< stored in the checkpoint; read_run_record() returns them

  void list_fields(FieldList& list) {
    list.add(max_minutes, {.key = "max_minutes",
                           .help = "stop (and save) after that long; 0: no limit",
                           .range = Range::at_least(0),
                           .option = "--minutes"});
    list.add(save_every_minutes, {.key = "save_every_minutes",
                                  .help = "minutes between two checkpoints; 0: only at the end",
                                  .range = Range::at_least(0),
                                  .option = "--save-every"});
    list.add(
        log_every,
        {.key = "log_every", .help = "iterations between two rows of log.csv", .range = Range::at_least(1)});
  }
};

/// The loss called `name`; NaN if there is none.
inline double loss_of(std::span<const NamedLoss> losses, std::string_view name) {
  for (const NamedLoss& loss : losses)
    if (name == loss.name) return loss.value;
  return std::numeric_limits<double>::quiet_NaN();
}

/// How a run ended.
struct RunResult {
  std::size_t iterations = 0;  ///< done in total, including those before resuming
  bool stopped = false;        ///< whether it ended before all iterations were done
};

namespace detail {

/// Stops the run `minutes` from now.
inline RunCallback time_limit(double minutes) {
  return
      [minutes, start = clock_seconds()](const Trainer&) { return clock_seconds() - start >= minutes * 60; };
}

/// Logs (if there is a log) and reports the losses every `every` iterations and after the last one.
inline RunCallback log_rows(std::shared_ptr<CsvLog> log, std::size_t every,
                            decltype(RunOptions::report) report) {
  return [log = std::move(log), report = std::move(report), every, start = clock_seconds(), last_row = 0.0,
          rows_since = std::size_t{0}](const Trainer& trainer) mutable {
    ++rows_since;
    const std::size_t iteration = trainer.iteration();
    if (iteration % every != 0 && iteration != trainer.iterations()) return false;
    const std::vector<NamedLoss> losses = trainer.named_losses();
    const double now = clock_seconds() - start;
    std::vector<double> row{now, static_cast<double>(rows_since) / std::max(now - last_row, 1e-9)};
    last_row = now;
    rows_since = 0;
    for (const auto& [name, value] : losses) {
      if (!std::isfinite(value))
        throw DivergedError("training diverged by iteration ", iteration, " (", name, " is ", value,
                            "); the last checkpoint is kept; try a lower learning rate");
      row.push_back(value);
    }
    if (log) log->append(iteration, row);
    if (report) report(iteration, losses);
    return false;
  };
}

/// The losses of healthy training stay far below this; Wasserstein estimates reach some thousands at most.
constexpr double largest_plausible_loss = 1e6;

/// A loss whose size shows that training has probably diverged.
inline std::optional<NamedLoss> implausible_loss(const Trainer& trainer) {
  for (const NamedLoss& loss : trainer.named_losses())
    if (!(std::abs(loss.value) < largest_plausible_loss)) return loss;
  return std::nullopt;
}

/// What follows the message of a failed device: how far the run came, and what is left of it.
inline std::string after_failure(std::size_t iteration, const RunFiles& files) {
  const std::string at = concat("\nthe run stopped after iteration ", iteration, "; ");
  if (files.folder.empty()) return at + "nothing of it was saved";
  if (!std::filesystem::exists(files.checkpoint()))
    return concat(at, "no checkpoint was written to ", files.folder.string(), " yet: start it again");
  return concat(at, "the last checkpoint in ", files.folder.string(), " is kept: resume the run from it");
}

/// A run in progress: the loop of run_training().
class RunLoop {
 public:
  RunLoop(Trainer& trainer, const std::function<void(const std::filesystem::path&)>& write_split,
          const RunOptions& run)
      : trainer_(trainer), run_(run), first_(trainer.iteration()) {
    if (!run_.warn)
      run_.warn = [](const std::string& text) {
        std::fprintf(stderr, "motiongan: warning: %s\n", text.c_str());
      };
    if (!is_first()) run_.callbacks.clear(), run_.report = {};
    if (!run_.save_dir.empty() && is_first()) open(write_split);
    if (ranks() != nullptr) {
      require_same_training(trainer_, *ranks());
      take_state_of_first(trainer_, *ranks());
      first_ = trainer_.iteration();
    }
    if (is_first()) callbacks_.push_back(log_rows(log_, run_.log_every, run_.report));
    if (run_.max_minutes > 0) callbacks_.push_back(time_limit(run_.max_minutes));
    if (run_.should_stop) callbacks_.push_back([this](const Trainer&) { return run_.should_stop(); });
    if (run_.interrupted) callbacks_.push_back([this](const Trainer&) { return run_.interrupted(); });
    callbacks_.insert(callbacks_.end(), run_.callbacks.begin(), run_.callbacks.end());
  }

  RunResult train() {
    bool stopped = false;
    // A rank cannot give up an iteration that others are in.
    Interruption interruption(trainer_, ranks() == nullptr ? run_.interrupted : nullptr, run_.long_iteration);
    while (trainer_.iteration() < trainer_.iterations() && !stopped) {
      const bool given_up = !interruption.iterate();
      stopped = any_stops([&] {
        if (given_up || after_iteration()) return true;
        if (run_.save_every_minutes > 0 && clock_seconds() - saved_ >= run_.save_every_minutes * 60)
          save_or_warn();
        return false;
      });
    }
    any_stops([&] {
      save();
      return false;
    });
    return {trainer_.iteration(), trainer_.iteration() < trainer_.iterations()};
  }

 private:
  Communicator* ranks() const { return trainer_.parallel().ranks.get(); }
  bool is_first() const { return trainer_.parallel().is_first(); }

  /// Whether this rank, by what `work` returns, or another one wants to stop. If `work` throws, the others
  /// are told; they throw Error then.
  template <class Work>
  bool any_stops(const Work& work) {
    if (ranks() == nullptr) return work();
    try {
      const bool stop = work();
      return tell_ranks(*ranks(), {.stop = stop});
    } catch (const RankError&) {
      throw;
    } catch (...) {
      const std::exception_ptr problem = std::current_exception();
      tell_ranks(*ranks(), {.failed = true});
      std::rethrow_exception(problem);
    }
  }

  void open(const std::function<void(const std::filesystem::path&)>& write_split) {
    std::filesystem::create_directories(run_.save_dir);
    folder_.emplace(RunFiles{run_.save_dir}, run_.lock);
    const RunFiles& files = folder_->files();
    if (run_.resume)
      folder_->resume(trainer_, run_.warn);
    else
      require(!std::filesystem::exists(files.checkpoint()), files.checkpoint().string(),
              " already holds a run; resume it, or choose another folder");
    first_ = trainer_.iteration();
    // A log without a checkpoint belongs to a run that was killed before its first save.
    if (!run_.resume && std::filesystem::exists(files.log()))
      std::filesystem::rename(files.log(), files.unsaved_log());
    write_split(files.split());
    std::vector<std::string> names{"seconds", "iterations_per_second"};
    for (const std::string& name : trainer_.loss_names()) names.push_back(name);
    log_ = run_.resume ? continued_log(files.log(), names, first_, files.damaged_log(), run_.warn)
                       : std::make_shared<CsvLog>(files.log(), names);
  }

  /// Calls all callbacks; returns whether to stop. If one fails, the iteration itself is whole and is saved.
  bool after_iteration() {
    try {
      bool stop = false;
      for (const RunCallback& callback : callbacks_) stop |= callback(trainer_);
      return stop;
    } catch (const DivergedError&) {
      throw;
    } catch (...) {
      const std::exception_ptr problem = std::current_exception();
      save_or_warn();
      std::rethrow_exception(problem);
    }
  }

  void save() {
    if (!folder_) return;
    const bool knows_losses = trainer_.iteration() > first_;
    const std::optional<NamedLoss> large = knows_losses ? implausible_loss(trainer_) : std::nullopt;
    folder_->save(trainer_, run_.notes, large.has_value());
    saved_ = clock_seconds();
    if (large && !std::exchange(warned_, true))
      run_.warn(concat("training has probably diverged: at iteration ", trainer_.iteration(), ", ",
                       large->name, " is ", large->value, "; the last save before is kept as ",
                       folder_->files().previous_checkpoint().string(), "; try a lower learning rate"));
  }

  /// A full disk may have room again at the next save.
  void save_or_warn() {
    try {
      save();
    } catch (const DivergedError&) {
      throw;
    } catch (const DeviceError&) {
      throw;
    } catch (const Error& error) {
      run_.warn(concat(error.what(), "; iteration ", trainer_.iteration(),
                       " is not saved, the next save tries again"));
      saved_ = clock_seconds();
    }
  }

  Trainer& trainer_;
  RunOptions run_;
  std::optional<RunFolder> folder_;
  std::shared_ptr<CsvLog> log_;
  std::vector<RunCallback> callbacks_;
  std::size_t first_;  ///< the iteration at which this start began
  double saved_ = clock_seconds();
  bool warned_ = false;
};

}  // namespace detail

/// Trains until all iterations are done, the time is up, or should_stop(), interrupted() or a callback
/// returns true; then saves. `write_split(path)` writes which clips are for training and which for testing.
/// Columns of the log: iteration, seconds (since this start or resume), iterations_per_second, and the
/// trainer's losses. A periodic save that fails is a warning, and the next one tries again. If a callback or
/// report() throws, the run is saved first. Throws Error if save_dir already holds a run and `resume` is off,
/// or if another process trains there, and DivergedError if a loss or a tensor to be saved is not finite; the
/// last save is kept.
inline RunResult run_training(Trainer& trainer,
                              const std::function<void(const std::filesystem::path&)>& write_split,
                              const RunOptions& run) {
  check_options(run);
  detail::RunLoop loop(trainer, write_split, run);
  try {
    return loop.train();
  } catch (const DeviceError& error) {
    throw DeviceError(error.what(), detail::after_failure(trainer.iteration(), {run.save_dir}));
  } catch (const std::bad_alloc&) {
    throw DeviceError("out of host memory: end other programs, or use a smaller --batch",
                      detail::after_failure(trainer.iteration(), {run.save_dir}));
  }
}

}  // namespace motiongan

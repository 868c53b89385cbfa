// A whole training run with any trainer: iterations, log, checkpoints, stopping and resuming.
#pragma once
#include <cmath>
#include <functional>
#include <memory>
#include <new>
#include <optional>

#include "motiongan/core/clock.hpp"
#include "motiongan/train/checkpoint.hpp"
#include "motiongan/train/csv_log.hpp"

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

/// The files in a save_dir; there is one file for each network that the run trains.
struct RunFiles {
  std::filesystem::path folder;
  std::filesystem::path generator() const { return folder / "generator.safetensors"; }
  std::filesystem::path critic() const { return network("critic"); }
  std::filesystem::path checkpoint() const { return folder / "checkpoint.safetensors"; }
  std::filesystem::path log() const { return folder / "log.csv"; }
  /// Where a new run moves the log of a run that was killed before its first checkpoint.
  std::filesystem::path unsaved_log() const { return folder / "log.unsaved.csv"; }
  std::filesystem::path split() const { return folder / "split.tsv"; }
  std::filesystem::path network(const std::string& name) const { return folder / (name + ".safetensors"); }
};

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

/// Logs (if there is a log) and reports the losses every `every` iterations and after the last one. Throws
/// DivergedError if a loss is not finite.
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
        throw DivergedError("training diverged at iteration ", iteration, " (", name, " is ", value,
                            "); the last checkpoint is kept; try a lower learning rate");
      row.push_back(value);
    }
    if (log) log->append(iteration, row);
    if (report) report(iteration, losses);
    return false;
  };
}

/// Writes the checkpoint and one file for each network.
inline void save_run(Trainer& trainer, const RunFiles& files, const RunNotes& notes) {
  save_checkpoint(trainer, files.checkpoint(), notes);
  const std::vector<TrainedPart> parts = trainer.parts();
  trainer.save_model(files.network(parts.front().name));
  for (std::size_t i = 1; i < parts.size(); ++i) {
    io::SafeTensors file;
    io::save_parameters(parts[i].parameters, file);
    file.write(files.network(parts[i].name));
  }
}

/// What follows the message of a failed device: how far the run came, and what is left of it.
inline std::string after_failure(std::size_t iteration, const RunFiles& files) {
  const std::string at = concat("\nthe run stopped after iteration ", iteration, "; ");
  if (files.folder.empty()) return at + "nothing of it was saved";
  if (!std::filesystem::exists(files.checkpoint()))
    return concat(at, "no checkpoint was written to ", files.folder.string(), " yet: start it again");
  return concat(at, "the last checkpoint in ", files.folder.string(), " is kept: resume the run from it");
}

}  // namespace detail

/// Trains until all iterations are done, the time is up, or should_stop() or a callback returns true; then
/// saves. `write_split(path)` writes which clips are for training and which for testing. Columns of the log:
/// iteration, seconds (since this start or resume), iterations_per_second, and the trainer's losses. Throws
/// Error if save_dir already holds a run and `resume` is off, DivergedError if a loss is not finite, and
/// DeviceError, saying from where the run can be resumed, if the device fails; the last checkpoint is kept.
inline RunResult run_training(Trainer& trainer,
                              const std::function<void(const std::filesystem::path&)>& write_split,
                              const RunOptions& run) {
  const RunFiles files{run.save_dir};
  const bool keeps = !run.save_dir.empty();
  check_options(run);
  std::shared_ptr<CsvLog> log;
  if (keeps) {
    std::filesystem::create_directories(run.save_dir);
    if (run.resume)
      load_checkpoint(trainer, files.checkpoint());
    else
      require(!std::filesystem::exists(files.checkpoint()), files.checkpoint().string(),
              " already holds a run; resume it, or choose another folder");
    // A log without a checkpoint belongs to a run that was killed before its first save.
    if (!run.resume && std::filesystem::exists(files.log()))
      std::filesystem::rename(files.log(), files.unsaved_log());
    write_split(files.split());
    std::vector<std::string> names{"seconds", "iterations_per_second"};
    for (const std::string& name : trainer.loss_names()) names.push_back(name);
    log = std::make_shared<CsvLog>(
        files.log(), names, run.resume ? std::optional<std::uint64_t>(trainer.iteration()) : std::nullopt);
  }
  std::vector<RunCallback> callbacks{detail::log_rows(log, run.log_every, run.report)};
  if (run.max_minutes > 0) callbacks.push_back(detail::time_limit(run.max_minutes));
  if (run.should_stop) callbacks.push_back([&](const Trainer&) { return run.should_stop(); });
  callbacks.insert(callbacks.end(), run.callbacks.begin(), run.callbacks.end());

  auto saved = clock_seconds();
  RunResult result;
  try {
    while (trainer.iteration() < trainer.iterations() && !result.stopped) {
      trainer.iterate();
      for (const RunCallback& callback : callbacks) result.stopped |= callback(trainer);
      if (result.stopped) break;
      if (keeps && run.save_every_minutes > 0 && clock_seconds() - saved >= run.save_every_minutes * 60) {
        detail::save_run(trainer, files, run.notes);
        saved = clock_seconds();
      }
    }
    if (keeps) detail::save_run(trainer, files, run.notes);
  } catch (const DeviceError& error) {
    throw DeviceError(error.what(), detail::after_failure(trainer.iteration(), files));
  } catch (const std::bad_alloc&) {
    throw DeviceError("out of host memory: end other programs, or use a smaller --batch",
                      detail::after_failure(trainer.iteration(), files));
  }
  result.stopped = trainer.iteration() < trainer.iterations();
  result.iterations = trainer.iteration();
  return result;
}

}  // namespace motiongan

// A whole training run of any trainer: iterations, log, checkpoints, stopping and resuming.
#pragma once
#include <chrono>
#include <cmath>
#include <functional>

#include "motiongan/train/checkpoint.hpp"
#include "motiongan/train/csv_log.hpp"

namespace motiongan {

/// How a run is kept and watched; none of it changes what is computed. `Losses` is what the trainer reports.
template <class Losses>
struct BasicRunOptions {
  std::filesystem::path
      save_dir{};       ///< folder for generator, checkpoint, log and split; empty: nothing is written
  bool resume = false;  ///< continue the run in save_dir
  double save_every_minutes = 5;  ///< a checkpoint is also written at the end, and when the run is stopped
  std::size_t log_every = 1;      ///< iterations between two rows of the log; each row waits for the device
  double max_minutes = 0;         ///< stop after that long; 0: no limit
  std::function<bool()> should_stop = {};  ///< asked after every iteration
  std::function<void(std::size_t iteration, const Losses&)> report =
      {};            ///< called with every row of the log
  RunNotes notes{};  ///< kept in the checkpoint, where read_run_record() finds them
};

/// What a save_dir holds. A run has those of the networks that it trains.
struct RunFiles {
  std::filesystem::path folder;
  std::filesystem::path generator() const { return folder / "generator.safetensors"; }
  std::filesystem::path critic() const { return network("critic"); }
  std::filesystem::path checkpoint() const { return folder / "checkpoint.safetensors"; }
  std::filesystem::path log() const { return folder / "log.csv"; }
  /// What a run logged that was killed before its first checkpoint, once another one begins in its place.
  std::filesystem::path unsaved_log() const { return folder / "log.unsaved.csv"; }
  std::filesystem::path split() const { return folder / "split.tsv"; }
  std::filesystem::path network(const std::string& name) const { return folder / (name + ".safetensors"); }
};

/// How a run ended.
struct RunResult {
  std::size_t iterations = 0;  ///< done in all, earlier runs counted in
  bool stopped = false;        ///< before all were done
};

namespace detail {

/// Trains until `iterations` are done, time is up or should_stop() says so; then saves. A trainer is what
/// save_checkpoint() takes, with iterate(), losses() and, for its Losses, columns(losses).
/// Columns of the log: iteration, seconds (of this run), iterations_per_second, then those of the losses.
template <class Trainer, class Data, class Losses>
RunResult run_training(Trainer& trainer, const Data& data, std::size_t iterations,
                       const BasicRunOptions<Losses>& run) {
  using Clock = std::chrono::steady_clock;
  const RunFiles files{run.save_dir};
  const bool keeps = !run.save_dir.empty();
  require(run.log_every > 0, "log_every is 0; give the number of iterations between two rows of the log");
  std::optional<CsvLog> log;
  if (keeps) {
    std::filesystem::create_directories(run.save_dir);
    if (run.resume)
      load_checkpoint(trainer, files.checkpoint());
    else
      require(!std::filesystem::exists(files.checkpoint()), files.checkpoint().string(),
              " already holds a run; resume it, or choose another folder");
    // A log without a checkpoint is of a run that was killed before it saved anything.
    if (!run.resume && std::filesystem::exists(files.log()))
      std::filesystem::rename(files.log(), files.unsaved_log());
    data.write_split(files.split());
    std::vector<std::string> names{"seconds", "iterations_per_second"};
    for (const LossColumn& column : columns(Losses{})) names.emplace_back(column.first);
    log.emplace(files.log(), names,
                run.resume ? std::optional<std::uint64_t>(trainer.iteration()) : std::nullopt);
  }
  const auto save = [&] {
    if (!keeps) return;
    save_checkpoint(trainer, files.checkpoint(), run.notes);
    const std::vector<TrainedPart> parts = trainer.parts();  // of which the first is the model
    trainer.model().save(files.network(parts.front().name));
    for (const TrainedPart& part : parts) {
      if (part.name == parts.front().name) continue;
      io::SafeTensors file;
      io::save_parameters(part.parameters, file);
      file.write(files.network(part.name));
    }
  };
  const auto seconds_since = [](Clock::time_point then) {
    return std::chrono::duration<double>(Clock::now() - then).count();
  };
  const Clock::time_point start = Clock::now();
  Clock::time_point saved = start;
  double last_row = 0;
  std::size_t rows_since = 0;
  RunResult result;
  while (trainer.iteration() < iterations) {
    trainer.iterate();
    ++rows_since;
    if (trainer.iteration() % run.log_every == 0 || trainer.iteration() == iterations) {
      const Losses losses = trainer.losses();
      const double now = seconds_since(start);
      std::vector<double> row{now, static_cast<double>(rows_since) / std::max(now - last_row, 1e-9)};
      last_row = now;
      rows_since = 0;
      for (const auto& [name, value] : columns(losses)) {
        if (!std::isfinite(value))
          throw Error("training diverged at iteration ", trainer.iteration(), " (", name, " is ", value,
                      "); the last checkpoint is kept; try a lower learning rate");
        row.push_back(value);
      }
      if (log) log->append(trainer.iteration(), row);
      if (run.report) run.report(trainer.iteration(), losses);
    }
    const bool out_of_time = run.max_minutes > 0 && seconds_since(start) >= run.max_minutes * 60;
    if (out_of_time || (run.should_stop && run.should_stop())) {
      result.stopped = trainer.iteration() < iterations;
      break;
    }
    if (run.save_every_minutes > 0 && seconds_since(saved) >= run.save_every_minutes * 60) {
      save();
      saved = Clock::now();
    }
  }
  save();
  result.iterations = trainer.iteration();
  return result;
}

}  // namespace detail
}  // namespace motiongan

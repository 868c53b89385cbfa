// A whole training run: iterations, log, checkpoints, stopping and resuming.
#pragma once
#include <chrono>
#include <functional>

#include "motiongan/train/checkpoint.hpp"
#include "motiongan/train/csv_log.hpp"

namespace motiongan {

/// How a run is kept and watched; none of it changes what is computed.
struct RunOptions {
  std::filesystem::path
      save_dir{};       ///< folder for generator, checkpoint, log and split; empty: nothing is written
  bool resume = false;  ///< continue the run in save_dir
  double save_every_minutes = 5;  ///< a checkpoint is also written at the end, and when the run is stopped
  std::size_t log_every = 1;      ///< iterations between two rows of the log; each row waits for the device
  double max_minutes = 0;         ///< stop after that long; 0: no limit
  std::function<bool()> should_stop = {};  ///< asked after every iteration
  std::function<void(std::size_t iteration, const DvganLosses&)> report =
      {};            ///< called with every row of the log
  RunNotes notes{};  ///< kept in the checkpoint, where read_run_record() finds them
};

/// What a save_dir holds.
struct RunFiles {
  std::filesystem::path folder;
  std::filesystem::path generator() const { return folder / "generator.safetensors"; }
  std::filesystem::path critic() const { return folder / "critic.safetensors"; }
  std::filesystem::path checkpoint() const { return folder / "checkpoint.safetensors"; }
  std::filesystem::path log() const { return folder / "log.csv"; }
  std::filesystem::path split() const { return folder / "split.tsv"; }
};

/// How a run ended.
struct RunResult {
  std::size_t iterations = 0;  ///< done in all, earlier runs counted in
  bool stopped = false;        ///< before options.iterations were done
};

/// Trains until options.iterations are done, time is up or should_stop() says so; then saves.
/// Columns of the log: iteration, seconds (of this run), iterations_per_second, wasserstein, penalty,
/// generator_loss.
inline RunResult train(Dvgan& model, const motion::Dataset& data, const DvganTrainOptions& options,
                       const RunOptions& run = {}) {
  using Clock = std::chrono::steady_clock;
  const RunFiles files{run.save_dir};
  const bool keeps = !run.save_dir.empty();
  require(run.log_every > 0, "log_every is 0; give the number of iterations between two rows of the log");
  DvganTrainer trainer(model, data, options);
  std::optional<CsvLog> log;
  if (keeps) {
    std::filesystem::create_directories(run.save_dir);
    if (run.resume)
      load_checkpoint(trainer, files.checkpoint());
    else
      require(!std::filesystem::exists(files.checkpoint()), files.checkpoint().string(),
              " already holds a run; resume it, or choose another folder");
    data.write_split(files.split());
    log.emplace(files.log(),
                std::vector<std::string>{"seconds", "iterations_per_second", "wasserstein", "penalty",
                                         "generator_loss"},
                run.resume ? std::optional<std::uint64_t>(trainer.iteration()) : std::nullopt);
  }
  const auto save = [&] {
    if (!keeps) return;
    save_checkpoint(trainer, files.checkpoint(), run.notes);
    model.save(files.generator());
    io::SafeTensors critic;
    io::save_parameters(named_parameters(trainer.critic()), critic);
    critic.write(files.critic());
  };
  const auto seconds_since = [](Clock::time_point then) {
    return std::chrono::duration<double>(Clock::now() - then).count();
  };
  const Clock::time_point start = Clock::now();
  Clock::time_point saved = start;
  double last_row = 0;
  std::size_t rows_since = 0;
  RunResult result;
  while (trainer.iteration() < options.iterations) {
    trainer.iterate();
    ++rows_since;
    if (trainer.iteration() % run.log_every == 0 || trainer.iteration() == options.iterations) {
      const DvganLosses losses = trainer.losses();
      const double now = seconds_since(start);
      const double row[] = {now, static_cast<double>(rows_since) / std::max(now - last_row, 1e-9),
                            losses.wasserstein, losses.penalty, losses.generator};
      last_row = now;
      rows_since = 0;
      if (!std::isfinite(losses.wasserstein) || !std::isfinite(losses.penalty) ||
          !std::isfinite(losses.generator))
        throw Error("training diverged at iteration ", trainer.iteration(), " (Wasserstein estimate ",
                    losses.wasserstein, ", penalty ", losses.penalty,
                    "); the last checkpoint is kept; try a lower learning rate");
      if (log) log->append(trainer.iteration(), row);
      if (run.report) run.report(trainer.iteration(), losses);
    }
    const bool out_of_time = run.max_minutes > 0 && seconds_since(start) >= run.max_minutes * 60;
    if (out_of_time || (run.should_stop && run.should_stop())) {
      result.stopped = trainer.iteration() < options.iterations;
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

}  // namespace motiongan

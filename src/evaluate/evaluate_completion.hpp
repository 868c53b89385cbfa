// Shared by the parts of `motiongan evaluate completion`.
#pragma once
#include "motiongan/experiments/completion_models.hpp"
#include "motiongan/experiments/completion_table.hpp"
#include "motiongan/networks/dvgan_critic.hpp"
#include "shared/command.hpp"
#include "shared/ranks.hpp"
#include "train/training_budget.hpp"

namespace motiongan::command {

struct CompletionArgs {
  std::string folder, layout = "auto", save;
  std::vector<std::string> actions, train_actions;
  std::vector<std::string> models{"zero", "lstm", "seq2seq", "erd", "lstm-3lr", "dvgan"};
  bool evaluate_only = false, dry_run = false;

  TrainingBudget predictors{0, 10'000}, dvgan{0, 2'000};
  double minutes = 0;
  std::size_t hidden = 0, batch = 16;  // of the predictors

  std::size_t dvgan_hidden = 256, dvgan_batch = 64, dvgan_frames = 0, dvgan_stride = 2, critic_steps = 10;
  CriticKind critic = CriticKind::cnn;
  double completion_share = 0.5;

  std::uint64_t seed = 1;
  double save_every_minutes = 5;
  std::size_t log_every = 10;
  std::size_t samples = 10;

  /// The options that a model's checkpoint stores.
  void list_predictor_fields(FieldList& list) {
    list.add(hidden, {.key = "hidden",
                      .help = "width; 0: as in its paper (lstm 256, seq2seq 1024, the others 1000)"});
    list.add(batch, {.key = "batch", .help = "windows in a step", .range = Range::at_least(1)});
  }
  void list_dvgan_fields(FieldList& list) {
    list.add(dvgan_hidden, {.key = "dvgan_hidden", .help = "width", .range = Range::at_least(1)});
    list.add(dvgan_batch, {.key = "dvgan_batch", .help = "windows in a step", .range = Range::at_least(1)});
    list.add(dvgan_frames, {.key = "dvgan_frames",
                            .help = "frames of a window; 0: 64 for h36m, 32 for cmu, whose running clips are "
                                    "too short for more"});
    list.add(dvgan_stride, {.key = "dvgan_stride",
                            .help = "use every n-th frame of the protocol; 2: 12.5 per second",
                            .range = Range::between(1, 25)});
    list.add(critic, {.key = "critic", .help = "cnn or rnn"});
    list.add(critic_steps,
             {.key = "critic_steps", .help = "critic steps in each iteration", .range = Range::at_least(1)});
    list.add(completion_share,
             {.key = "completion_share",
              .help = "fraction of the steps whose fakes continue real frames; the paper: 0",
              .range = Range::between(0, 1)});
  }
  FieldList kept_fields(bool of_dvgan) {
    FieldList list;
    list.add(seed, {.key = "seed", .help = "seed of the initial weights, batches and noise"});
    if (of_dvgan)
      list_dvgan_fields(list);
    else
      list_predictor_fields(list);
    return list;
  }
};

/// "walking, running".
std::string listed(const std::vector<std::string>& names);

/// The folder of a model's run.
fs::path folder_of(const CompletionArgs& args, const std::string& model);

/// Trains those of args.models that have not used up their budget. If one diverges, that is printed and it
/// stays as it was last saved. Ranks train different models. Returns false if a signal stopped it. Options
/// that the command line of `verb` does not give are taken from existing runs.
bool train_completion_models(const Context& context, const CompletionData& data, const CompletionArgs& args,
                             const CLI::App& verb, SharedRuns& runs);

/// Throws Error if the run was trained on other files.
void require_same_data(const CompletionData& data, const fs::path& checkpoint);

/// Measures the models in args.save and prints the tables; writes table.csv, table.md and table.json there.
void report_completion(const Context& context, const CompletionData& data, const CompletionArgs& args);

}  // namespace motiongan::command

// How a training of the command begins and ends, whatever it trains.
#pragma once
#include "motiongan/train/run.hpp"
#include "shared/options.hpp"

namespace motiongan::command {

/// How a run is kept: the options of every training verb.
struct RunArgs {
  std::string save;
  bool resume = false;
  RunOptions run;
};

/// Adds --save, --resume, --minutes, --save-every and --log-every. `save_default` is the default in --help.
void add_run_options(CLI::App& verb, RunArgs& args, const std::string& save_default);

/// The options of the run of a checkpoint, as take_note() reads them; empty if there is no checkpoint, or if
/// it does not hold any.
std::string options_note(const fs::path& checkpoint);

/// save/NAME, NAME being the folder's of clips; `builtin` if there is none.
fs::path default_save(const std::string& clips, const char* builtin);

/// Throws Error if the command line gives both a folder of clips and --procedural.
void require_one_source(const CLI::App& verb);

struct RunStart {
  fs::path folder;
  std::size_t done = 0;  ///< iterations
};

/// Finds where the run is kept and, for one that is resumed, calls `take(note, checkpoint)` with the note of
/// its options. `folder` and `procedural` are the clips of the command line. Throws Error if there are no
/// data, two kinds of data, no run to resume, or a run in the way.
RunStart begin_run(const RunArgs& args, const fs::path& save, bool has_data, const CLI::App& verb,
                   const std::function<void(const std::string& note, const fs::path& checkpoint)>& take);

/// Whether a resumed run has all its iterations already; says so.
bool is_done(const RunStart& start, const RunArgs& args, std::size_t iterations);

/// "folder, every 5 min and at the end".
void print_saved_to(const fs::path& folder, double save_every_minutes);

/// How the progress line calls the losses of the log: pairs of a column and its short name. Columns that are
/// not listed are not shown; an empty list shows all.
using ShownLosses = std::vector<std::pair<std::string_view, const char*>>;

/// Runs a training with a progress line and --resume, Ctrl-C and the note of its options; says how it ended
/// and how to continue. `verb` is "train dvgan".
RunResult run_shown(Trainer& trainer, const std::function<void(const fs::path&)>& write_split,
                    const RunArgs& args, const RunStart& start, const std::string& note,
                    const ShownLosses& shown_losses, const char* verb);

/// The exit status of a verb that a signal may have stopped.
int exit_status();

}  // namespace motiongan::command

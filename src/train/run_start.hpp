// How the training verbs start, run and report.
#pragma once
#include "motiongan/train/run.hpp"
#include "shared/options.hpp"
#include "train/preview.hpp"
#include "train/training_size.hpp"

namespace motiongan::command {

/// Options common to all training verbs.
struct RunArgs {
  std::string save;
  bool resume = false, dry_run = false;
  double preview = 0;  ///< minutes between two pages; 0: none
  RunOptions run;
  Parallel parallel;  ///< the ranks are those of begin_run()
};

/// Adds --save, --resume, --dry-run, --minutes, --save-every and --log-every; and --preview, if the verb
/// shows what its model makes (`previews`). `save_default` is the default
/// in --help.
void add_run_options(CLI::App& verb, RunArgs& args, const std::string& save_default, bool previews);

/// The options stored in a checkpoint, as take_note() reads them; empty if there is no checkpoint or it has
/// none.
std::string options_note(const fs::path& checkpoint);

/// save/NAME, where NAME is the name of the folder of clips; save/`builtin` if `clips` is empty.
fs::path default_save(const std::string& clips, const char* builtin);

/// Throws Error if the command line gives both a folder of clips and --procedural.
void require_one_source(const CLI::App& verb);

struct RunStart {
  fs::path folder;
  std::size_t done = 0;                        ///< iterations
  std::shared_ptr<const io::FolderLock> lock;  ///< of the folder, if it is there already
};

/// Joins the other ranks, if there are any. Finds the folder of the run (--save, or else `save`) and, if it
/// is resumed, calls `take(note, checkpoint)` with its stored options. `has_data`: the command line names
/// clips. Throws Error if there are no clips, two sources of clips, no run to resume, or already a run in the
/// folder.
RunStart begin_run(RunArgs& args, const fs::path& save, bool has_data, const CLI::App& verb,
                   const std::function<void(const std::string& note, const fs::path& checkpoint)>& take);

/// The folder of a run, made where it is missing, and removed again if nothing was written to it: a training
/// that is refused leaves no folder.
class RunFolder {
 public:
  /// A dry run makes none.
  RunFolder(const RunArgs& args, const RunStart& start);
  ~RunFolder();
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

 private:
  std::vector<fs::path> made_;  ///< the folder, then its parents
};

/// Whether a resumed run has all its iterations already; prints so if it has.
bool is_done(const RunStart& start, const RunArgs& args, std::size_t iterations);

/// "folder, every 5 min and at the end".
void print_saved_to(const fs::path& folder, double save_every_minutes);

/// The losses in the progress line: pairs of a column of the log and its short name. Other columns are not
/// shown.
using ShownLosses = std::vector<std::pair<std::string_view, const char*>>;

/// Runs a training with a progress line, handles --resume and Ctrl-C, and stores `note`, the options. Prints
/// how it ended and how to continue. `verb` is e.g. "train dvgan"; `preview` makes the motions for --preview.
RunResult run_shown(Trainer& trainer, const std::function<void(const fs::path&)>& write_split,
                    const RunArgs& args, const RunStart& start, const std::string& note,
                    const ShownLosses& shown_losses, const char* verb, Preview::Make preview = {});

/// The exit status: 0, or 128 + the signal that stopped the verb.
int exit_status();

}  // namespace motiongan::command

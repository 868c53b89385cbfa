#include "train/run_start.hpp"

#include "motiongan/train/progress.hpp"
#include "shared/ranks.hpp"
#include "shared/shell.hpp"
#include "shared/signals.hpp"

namespace motiongan::command {

void add_run_options(CLI::App& verb, RunArgs& args, const std::string& save_default, bool previews) {
  verb.add_option("--save", args.save, "folder of the run [" + save_default + "]")->type_name("DIR");
  verb.add_flag("--resume", args.resume, "continue the run in --save with its original options");
  add_dry_run(verb, args.dry_run);
  add_options(verb, fields_of(args.run), "Run");
  verb.add_option(
          "--shards", args.parallel.shards,
          "parts of a batch whose gradients are made one by one and added in one order: then the result "
          "is the same bits on any number of ranks (mpirun); a power of two; 0: a part for each rank")
      ->check(CLI::Range(0, 65536))
      ->capture_default_str()
      ->group("Run");
  if (!previews) return;
  verb.add_option("--preview", args.preview,
                  "write preview.html and preview.png to --save every so many minutes: what the model makes "
                  "of fixed prompts; 0: never")
      ->type_name("MINUTES")
      ->check(CLI::Range(0.0, 1e6))
      ->group("Run");
}

std::string options_note(const fs::path& checkpoint) {
  if (!fs::exists(checkpoint)) return {};
  const RunRecord record = read_run_record(checkpoint);
  const auto note = record.notes.find("options");
  return note == record.notes.end() ? std::string() : note->second;
}

fs::path default_save(const std::string& clips, const char* builtin) {
  if (clips.empty()) return fs::path("save") / builtin;
  fs::path folder = fs::absolute(clips).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  const fs::path name = folder.stem();
  return fs::path("save") / (name.empty() ? "run" : name);
}

void require_one_source(const CLI::App& verb) {
  require(!(verb.count("FOLDER") && verb.count("--procedural")),
          "give a folder of clips or --procedural, not both");
}

namespace {

/// What a run that is resumed says of itself.
struct SavedRun {
  std::string done = "0", note, shards = "0";
};

/// Finds the folder, and what is in it. Only the first rank need have it.
SavedRun find_run(const RunArgs& args, RunStart& start) {
  SavedRun saved;
  if (args.parallel.is_first()) {
    const RunFiles files{start.folder};
    if (fs::is_directory(start.folder)) start.lock = std::make_shared<const io::FolderLock>(start.folder);
    if (!args.resume) {
      require(!fs::exists(files.checkpoint()), start.folder.string(),
              " already holds a run; continue it with --resume, or choose another --save");
    } else {
      require(fs::exists(files.checkpoint()), "there is no run to resume in ", start.folder.string(), " (no ",
              files.checkpoint().filename().string(), " there)");
      const RunRecord record = read_run_record(files.checkpoint());
      saved.done = std::to_string(record.iteration);
      saved.note = options_note(files.checkpoint());
      if (const auto shards = record.notes.find("shards"); shards != record.notes.end())
        saved.shards = shards->second;
    }
  }
  if (Communicator* const ranks = args.parallel.ranks.get())
    for (std::string* const text : {&saved.done, &saved.note, &saved.shards})
      *text = broadcast_text(*ranks, std::move(*text));
  return saved;
}

}  // namespace

RunStart begin_run(RunArgs& args, const fs::path& save, bool has_data, const CLI::App& verb,
                   const std::function<void(const std::string&, const fs::path&)>& take) {
  args.parallel.ranks = join_ranks();
  require_one_source(verb);
  if (verb.count("--procedural")) require(has_data, "--procedural is 0, expected at least 1 clip");
  require(has_data || args.resume,
          "there is nothing to train on: give a folder of BVH clips, or --procedural");
  require(has_data || !args.save.empty(), "--resume needs --save DIR, the folder of the run");
  RunStart start{args.save.empty() ? save : fs::path(args.save), 0, nullptr};
  const SavedRun saved = find_run(args, start);
  if (!args.resume) return start;
  start.done = std::stoul(saved.done);
  require(verb.count("--shards") == 0 || std::to_string(args.parallel.shards) == saved.shards,
          "the run was started with --shards ", saved.shards, "; it goes on with that");
  args.parallel.shards = std::stoul(saved.shards);
  const fs::path checkpoint = RunFiles{start.folder}.checkpoint();
  if (!saved.note.empty())
    take(saved.note, checkpoint);
  else
    require(has_data, checkpoint.string(),
            " does not say what it was trained on; give the original folder and options");
  return start;
}

RunFolder::RunFolder(const RunArgs& args, const RunStart& start) {
  if (args.dry_run) return;
  for (fs::path at = start.folder; !at.empty() && !fs::exists(at); at = at.parent_path()) made_.push_back(at);
  make_folder(start.folder);
}
RunFolder::~RunFolder() {
  std::error_code is_not_empty;
  for (const fs::path& folder : made_)
    if (!fs::remove(folder, is_not_empty)) break;
}

bool is_done(const RunStart& start, const RunArgs& args, std::size_t iterations) {
  if (!args.resume || start.done < iterations) return false;
  fmt::print("{} has all its {} already; train longer with --iterations N\n", start.folder.string(),
             counted(start.done, "iteration"));
  return true;
}

void print_saved_to(const fs::path& folder, double save_every_minutes) {
  const std::string often =
      save_every_minutes > 0 ? fmt::format("every {} and ", duration(save_every_minutes * 60)) : "";
  print_fact("saved to", fmt::format("{}, {}at the end", folder.string(), often));
}

RunResult run_shown(Trainer& trainer, const std::function<void(const fs::path&)>& write_split,
                    const RunArgs& args, const RunStart& start, const std::string& note,
                    const ShownLosses& shown_losses, const char* verb, Preview::Make make_preview) {
  trainer.set_parallel(args.parallel);
  const bool shows = args.parallel.is_first();
  if (args.parallel.size() > 1)
    print_fact("ranks",
               fmt::format("{}, each with {} of {} samples of a batch{}", args.parallel.size(),
                           trainer.batch() / args.parallel.size(), trainer.batch(),
                           args.parallel.shards > 0
                               ? fmt::format(" in shards of {}", trainer.batch() / args.parallel.shards)
                               : std::string()));
  ProgressBar bar;
  if (shows) bar.start(trainer.iterations(), start.done);
  RunOptions run = args.run;
  run.save_dir = start.folder;
  run.resume = args.resume;
  run.notes = {{"options", note}};
  if (args.parallel.shards > 0) run.notes["shards"] = std::to_string(args.parallel.shards);
  run.lock = start.lock;
  run.interrupted = [] { return stop_requested(); };
  run.warn = [&](const std::string& text) { bar.note("warning: " + text); };
  run.report = [&](std::size_t iteration, std::span<const NamedLoss> losses) {
    std::vector<NamedValue> values;
    for (const auto& [name, short_name] : shown_losses)
      values.emplace_back(short_name, (name == "recall1" ? 100 : 1) * loss_of(losses, name));
    bar.update(iteration, values);
  };
  Preview preview(args.preview, start.folder, std::move(make_preview));
  run.callbacks.push_back([&](const Trainer&) {
    preview.update(trainer);
    return false;
  });
  catch_signals();
  const std::string again =
      fmt::format("continue: {} {} --resume --save {}", program(), verb, shell_word(start.folder.string()));
  const RunResult result = [&] {
    try {
      return run_training(trainer, write_split, run);
    } catch (const DeviceError& error) {
      if (!fs::exists(RunFiles{start.folder}.checkpoint())) throw;
      throw DeviceError(error.what(), "\n", again);
    }
  }();
  if (shows) bar.finish();
  fmt::print("{} after {} of {} iterations; saved in {}\n", result.stopped ? "stopped" : "finished",
             result.iterations, trainer.iterations(), start.folder.string());
  if (result.stopped) fmt::print("{}\n", again);
  return result;
}

int exit_status() { return caught_signal() != 0 ? 128 + caught_signal() : 0; }

}  // namespace motiongan::command

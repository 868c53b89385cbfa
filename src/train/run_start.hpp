// How a training begins, whatever it trains: where it is kept, and what a run that is resumed was started
// with.
#pragma once
#include <nlohmann/json.hpp>

#include "command.hpp"
#include "motiongan/train/run.hpp"

namespace motiongan::command {

/// A list of options as the text of a note. `each(f)` calls f(name, member) for all that is kept, by the name
/// of its option.
template <class Each>
std::string note_of(const Each& each) {
  nlohmann::json out;
  each([&](const char* name, const auto& member) { out[name] = member; });
  return out.dump();
}

/// Takes from a note what the command line of `verb` does not give; `from` is the checkpoint. Options that
/// `describes_data(name)` go with the data: where the command line gives other data, they are not taken.
template <class Each, class DescribesData>
void take_note(const Each& each, const CLI::App& verb, const std::string& note, const fs::path& from,
               const DescribesData& describes_data) {
  const auto kept = nlohmann::json::parse(note, nullptr, false);
  require(kept.is_object(), from.string(), ": the options of the run cannot be read");
  const auto given = [&](const std::string& name) {
    const CLI::Option* const option = verb.get_option_no_throw(name);
    return option != nullptr && option->count() > 0;
  };
  const bool other_data = given("FOLDER") || given("--procedural");
  each([&](const std::string& name, auto& member) {
    const bool names_data =
        name == "FOLDER" || name == "--procedural" || (other_data && describes_data(name));
    if (given(name) || (names_data && other_data)) return;
    if (!kept.contains(name)) return;  // the option is younger than the run
    try {
      kept.at(name).get_to(member);
    } catch (const nlohmann::json::exception& error) {
      throw Error(from.string(), ": the run's option ", name, " cannot be read: ", error.what());
    }
  });
}

/// save/NAME, by the name of the folder of clips; `builtin` where there is none.
inline fs::path default_save(const std::string& clips, const char* builtin) {
  if (clips.empty()) return fs::path("save") / builtin;
  fs::path folder = fs::absolute(clips).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  const fs::path name = folder.stem();
  return fs::path("save") / (name.empty() ? "run" : name);
}

/// What is asked for on the command line, as far as all trainings have it.
struct RunRequest {
  std::string &folder, &save;  ///< of the clips, and of the run
  std::size_t procedural = 0;
  bool resume = false;
  const char* builtin = "procedural";  ///< name of a run on built-in motion
};

struct RunStart {
  fs::path folder;
  std::size_t done = 0;  ///< iterations
};

/// Finds where the run is kept and, for one that is resumed, gives the note of its options to `take(note,
/// checkpoint)`. Refuses what cannot be: no data, two kinds of data, no run to resume, a run in the way.
template <class Take>
RunStart begin_run(const RunRequest& asked, const CLI::App& verb, const Take& take) {
  require(!(verb.count("FOLDER") && verb.count("--procedural")),
          "give a folder of clips or --procedural, not both");
  if (verb.count("--procedural")) require(asked.procedural > 0, "--procedural 0: expected at least 1 clip");
  const bool has_data = !asked.folder.empty() || asked.procedural > 0;
  require(has_data || asked.resume,
          "there is nothing to train on: give a folder of BVH clips, or --procedural");
  require(has_data || !asked.save.empty(), "--resume needs --save DIR, the folder of the run");
  RunStart start{asked.save.empty() ? default_save(asked.folder, asked.builtin) : fs::path(asked.save), 0};
  const RunFiles files{start.folder};
  if (!asked.resume) {
    require(!fs::exists(files.checkpoint()), start.folder.string(),
            " already holds a run; continue it with --resume, or choose another --save");
    return start;
  }
  require(fs::exists(files.checkpoint()), "there is no run to resume in ", start.folder.string(), " (no ",
          files.checkpoint().filename().string(), " there)");
  const RunRecord record = read_run_record(files.checkpoint());
  start.done = record.iteration;
  if (const auto note = record.notes.find("options"); note != record.notes.end())
    take(note->second, files.checkpoint());
  else
    require(has_data, files.checkpoint().string(),
            " does not say what it was trained on; give the folder and the options of its first start");
  return start;
}

}  // namespace motiongan::command

// The folder of a training run: its files, its lock, and saving them as one set.
#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/io/folder_lock.hpp"
#include "motiongan/train/checkpoint.hpp"

namespace motiongan {

/// The files in a save_dir; there is one file for each network that the run trains.
struct RunFiles {
  std::filesystem::path folder;
  std::filesystem::path generator() const { return folder / "generator.safetensors"; }
  std::filesystem::path critic() const { return network("critic"); }
  std::filesystem::path checkpoint() const { return folder / "checkpoint.safetensors"; }
  /// The checkpoint before the last one; of a run that seems to diverge, the last one before that.
  std::filesystem::path previous_checkpoint() const { return folder / "checkpoint.previous.safetensors"; }
  std::filesystem::path log() const { return folder / "log.csv"; }
  /// Where a new run moves the log of a run that was killed before its first checkpoint.
  std::filesystem::path unsaved_log() const { return folder / "log.unsaved.csv"; }
  /// Where a resumed run moves a log that cannot be continued.
  std::filesystem::path damaged_log() const { return folder / "log.damaged.csv"; }
  std::filesystem::path split() const { return folder / "split.tsv"; }
  /// The file of the network of this name.
  std::filesystem::path network(const std::string& name) const { return folder / (name + ".safetensors"); }
};

/// The model file `given`, the one in the folder `given` of a run, or the shipped model of this name
/// (find_model()). Throws Error if the folder has none.
inline std::filesystem::path model_file(const std::filesystem::path& given) {
  if (!std::filesystem::is_directory(given)) return find_model(given);
  const RunFiles files{given};
  require(std::filesystem::exists(files.generator()), given.string(), " holds no ",
          files.generator().filename().string(),
          "; give a model file, or the --save folder of a training run");
  return files.generator();
}

/// Receives a warning: one sentence or more, without a line break at the end.
using Warn = std::function<void(const std::string& text)>;

/// The folder of one run, locked: no other process trains there as long as this exists. A save is a set of
/// files: the networks, and the checkpoint, which is put in place last. The networks can be made again from
/// the checkpoint, and are, if a process was killed between the two.
class RunFolder {
 public:
  /// Locks the folder, or takes over a lock; removes what a killed process left. Throws Error if another
  /// process holds the lock.
  RunFolder(RunFiles files, std::shared_ptr<const io::FolderLock> lock)
      : files_(std::move(files)),
        lock_(lock ? std::move(lock) : std::make_shared<const io::FolderLock>(files_.folder)) {
    tidy();
  }

  const RunFiles& files() const { return files_; }

  /// Restores the trainer from the checkpoint, and the networks' files, if they are not of the same save.
  void resume(Trainer& trainer, const Warn& warn) {
    const std::string where = files_.checkpoint().string();
    const io::SafeTensors checkpoint = read_checkpoint();
    restore_checkpoint(trainer, checkpoint, where);
    diverging_ = checkpoint.metadata.contains(diverging_key);
    for (const auto& [path, contents] : networks_of(trainer, checkpoint)) {
      if (holds(path, contents)) continue;
      warn(concat(path.string(),
                  " was missing, damaged or from another save than the checkpoint; written again"));
      contents.write(path);
    }
  }

  /// Writes the checkpoint and one file for each network. Everything is checked and on disk before the first
  /// file is replaced. The checkpoint before this one is kept as `checkpoint.previous.safetensors`;
  /// `diverging` says that the run has probably diverged: then the last one before that is kept. Throws
  /// DivergedError if a tensor is not finite, Error if a file cannot be written; the last save stays then.
  void save(Trainer& trainer, const RunNotes& notes, bool diverging) {
    io::SafeTensors checkpoint = checkpoint_of(trainer, notes);
    if (diverging) checkpoint.metadata[diverging_key] = "1";
    std::vector<std::unique_ptr<io::AtomicFile>> written;
    const auto write = [&](const std::filesystem::path& path, const io::SafeTensors& contents) {
      written.push_back(std::make_unique<io::AtomicFile>(path));
      contents.write_to(*written.back(), path.string());
      written.back()->flush();
    };
    for (const auto& [path, contents] : networks_of(trainer, checkpoint)) write(path, contents);
    write(files_.checkpoint(), checkpoint);
    if (!diverging_) keep_previous();
    for (const auto& file : written) file->commit();
    diverging_ = diverging;
  }

 private:
  static constexpr const char* diverging_key = "diverging";

  io::SafeTensors read_checkpoint() const {
    try {
      return io::SafeTensors::read(files_.checkpoint());
    } catch (const Error& error) {
      std::error_code problem;
      if (!std::filesystem::exists(files_.previous_checkpoint(), problem)) throw;
      throw Error(error.what(), "; the save before it is ", files_.previous_checkpoint().string(),
                  ": rename that to ", files_.checkpoint().filename().string(), " to continue from there");
    }
  }

  /// Files that a killed process was writing are incomplete: they were not renamed.
  void tidy() const {
    std::error_code problem;
    for (const auto& entry : std::filesystem::directory_iterator(files_.folder, problem)) {
      const std::string name = entry.path().filename().string();
      for (const char* ending : {".safetensors", ".csv", ".tsv"})
        if (const auto at = name.find(ending);
            at != name.npos && io::is_left_over(name, name.substr(0, at + std::string_view(ending).size())))
          std::filesystem::remove(entry.path(), problem);
    }
  }

  /// A second name for the checkpoint, so that it is there at any moment; a copy where the file system has no
  /// second names.
  void keep_previous() const {
    std::error_code problem;
    if (!std::filesystem::exists(files_.checkpoint(), problem)) return;
    std::filesystem::remove(files_.previous_checkpoint(), problem);
    std::filesystem::create_hard_link(files_.checkpoint(), files_.previous_checkpoint(), problem);
    if (problem) std::filesystem::copy_file(files_.checkpoint(), files_.previous_checkpoint(), problem);
  }

  /// The files of the networks with their contents, all of which the checkpoint holds: of a network with a
  /// running mean, that. The first is the model.
  std::vector<std::pair<std::filesystem::path, io::SafeTensors>> networks_of(
      Trainer& trainer, const io::SafeTensors& checkpoint) const {
    std::vector<std::pair<std::filesystem::path, io::SafeTensors>> out;
    for (const TrainedPart& part : trainer.parts()) {
      io::SafeTensors file = part_of_checkpoint(checkpoint, mean_part(part.name));
      if (file.tensors.empty()) file = part_of_checkpoint(checkpoint, part.name);
      if (out.empty()) file.metadata = model_metadata(checkpoint);
      out.emplace_back(files_.network(part.name), std::move(file));
    }
    return out;
  }

  static bool holds(const std::filesystem::path& path, const io::SafeTensors& contents) {
    try {
      const io::SafeTensors found = io::SafeTensors::read(path);
      return found.tensors == contents.tensors && found.metadata == contents.metadata;
    } catch (const Error&) {
      return false;
    }
  }

  RunFiles files_;
  std::shared_ptr<const io::FolderLock> lock_;
  bool diverging_ = false;  ///< whether the last save was of a run that seems to diverge
};

}  // namespace motiongan

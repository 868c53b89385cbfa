// A lock on a folder that only one process can hold.
#pragma once
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>

#include "motiongan/core/error.hpp"
#include "motiongan/core/os.hpp"

namespace motiongan::io {

/// Holds the lock of a folder, a file in it called `run.lock`. The kernel holds it for the process, so that
/// it is free again however the process ends; the file stays and means nothing by itself.
class FolderLock {
 public:
  /// Throws Error, naming the process that holds it, if the lock is taken; or if the file cannot be written.
  explicit FolderLock(const std::filesystem::path& folder) {
    const std::filesystem::path path = folder / "run.lock";
    file_ = os::open_or_create_file(path);
    require(file_ >= 0, "cannot open ", path.string(), ": ", std::strerror(errno),
            "; does the folder exist, and is it writable?");
    if (!os::lock_file(file_)) {
      const int problem = errno;
      const std::string holder = read();
      os::close_file(file_);
      require(problem != EWOULDBLOCK, folder.string(), " is in use by ",
              holder.empty() ? "another process" : holder,
              "; wait until it has ended, stop it, or choose another folder");
      throw Error("cannot lock ", path.string(), ": ", std::strerror(problem),
                  "; the file system must support flock()");
    }
    const std::string host = os::host_name();
    write(concat("process ", os::process_id(), " on ", host.empty() ? "this machine" : host));
  }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock() {
    write("");
    os::close_file(file_);
  }

 private:
  std::string read() const {
    std::string out = os::read_start(file_, 300);
    for (char& c : out)
      if (static_cast<unsigned char>(c) < 32) c = '?';
    return out;
  }
  /// The text only informs: a full disk must not stop a run.
  void write(const std::string& text) const noexcept { os::overwrite(file_, text); }

  os::FileHandle file_ = -1;
};

}  // namespace motiongan::io

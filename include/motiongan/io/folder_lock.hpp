// A lock on a folder that only one process can hold.
#pragma once
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>
#include <utility>

#include "motiongan/core/error.hpp"

namespace motiongan::io {

/// Holds the lock of a folder, a file in it called `run.lock`. The kernel holds it for the process, so that
/// it is free again however the process ends; the file stays and means nothing by itself.
class FolderLock {
 public:
  /// Throws Error, naming the process that holds it, if the lock is taken; or if the file cannot be written.
  explicit FolderLock(const std::filesystem::path& folder) {
    const std::filesystem::path path = folder / "run.lock";
    file_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
    require(file_ >= 0, "cannot open ", path.string(), ": ", std::strerror(errno),
            "; does the folder exist, and is it writable?");
    if (::flock(file_, LOCK_EX | LOCK_NB) != 0) {
      const int problem = errno;
      const std::string holder = read();
      ::close(file_);
      require(problem != EWOULDBLOCK, folder.string(), " is in use by ",
              holder.empty() ? "another process" : holder,
              "; wait until it has ended, stop it, or choose another folder");
      throw Error("cannot lock ", path.string(), ": ", std::strerror(problem),
                  "; the file system must support flock()");
    }
    write(concat("process ", ::getpid(), " on ", host()));
  }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock() {
    write("");
    ::close(file_);
  }

 private:
  static std::string host() {
    char name[256] = "this machine";
    ::gethostname(name, sizeof name - 1);
    return name;
  }
  std::string read() const {
    char text[300];
    const ssize_t n = ::pread(file_, text, sizeof text, 0);
    std::string out(text, n > 0 ? static_cast<std::size_t>(n) : 0);
    for (char& c : out)
      if (static_cast<unsigned char>(c) < 32) c = '?';
    return out;
  }
  /// The text only informs: a full disk must not stop a run.
  void write(const std::string& text) const noexcept {
    const bool done = ::ftruncate(file_, 0) == 0 &&
                      ::pwrite(file_, text.data(), text.size(), 0) == static_cast<ssize_t>(text.size());
    static_cast<void>(done);
  }

  int file_ = -1;
};

}  // namespace motiongan::io

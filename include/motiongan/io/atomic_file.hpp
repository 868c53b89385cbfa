// Atomic file writes: the complete file appears, or nothing changes.
#pragma once
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "motiongan/core/error.hpp"

namespace motiongan::io {

/// Writes to a new file beside `path`, called `path.PID-N.tmp`; commit() flushes it to disk and renames it to
/// `path`. Without commit() the destructor removes it and leaves any file at `path` untouched. A device or a
/// pipe (/dev/stdout) is written directly. Throws Error if a system call fails.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path path) : path_(std::move(path)), beside_(path_) {
    struct stat found {};
    // Not all of /dev: /dev/shm is a folder of ordinary files.
    direct_ = path_.parent_path() == "/dev" || path_.parent_path() == "/dev/fd" ||
              (::stat(path_.c_str(), &found) == 0 && !S_ISREG(found.st_mode) && !S_ISDIR(found.st_mode));
    if (direct_) {
      file_ = ::open(path_.c_str(), O_WRONLY | O_CLOEXEC);
    } else {
      // Never an existing file and never through a link, so that nobody can plant one. Files that a killed
      // process left, and other hosts' processes of the same number, have taken some names.
      for (int n = 0; n < 1000 && (n == 0 || (file_ < 0 && errno == EEXIST)); ++n) {
        beside_ = path_;
        beside_ += concat(".", ::getpid(), "-", n, ".tmp");
        file_ = ::open(beside_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
      }
    }
    check(file_ >= 0, "open");
  }
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile() {
    if (file_ < 0) return;
    ::close(file_);
    remove();
  }

  void write(const void* bytes, std::size_t size) {
    const char* at = static_cast<const char*>(bytes);
    while (size > 0) {
      const ssize_t n = ::write(file_, at, size);
      if (n < 0 && errno == EINTR) continue;
      check(n > 0, "write");
      at += n;
      size -= static_cast<std::size_t>(n);
    }
  }
  void write(std::string_view text) { write(text.data(), text.size()); }

  /// Whether commit() waits until the file is on disk: for files whose loss matters after a power cut.
  enum class Sync { no, yes };

  /// Renames the file into place: from now on it is at `path`.
  void commit(Sync sync = Sync::yes) {
    if (sync == Sync::yes) flush();
    const int file = std::exchange(file_, -1);
    const bool closed = ::close(file) == 0;
    const bool renamed = closed && (direct_ || ::rename(beside_.c_str(), path_.c_str()) == 0);
    if (!renamed) {
      const int error = errno;
      remove();
      errno = error;
      check(false, closed ? "rename into place" : "close");
    }
    // The rename is durable only once the folder is synced; if that fails, the file is still complete.
    if (sync == Sync::no || direct_) return;
    const std::filesystem::path folder = path_.has_parent_path() ? path_.parent_path() : ".";
    const int handle = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (handle >= 0) {
      ::fsync(handle);
      ::close(handle);
    }
  }

  /// Waits until what was written is on disk; commit() does so too.
  void flush() {
    if (!direct_) check(::fsync(file_) == 0, "flush");
  }

 private:
  void check(bool done, const char* what) const {
    if (!done)
      throw Error("cannot ", what, " ", beside_.string(), ": ", std::strerror(errno),
                  "; does the folder exist, is it writable, and is there free space?");
  }
  void remove() const {
    if (!direct_) ::unlink(beside_.c_str());
  }

  std::filesystem::path path_, beside_;
  bool direct_ = false;
  int file_ = -1;
};

/// Whether `name` is what AtomicFile calls its file beside `target`: left by a process that was killed.
inline bool is_left_over(std::string_view name, std::string_view target) {
  return name.size() > target.size() + 5 && name.starts_with(target) && name[target.size()] == '.' &&
         name.ends_with(".tmp");
}

}  // namespace motiongan::io

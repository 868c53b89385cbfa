// A file that appears whole or not at all.
#pragma once
#include <fcntl.h>
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

/// Writes `path` beside itself, as `path.tmp`. commit() brings it to the disk and renames it; without
/// commit() the destructor removes it, and what stood at `path` before is untouched. Throws Error where a
/// call fails.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path path) : path_(std::move(path)), beside_(path_) {
    beside_ += ".tmp";
    file_ = ::open(beside_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    check(file_ >= 0, "open");
  }
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile() {
    if (file_ < 0) return;
    ::close(file_);
    ::unlink(beside_.c_str());
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

  /// After this the new file stands at `path`, on the disk.
  void commit() {
    check(::fsync(file_) == 0, "bring to the disk");
    const int file = std::exchange(file_, -1);
    const bool closed = ::close(file) == 0;
    const bool renamed = closed && ::rename(beside_.c_str(), path_.c_str()) == 0;
    if (!renamed) {
      const int error = errno;
      ::unlink(beside_.c_str());
      errno = error;
      check(false, closed ? "rename into place" : "close");
    }
    // The rename itself is on the disk only once the folder is; where a folder cannot be synced, the file
    // still is whole.
    const std::filesystem::path folder = path_.has_parent_path() ? path_.parent_path() : ".";
    const int handle = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (handle >= 0) {
      ::fsync(handle);
      ::close(handle);
    }
  }

 private:
  void check(bool done, const char* what) const {
    if (!done)
      throw Error("cannot ", what, " ", beside_.string(), ": ", std::strerror(errno),
                  "; is the folder there, writable, and not full?");
  }

  std::filesystem::path path_, beside_;
  int file_ = -1;
};

}  // namespace motiongan::io

// Atomic file writes: the complete file appears, or nothing changes.
#pragma once
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "motiongan/core/error.hpp"
#include "motiongan/core/os.hpp"

namespace motiongan::io {

/// Writes to a new file beside `path`, called `path.PID-N.tmp`; commit() flushes it to disk and renames it to
/// `path`. Without commit() the destructor removes it and leaves any file at `path` untouched. A device or a
/// pipe (/dev/stdout) is written directly. Throws Error if a system call fails.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path path) : path_(std::move(path)), beside_(path_) {
    direct_ = os::is_special(path_);
    if (direct_) {
      file_ = os::open_to_write(path_);
    } else {
      // Never an existing file and never through a link, so that nobody can plant one. Files that a killed
      // process left, and other hosts' processes of the same number, have taken some names.
      for (int n = 0; n < 1000 && (n == 0 || (file_ < 0 && errno == EEXIST)); ++n) {
        beside_ = path_;
        beside_ += concat(".", os::process_id(), "-", n, ".tmp");
        file_ = os::create_file(beside_);
      }
    }
    check(file_ >= 0, "open");
  }
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile() {
    if (file_ < 0) return;
    os::close_file(file_);
    remove();
  }

  /// Appends. Throws Error if the disk is full or fails.
  /// \{
  void write(const void* bytes, std::size_t size) { check(os::write_all(file_, bytes, size), "write"); }
  void write(std::string_view text) { write(text.data(), text.size()); }
  /// \}

  /// Whether commit() waits until the file is on disk: for files whose loss matters after a power cut.
  enum class Sync { no, yes };

  /// Renames the file into place: from now on it is at `path`.
  void commit(Sync sync = Sync::yes) {
    if (sync == Sync::yes) flush();
    const bool closed = os::close_file(std::exchange(file_, -1));
    const bool renamed = closed && (direct_ || os::replace_file(beside_, path_));
    if (!renamed) {
      const int error = errno;
      remove();
      errno = error;
      check(false, closed ? "rename into place" : "close");
    }
    // Should this fail, the file is still complete.
    if (sync == Sync::yes && !direct_) os::flush_folder(path_.has_parent_path() ? path_.parent_path() : ".");
  }

  /// Waits until what was written is on disk; commit() does so too.
  void flush() {
    if (!direct_) check(os::flush_to_disk(file_), "flush");
  }

 private:
  void check(bool done, const char* what) const {
    if (!done)
      throw Error("cannot ", what, " ", beside_.string(), ": ", std::strerror(errno),
                  "; does the folder exist, is it writable, and is there free space?");
  }
  void remove() const {
    if (!direct_) os::remove_file(beside_);
  }

  std::filesystem::path path_, beside_;
  bool direct_ = false;
  os::FileHandle file_ = -1;
};

/// Whether `name` is what AtomicFile calls its file beside `target`: left by a process that was killed.
inline bool is_left_over(std::string_view name, std::string_view target) {
  return name.size() > target.size() + 5 && name.starts_with(target) && name[target.size()] == '.' &&
         name.ends_with(".tmp");
}

}  // namespace motiongan::io

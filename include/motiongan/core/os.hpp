// The operating system: everything beyond standard C++ that the library and the command ask of it. No other
// header calls it, so that a port is a matter of this file; docs/building.md lists what else a port needs.
#pragma once

#if !defined(__unix__) && !defined(__APPLE__)
#error "motiongan knows POSIX systems only; motiongan/core/os.hpp is the file to port"
#endif

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>
#ifdef __APPLE__
#include <xlocale.h>
#endif

#include <cerrno>
#include <clocale>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <system_error>

/// What is asked of the operating system.
namespace motiongan::os {

// ---- files: a function that can fail returns a negative handle or false, and errno says why

/// An open file; negative if there is none.
using FileHandle = int;

/// Whether something other than a file or a folder is there: a device or a pipe, such as /dev/stdout.
inline bool is_special(const std::filesystem::path& path) {
  // Not all of /dev: /dev/shm is a folder of ordinary files.
  if (path.parent_path() == "/dev" || path.parent_path() == "/dev/fd") return true;
  struct stat found {};
  return ::stat(path.c_str(), &found) == 0 && !S_ISREG(found.st_mode) && !S_ISDIR(found.st_mode);
}

/// Opens what is there for writing.
inline FileHandle open_to_write(const std::filesystem::path& path) {
  return ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
}

/// Makes a new file. Never opens one that is there (errno is then EEXIST), and never follows a link.
inline FileHandle create_file(const std::filesystem::path& path) {
  return ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
}

/// Opens a file for reading and writing; makes it if it is not there. Never follows a link.
inline FileHandle open_or_create_file(const std::filesystem::path& path) {
  return ::open(path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
}

/// Closes a file; false if what was written could not be kept.
inline bool close_file(FileHandle file) { return ::close(file) == 0; }

/// Writes all bytes, also where the system takes some at a time.
inline bool write_all(FileHandle file, const void* bytes, std::size_t size) {
  for (const char* at = static_cast<const char*>(bytes); size > 0;) {
    const ssize_t n = ::write(file, at, size);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    at += n;
    size -= static_cast<std::size_t>(n);
  }
  return true;
}

/// Waits until what was written is on disk.
inline bool flush_to_disk(FileHandle file) { return ::fsync(file) == 0; }

/// Renames a file, in place of one that is there, at once for all who look.
inline bool replace_file(const std::filesystem::path& from, const std::filesystem::path& to) {
  return ::rename(from.c_str(), to.c_str()) == 0;
}

/// Makes the renaming of a file durable, where the file system can: it is so once its folder is on disk.
inline void flush_folder(const std::filesystem::path& folder) {
  const FileHandle handle = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (handle < 0) return;
  ::fsync(handle);
  ::close(handle);
}

/// Removes a file, if it is there.
inline void remove_file(const std::filesystem::path& path) { ::unlink(path.c_str()); }

/// Takes the lock of an open file, which the system holds for this process until it is closed or the process
/// ends. Does not wait: false, and errno is EWOULDBLOCK, if another process holds it.
inline bool lock_file(FileHandle file) { return ::flock(file, LOCK_EX | LOCK_NB) == 0; }

/// The start of a file, at most `most` bytes; empty if it cannot be read.
inline std::string read_start(FileHandle file, std::size_t most) {
  std::string text(most, '\0');
  const ssize_t n = ::pread(file, text.data(), text.size(), 0);
  text.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
  return text;
}

/// Makes `text` all that the file holds.
inline bool overwrite(FileHandle file, std::string_view text) {
  return ::ftruncate(file, 0) == 0 &&
         ::pwrite(file, text.data(), text.size(), 0) == static_cast<ssize_t>(text.size());
}

// ---- the process, the machine, the terminal

/// The number of this process.
inline long process_id() { return ::getpid(); }

/// The path of the running program; empty where the system does not say.
inline std::filesystem::path program_path() {
  std::error_code problem;
  return std::filesystem::read_symlink("/proc/self/exe", problem);
}

/// The path of the shared library that this function is compiled into, or of the program; empty where the
/// system does not say.
inline std::filesystem::path module_path() {
  Dl_info found{};
  const void* const here = reinterpret_cast<const void*>(&module_path);
  return ::dladdr(here, &found) != 0 && found.dli_fname != nullptr ? found.dli_fname : "";
}

/// The machine's name on the network; empty if it has none.
inline std::string host_name() {
  char name[256] = "";
  return ::gethostname(name, sizeof name - 1) == 0 ? name : "";
}

/// Bytes of memory that a process can still have, with swap space; all of the machine's where the system does
/// not say what is free.
inline double available_memory() {
  double free = 0;
  if (std::FILE* in = std::fopen("/proc/meminfo", "re")) {
    for (char line[256]; std::fgets(line, sizeof line, in) != nullptr;)  // "MemAvailable:   123 kB"
      for (const std::string_view name : {"MemAvailable:", "SwapFree:"})
        if (std::string_view(line).starts_with(name)) free += 1024 * std::strtod(line + name.size(), nullptr);
    std::fclose(in);
  }
  if (free > 0) return free;
  return static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGESIZE));
}

/// Fills at most 256 bytes with random numbers that nobody can guess.
inline bool random_bytes(std::span<unsigned char> bytes) {
  return ::getentropy(bytes.data(), bytes.size()) == 0;
}

/// strtod() with a decimal point, whatever the locale of the process.
inline double text_to_double(const char* text, char** end) {
  static const locale_t plain = ::newlocale(LC_ALL_MASK, "C", nullptr);
  return ::strtod_l(text, end, plain);
}

/// Sets an environment variable of this process.
inline bool set_environment(const char* name, const std::string& value) {
  return ::setenv(name, value.c_str(), 1) == 0;
}

/// Whether a person may be reading what is written there.
inline bool is_terminal(std::FILE* stream) { return ::isatty(::fileno(stream)) == 1; }

/// Columns of the terminal; 0 if there is none, or it does not say.
inline std::size_t terminal_width(std::FILE* stream) {
  winsize size{};
  return ::ioctl(::fileno(stream), TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

/// Opens /dev/null in place of standard streams that are closed: the next file to be opened would take their
/// place, and get what is printed.
inline void open_standard_streams() {
  for (int stream = 0; stream <= 2; ++stream)
    // The lowest free descriptor is the closed one.
    if (::fcntl(stream, F_GETFD) < 0 && errno == EBADF && ::open("/dev/null", O_RDWR) < 0) return;
}

// ---- signals

/// A function that takes signals.
using SignalHandler = void (*)(int);

/// Whether the signal does nothing, as under nohup.
inline bool is_signal_ignored(int number) {
  struct sigaction now {};
  return ::sigaction(number, nullptr, &now) == 0 && now.sa_handler == SIG_IGN;
}

/// Whether `handler` is what takes the signal; false after other code has set its own.
inline bool is_signal_handler(int number, SignalHandler handler) {
  struct sigaction now {};
  return ::sigaction(number, nullptr, &now) == 0 && now.sa_handler == handler;
}

/// Sets what takes a signal. System calls that it interrupts go on; the signals in `waiting` wait until the
/// handler has ended.
inline bool set_signal_handler(int number, SignalHandler handler, std::span<const int> waiting) {
  struct sigaction wanted {};
  wanted.sa_handler = handler;
  wanted.sa_flags = SA_RESTART;
  sigemptyset(&wanted.sa_mask);
  for (const int other : waiting) sigaddset(&wanted.sa_mask, other);
  return ::sigaction(number, &wanted, nullptr) == 0;
}

/// Lets the signal do what it does without a handler, even while a handler of it runs: ends the process.
/// May be called in a handler.
inline void end_by_signal(int number) {
  sigset_t only;
  sigemptyset(&only);
  sigaddset(&only, number);
  std::signal(number, SIG_DFL);
  ::pthread_sigmask(SIG_UNBLOCK, &only, nullptr);
  std::raise(number);
}

/// In this thread and those that it starts, writing to a connection that is closed fails, without a signal.
inline void block_broken_pipe_signal() {
  sigset_t pipe;
  sigemptyset(&pipe);
  sigaddset(&pipe, SIGPIPE);
  ::pthread_sigmask(SIG_BLOCK, &pipe, nullptr);
}

}  // namespace motiongan::os

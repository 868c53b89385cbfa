// Runs the motiongan command in a folder of its own and keeps what it said.
#pragma once
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace fs = std::filesystem;

struct Said {
  int status = -1;   ///< exit status; 128 + signal where one ended it
  std::string text;  ///< standard output and standard error, as they came
  bool has(const std::string& part) const { return text.find(part) != std::string::npos; }
};

/// A new folder that is the current one while this lives, and is removed with all it holds.
class TestFolder {
 public:
  TestFolder() : before_(fs::current_path()) {
    std::string name = (fs::temp_directory_path() / "motiongan-command-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) std::abort();
    path_ = name;
    fs::current_path(path_);
  }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;
  ~TestFolder() {
    fs::current_path(before_);
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }

 private:
  fs::path before_, path_;
};

/// The command in a shell's background: a shell starts such processes with SIGINT ignored.
inline const std::string in_background = std::string("env --default-signal=INT '") + MOTIONGAN_COMMAND + "' ";

/// Runs `command` in a shell.
inline Said shell(const std::string& command) {
  Said out;
  std::FILE* pipe = popen(("{ " + command + "; } 2>&1").c_str(), "r");
  if (pipe == nullptr) return out;
  char part[4096];
  for (std::size_t n; (n = std::fread(part, 1, sizeof part, pipe)) > 0;) out.text.append(part, n);
  const int status = pclose(pipe);
  out.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return out;
}

inline Said call(const std::string& arguments) {
  return shell(std::string("'") + MOTIONGAN_COMMAND + "' " + arguments);
}

inline std::string bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void write_file(const fs::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

/// A training so small that an iteration takes a moment; the same wherever it is used, so that PoCL compiles
/// its kernels once.
inline const std::string tiny = " --frames 16 --hidden 16 --batch 4 --critic-steps 2 --split-seed 3 ";
inline const std::string tiny_rnn =
    " --generator rnn --frames 8 --rate 4 --hidden 8 --batch 4 --critic-steps 1 --split-seed 3 ";

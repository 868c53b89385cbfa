// What the verbs of the command share: how they register themselves, and how they print.
#pragma once
#include <fmt/format.h>

#include "shared/numbers.hpp"
// Must follow numbers.hpp, which says how it reads numbers.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "motiongan/core/device.hpp"
#include "motiongan/core/error.hpp"

namespace motiongan::command {

namespace fs = std::filesystem;

/// Exit statuses besides 0 and, after a signal, 128 + its number. CLI11's are 100 and above.
inline constexpr int exit_failure = 1, exit_diverged = 3, exit_not_met = 4;

/// What main() runs after parsing the command line. Returns the exit status.
using Job = std::function<int()>;

/// A verb of the command, such as "info" or "train dvgan", defined once in its own file:
///     const Verb verb{"info", [](CLI::App& app, Job& job) { ... }};
/// CommandLine calls `add` with the app, or with the group that the name begins with.
struct Verb {
  using Add = void (*)(CLI::App& parent, Job& job);
  /// Whether the processes of an MPI job share the work, or one process does it.
  enum class Runs { alone, on_ranks };
  Verb(std::string its_name, Add how, Runs where = Runs::alone)
      : name(std::move(its_name)), add(how), runs(where) {
    all().push_back(*this);
  }

  /// All verbs, in no particular order.
  static std::vector<Verb>& all() {
    static std::vector<Verb> verbs;
    return verbs;
  }

  std::string name;
  Add add;
  Runs runs;
};

/// What a verb that takes a model says of it.
inline constexpr const char* model_help =
    "model file, the --save folder of a training run, or the name of a shipped model (motiongan models)";

/// How this command was invoked, for suggested command lines: "motiongan", or the path to it.
inline std::string& program() {
  static std::string name = "motiongan";
  return name;
}

/// "1 clip", "35 clips".
inline std::string counted(std::size_t n, std::string_view what) {
  return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s");
}

/// At most `digits` significant digits and no more than needed: "4", "12.5", "0.00833".
inline std::string brief(double value, int digits = 4) { return fmt::format("{:.{}g}", value, digits); }

/// "8 s", "2 min 5 s", "1 h 20 min".
inline std::string duration(double seconds) {
  if (seconds < 120) return brief(seconds, seconds < 10 ? 3 : 4) + " s";
  const auto whole = static_cast<std::size_t>(std::lround(seconds));
  const bool hours = whole >= 7200;
  const std::size_t large = whole / (hours ? 3600 : 60), small = hours ? whole % 3600 / 60 : whole % 60;
  const std::string first = fmt::format("{} {}", large, hours ? "h" : "min");
  return small == 0 ? first : fmt::format("{} {} {}", first, small, hours ? "min" : "s");
}

/// Width of a text on a terminal, counting every code point as one column.
inline std::size_t columns_of(std::string_view utf8) {
  std::size_t n = 0;
  for (const char c : utf8) n += (c & 0xC0) != 0x80;
  return n;
}

/// Prints a table with a line of headings; `align` has an 'l' or 'r' for each column.
inline void print_table(const std::vector<std::string>& head,
                        const std::vector<std::vector<std::string>>& rows, std::string_view align,
                        std::string_view indent = "", std::FILE* to = stdout) {
  std::vector<std::size_t> widths;
  for (std::size_t c = 0; c < head.size(); ++c) {
    widths.push_back(columns_of(head[c]));
    for (const auto& row : rows) widths[c] = std::max(widths[c], columns_of(row[c]));
  }
  const auto line = [&](const std::vector<std::string>& row) {
    std::string out(indent);
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string pad(widths[c] - columns_of(row[c]), ' ');
      out += (c > 0 ? "  " : "") + (align[c] == 'r' ? pad + row[c] : row[c] + pad);
    }
    out.erase(out.find_last_not_of(' ') + 1);
    fmt::print(to, "{}\n", out);
  };
  line(head);
  for (const auto& row : rows) line(row);
}

/// Prints one line of a list of facts, with the name in its own column.
inline void print_fact(std::string_view name, std::string_view text) {
  fmt::print("  {:<11} {}\n", name, text);
}

/// Accept numbers of at least 0, and above 0.
CLI::Validator not_negative();
CLI::Validator positive();

/// "gpu", "cpu" or "other".
inline const char* kind_of(const Device& device) {
  return device.is_gpu() ? "gpu" : device.is_cpu() ? "cpu" : "other";
}

inline std::string describe(const Device& device) {
  return fmt::format("{}: {} ({})", kind_of(device), device.name, device.platform_name);
}

/// A path for printing: relative if it is below the current folder.
inline std::string shown(const fs::path& path) {
  std::error_code problem;
  const fs::path near = fs::proximate(path, problem);
  return (problem || near.empty() || *near.begin() == "..") ? path.string() : near.string();
}

/// Creates the folder and its missing parents.
inline void make_folder(const fs::path& folder) {
  std::error_code problem;
  fs::create_directories(folder, problem);
  if (problem || !fs::is_directory(folder))
    throw Error("cannot create the folder ", folder.string(), ": ",
                problem ? problem.message() : "a file of that name exists");
}

/// Creates the folder of a file to be written.
inline void make_folder_of(const fs::path& file) {
  if (file.has_parent_path()) make_folder(file.parent_path());
}

/// The caption file for a folder of clips: `given`, or else captions.tsv, .csv or .json in the folder, or
/// else empty, for captions in .txt files beside the clips.
inline fs::path captions_for(const fs::path& folder, const fs::path& given) {
  if (!given.empty()) return given;
  for (const char* name : {"captions.tsv", "captions.csv", "captions.json"})
    if (fs::is_regular_file(folder / name)) return folder / name;
  return {};
}

}  // namespace motiongan::command

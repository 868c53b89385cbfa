// Text files of exponential maps as used in the motion-prediction literature, in the folder layouts of
// Human3.6M and of the CMU clips.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <iterator>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/formats/text_file.hpp"
#include "motiongan/io/read_number.hpp"

namespace motiongan::motion {

/// The values of one file: every three columns are the exponential map of a joint (the first three: the
/// position of the root, or its change).
struct ExpmapText {
  std::size_t columns = 0, frames = 0;
  std::vector<double> values;  ///< [frames, columns], radians
};

namespace expmap_detail {
inline constexpr std::string_view separators = ", \t\r\v\f";

/// Removes and returns the next number of a line; nothing at its end. Throws Error for anything else.
inline std::optional<double> next_number(std::string_view& line, std::string_view name, std::size_t number) {
  line.remove_prefix(std::min(line.size(), line.find_first_not_of(separators)));
  if (line.empty()) return std::nullopt;
  const std::string_view word = line.substr(0, line.find_first_of(separators));
  line.remove_prefix(word.size());
  const char* const first = word.data() + (word.starts_with('+') ? 1 : 0);
  const char* const last = word.data() + word.size();
  double value = 0;
  const auto [end, problem] = io::read_number(first, last, value);
  require(problem == std::errc() && end == last && std::isfinite(value), name, ":", number, ": found '",
          word.substr(0, 40), "', expected a finite number such as -0.25 or 1.5e-3");
  return value;
}
}  // namespace expmap_detail

/// Reads numbers separated by commas or blanks, one frame per line; blank lines are skipped. Every line has
/// as many numbers as the first, a multiple of three. Throws Error as `name:line: ...`.
inline ExpmapText parse_expmap_text(std::string_view text, std::string_view name) {
  ExpmapText out;
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  std::size_t first_line = 0;
  for (std::size_t number = 1; !text.empty(); ++number) {
    std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    const std::size_t before = out.values.size();
    while (const auto value = expmap_detail::next_number(line, name, number)) out.values.push_back(*value);
    const std::size_t found = out.values.size() - before;
    if (found == 0) continue;
    if (out.frames++ == 0) {
      require(found % 3 == 0, name, ":", number, ": found ", found,
              " numbers, expected three per joint (99 for Human3.6M, 117 for CMU)");
      out.columns = found;
      first_line = number;
    }
    require(found == out.columns, name, ":", number, ": found ", found, " numbers, expected ", out.columns,
            " as in line ", first_line);
  }
  require(out.frames > 0, name, ": found no numbers, expected one line of them per frame");
  return out;
}

/// As parse_expmap_text, from a file. Throws Error also if the file cannot be read.
inline ExpmapText read_expmap_text(const std::filesystem::path& path) {
  return parse_expmap_text(read_text(path, "file of exponential maps"), path.string());
}

/// The folder layout of a collection.
enum class ExpmapLayout {
  h36m,  ///< S5/walking_1.txt and _2: subjects S1, S5, S6, S7, S8, S9, S11; S5 is for testing. 50 frames/s
  cmu    ///< train/walking/walking_1.txt ..., test/walking/walking_1.txt. 120 frames/s
};

/// "h36m" or "cmu".
inline const char* name_of(ExpmapLayout layout) { return layout == ExpmapLayout::h36m ? "h36m" : "cmu"; }

/// Frames per second of the layout's files.
inline double rate_of(ExpmapLayout layout) { return layout == ExpmapLayout::h36m ? 50 : 120; }

/// One file of a collection.
struct ExpmapClip {
  std::string id;      ///< path below the folder without extension, such as S5/walking_1
  std::string action;  ///< such as walking
  std::filesystem::path path;
  ExpmapText text;
};

/// The training files, and the test files of the tested actions.
struct ExpmapCollection {
  ExpmapLayout layout = ExpmapLayout::h36m;
  std::size_t columns = 0;           ///< of every file
  std::vector<std::string> actions;  ///< tested, in the order given, else by name
  std::vector<std::string> classes;  ///< all actions trained on or available for testing, by name
  std::vector<ExpmapClip> train;     ///< by action, then by id
  std::vector<ExpmapClip> test;      ///< of every tested action, in order: two for h36m (_1, _2), one for cmu
};

/// Which files of a folder are read.
struct ExpmapSelection {
  std::vector<std::string> actions{};        ///< to test; empty: all with test files
  std::vector<std::string> train_actions{};  ///< to train on; empty: all with training files
  std::optional<ExpmapLayout> layout{};      ///< not set: detected from the folders
};

namespace expmap_detail {
namespace fs = std::filesystem;

inline constexpr std::array<const char*, 6> training_subjects{"S1", "S6", "S7", "S8", "S9", "S11"};

/// Sorted names in a folder: of its folders, or of its .txt files.
inline std::vector<std::string> names_in(const fs::path& folder, bool folders) {
  std::error_code problem;
  std::vector<std::string> out;
  fs::directory_iterator entries(folder, problem);
  for (; !problem && entries != fs::directory_iterator(); entries.increment(problem)) {
    std::error_code ignored;
    if (entries->is_directory(ignored) != folders) continue;
    if (folders || entries->path().extension() == ".txt") out.push_back(entries->path().filename().string());
  }
  require(!problem, "folder ", folder.string(), " cannot be read: ", problem.message());
  std::sort(out.begin(), out.end());
  return out;
}

inline std::string joined(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ", ") + name;
  return out;
}

/// The actions whose test files exist.
inline std::vector<std::string> testable_actions(const fs::path& folder, ExpmapLayout layout) {
  std::vector<std::string> out;
  if (layout == ExpmapLayout::cmu) {
    for (std::string& action : names_in(folder / "test", true))
      if (fs::is_regular_file(folder / "test" / action / (action + "_1.txt")))
        out.push_back(std::move(action));
  } else {
    for (const std::string& file : names_in(folder / "S5", false))
      if (file.ends_with("_1.txt")) {
        std::string action = file.substr(0, file.size() - 6);
        if (fs::is_regular_file(folder / "S5" / (action + "_2.txt"))) out.push_back(std::move(action));
      }
  }
  return out;
}

/// The actions with training files.
inline std::vector<std::string> trainable_actions(const fs::path& folder, ExpmapLayout layout) {
  std::set<std::string> out;
  if (layout == ExpmapLayout::cmu) {
    for (const std::string& action : names_in(folder / "train", true))
      if (!names_in(folder / "train" / action, false).empty()) out.insert(action);
  } else {
    for (const char* subject : training_subjects) {
      if (!fs::is_directory(folder / subject)) continue;
      for (const std::string& file : names_in(folder / subject, false))
        if (file.ends_with("_1.txt") || file.ends_with("_2.txt")) out.insert(file.substr(0, file.size() - 6));
    }
  }
  return {out.begin(), out.end()};
}

/// Training files of an action, relative to `folder`.
inline std::vector<fs::path> training_files(const fs::path& folder, ExpmapLayout layout,
                                            const std::string& action) {
  std::vector<fs::path> out;
  if (layout == ExpmapLayout::cmu) {
    const fs::path below = fs::path("train") / action;
    for (const std::string& file : names_in(folder / below, false)) out.push_back(below / file);
    return out;
  }
  for (const char* subject : training_subjects)
    for (const char* part : {"_1.txt", "_2.txt"})
      if (const fs::path file = fs::path(subject) / (action + part); fs::is_regular_file(folder / file))
        out.push_back(file);
  return out;
}

/// The given actions, or all available ones. Throws Error for one that is not available or is given twice.
inline std::vector<std::string> chosen(const std::vector<std::string>& asked,
                                       const std::vector<std::string>& there, const char* kind,
                                       const fs::path& folder) {
  std::set<std::string> seen;
  for (const std::string& action : asked) {
    require(std::find(there.begin(), there.end(), action) != there.end(), "no ", kind,
            " file of the action '", action, "' in ", folder.string(),
            "; actions that have one: ", joined(there));
    require(seen.insert(action).second, "the action '", action, "' is given twice");
  }
  return asked.empty() ? there : asked;
}
}  // namespace expmap_detail

/// Detects the layout of a folder from its subfolders. Throws Error if they match neither layout, or both.
inline ExpmapLayout find_expmap_layout(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  require(fs::is_directory(folder), folder.string(), " is not a folder");
  const bool cmu = fs::is_directory(folder / "train") && fs::is_directory(folder / "test");
  const bool h36m = fs::is_directory(folder / "S5");
  require(cmu || h36m, folder.string(),
          " has neither the folder S5 (Human3.6M: S5/walking_1.txt) nor train and test (CMU: "
          "train/walking/walking_1.txt); give the folder that holds them");
  require(!(cmu && h36m), folder.string(),
          " has the folders of Human3.6M (S5) and of CMU (train, test); give the layout, h36m or cmu");
  return h36m ? ExpmapLayout::h36m : ExpmapLayout::cmu;
}

/// Reads the selected files. An action may be tested without training files of its own. Throws Error, listing
/// what is available, for an action without files, and if files differ in their number of columns.
inline ExpmapCollection read_expmap_collection(const std::filesystem::path& folder,
                                               const ExpmapSelection& selection = {}) {
  namespace fs = std::filesystem;
  require(fs::is_directory(folder), folder.string(), " is not a folder");
  ExpmapCollection out;
  out.layout = selection.layout ? *selection.layout : find_expmap_layout(folder);
  const bool cmu = out.layout == ExpmapLayout::cmu;
  for (const char* needed : {cmu ? "test" : "S5", cmu ? "train" : "S5"})
    require(fs::is_directory(folder / needed), folder.string(), " has no folder ", needed,
            ", which the layout ", name_of(out.layout), " requires");
  const std::vector<std::string> testable = expmap_detail::testable_actions(folder, out.layout),
                                 trainable = expmap_detail::trainable_actions(folder, out.layout);
  require(!testable.empty(), folder.string(), " has no test files, expected ",
          cmu ? "test/walking/walking_1.txt or similar" : "S5/walking_1.txt and S5/walking_2.txt or similar");
  require(!trainable.empty(), folder.string(), " has no files to train on, expected ",
          cmu ? "train/walking/walking_1.txt or similar"
              : "S1/walking_1.txt or similar, of S1, S6, S7, S8, S9, S11");
  out.actions = expmap_detail::chosen(selection.actions, testable, "test", folder);
  std::vector<std::string> trained =
      expmap_detail::chosen(selection.train_actions, trainable, "training", folder);
  std::sort(trained.begin(), trained.end());
  std::set_union(trained.begin(), trained.end(), testable.begin(), testable.end(),
                 std::back_inserter(out.classes));

  fs::path first;
  const auto read = [&](const fs::path& below, const std::string& action) {
    ExpmapClip clip{fs::path(below).replace_extension().generic_string(), action, folder / below, {}};
    clip.text = read_expmap_text(clip.path);
    if (out.columns == 0) out.columns = clip.text.columns, first = clip.path;
    require(clip.text.columns == out.columns, clip.path.string(), " has ", clip.text.columns,
            " numbers per line, ", first.string(), " has ", out.columns,
            "; expected the same number in all files");
    return clip;
  };
  for (const std::string& action : trained)
    for (const fs::path& file : expmap_detail::training_files(folder, out.layout, action))
      out.train.push_back(read(file, action));
  for (const std::string& action : out.actions)
    for (const char* part : {"_1.txt", "_2.txt"}) {
      if (cmu && part[1] == '2') break;
      const fs::path where = cmu ? fs::path("test") / action : fs::path("S5");
      out.test.push_back(read(where / (action + part), action));
    }
  return out;
}

}  // namespace motiongan::motion

// Which action (or emotion, or style) a clip shows, and who performs it: from a file, from folders or from
// the file's name.
#pragma once
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/formats/tab_lines.hpp"
#include "motiongan/formats/text_file.hpp"

namespace motiongan::motion {

/// The label of each clip, by clip id.
using ActionLabels = std::map<std::string, std::string, std::less<>>;

/// Reads lines of `clip id <TAB> label`. Lines that start with # and blank lines are skipped; the same line
/// may stand twice. Errors are `name:line: ...`: no tab, no id, no label, a clip with two labels, text that
/// is not UTF-8.
inline ActionLabels parse_action_labels(std::string_view text, std::string_view name) {
  ActionLabels out;
  std::map<std::string, std::size_t, std::less<>> lines;  // where each clip was labelled
  for_each_tab_line(text, name, "clip id <TAB> label", [&](const TabLine& line) {
    require(is_utf8(line.raw), name, ":", line.number,
            ": found text that is not UTF-8; save the file as UTF-8");
    const std::string id(line.before), label(line.after);
    require(!id.empty(), name, ":", line.number, ": found no clip id before the tab");
    require(!label.empty(), name, ":", line.number, ": clip '", id, "' has no label after the tab");
    const std::size_t first = lines.emplace(id, line.number).first->second;
    const std::string& known = out.emplace(id, label).first->second;
    require(known == label, name, ":", line.number, ": clip '", id, "' has the label '", label,
            "', but in line ", first, " '", known, "'; a clip has one label");
  });
  return out;
}

/// See parse_action_labels. Error too where the file cannot be read or has no labels.
inline ActionLabels read_action_labels(const std::filesystem::path& path) {
  ActionLabels labels = parse_action_labels(read_text(path, "label file"), path.string());
  require(!labels.empty(), path.string(), " holds no labels, expected lines of clip id <TAB> label");
  return labels;
}

/// The label of a file in a folder of labels: the first folder below `root` (`walk/01.bvh`: "walk"). Error
/// for a file that lies in `root` itself.
inline std::string label_from_folder(const std::filesystem::path& file, const std::filesystem::path& root) {
  const std::filesystem::path below = file.lexically_relative(root);
  require(!below.empty() && below.has_parent_path() && *below.begin() != "..", file.string(),
          " lies in no folder below ", root.string(),
          ", expected one that is called as the clip's class, such as walk/", file.filename().string());
  return below.begin()->string();
}

/// What a name says by a pattern; empty what the pattern does not ask for.
struct NameParts {
  std::string label, subject;
};

/// A pattern of file names without extension: `{label}` and `{subject}` stand for one or more characters but
/// '_', `*` for any characters or none, everything else for itself. "dataset-1_*_{label}_*" finds "happy" in
/// dataset-1_walk_happy_001. Where a name can be read in several ways, each `*` from the left is as short as
/// it can be.
class NamePattern {
 public:
  /// Error for other braces, for a field that comes twice, and for two fields side by side.
  explicit NamePattern(std::string text) : text_(std::move(text)) {
    for (std::size_t at = 0; at < text_.size();) {
      const std::string_view rest = std::string_view(text_).substr(at);
      const auto field = [&](std::string_view word, Kind kind) {
        if (!rest.starts_with(word)) return false;
        require(std::none_of(parts_.begin(), parts_.end(), [&](const Part& p) { return p.kind == kind; }),
                "the pattern '", text_, "' has ", word, " twice, expected it once");
        require(parts_.empty() || parts_.back().kind == Kind::literal || parts_.back().kind == Kind::any,
                "the pattern '", text_, "' has nothing between ", word,
                " and the field before it: where the one ends could not be told");
        parts_.push_back({kind, {}});
        at += word.size();
        return true;
      };
      if (field("{label}", Kind::label) || field("{subject}", Kind::subject)) continue;
      const char c = text_[at++];
      require(c != '{' && c != '}', "the pattern '", text_, "' has a '", c, "' at character ", at,
              ", expected {label}, {subject}, * and text without braces");
      if (c == '*')
        parts_.push_back({Kind::any, {}});
      else if (!parts_.empty() && parts_.back().kind == Kind::literal)
        parts_.back().text += c;
      else
        parts_.push_back({Kind::literal, std::string(1, c)});
    }
    require(!parts_.empty(), "the pattern of file names is empty, expected such as *_{label}_*");
  }

  const std::string& text() const { return text_; }
  bool has_label() const { return has(Kind::label); }
  bool has_subject() const { return has(Kind::subject); }

  /// What the name says. Error, with pattern and name, for a name that does not match.
  NameParts parse(std::string_view name) const {
    NameParts found;
    // rest[part][at]: whether the parts from `part` on can be all of the name from `at` on; from the back.
    std::vector<std::vector<char>> rest(parts_.size() + 1, std::vector<char>(name.size() + 1, 0));
    rest[parts_.size()][name.size()] = 1;
    for (std::size_t p = parts_.size(); p-- > 0;)
      for (std::size_t at = 0; at <= name.size(); ++at) {
        const auto [low, high] = reach(parts_[p], name, at);
        for (std::size_t n = low; n <= high && high != nowhere; ++n) rest[p][at] |= rest[p + 1][at + n];
      }
    require(rest[0][0] != 0, "the name '", name, "' does not match the pattern '", text_,
            "' ({label} and {subject}: one or more characters but '_'; *: any characters)");
    for (std::size_t p = 0, at = 0; p < parts_.size(); ++p) {
      auto [n, high] = reach(parts_[p], name, at);
      while (rest[p + 1][at + n] == 0) ++n;
      if (parts_[p].kind == Kind::label) found.label = name.substr(at, n);
      if (parts_[p].kind == Kind::subject) found.subject = name.substr(at, n);
      at += n;
    }
    return found;
  }

 private:
  enum class Kind { literal, any, label, subject };
  struct Part {
    Kind kind;
    std::string text;
  };
  static constexpr std::size_t nowhere = static_cast<std::size_t>(-1);

  bool has(Kind kind) const {
    return std::any_of(parts_.begin(), parts_.end(), [&](const Part& p) { return p.kind == kind; });
  }

  /// How many characters from `at` on the part can stand for: from .. to; `nowhere` for none at all.
  static std::pair<std::size_t, std::size_t> reach(const Part& part, std::string_view name, std::size_t at) {
    if (part.kind == Kind::any) return {0, name.size() - at};
    if (part.kind == Kind::literal) {
      const bool fits = name.substr(at).starts_with(part.text);
      return {part.text.size(), fits ? part.text.size() : nowhere};
    }
    const std::size_t run = std::min(name.find('_', at), name.size()) - at;
    return {1, run > 0 ? run : nowhere};
  }

  std::string text_;
  std::vector<Part> parts_;
};

/// Who performs a clip where no pattern says so: the text before the name's first '_' (`07_01`: "07"). Error
/// for a name without.
inline std::string subject_from_name(std::string_view name) {
  const std::size_t end = name.find('_');
  require(end != name.npos && end > 0, "the name '", name,
          "' does not begin with a subject and '_', as 07_01 does; say where names have the subject with a "
          "pattern such as {subject}-*");
  return std::string(name.substr(0, end));
}

}  // namespace motiongan::motion

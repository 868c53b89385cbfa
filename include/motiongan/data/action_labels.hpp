// Labels (action, emotion or style) and subjects of clips: from a file, from folders or from file names.
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

/// Reads lines of `clip id <TAB> label`. Blank lines and lines that start with # are skipped; identical lines
/// may repeat. Throws Error as `name:line: ...` for a missing tab, id or label, a clip with two labels, or
/// text that is not UTF-8.
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

/// As parse_action_labels, from a file. Throws Error also if the file cannot be read or has no labels.
inline ActionLabels read_action_labels(const std::filesystem::path& path) {
  ActionLabels labels = parse_action_labels(read_text(path, "label file", largest_list_file), path.string());
  require(!labels.empty(), path.string(), " holds no labels, expected lines of clip id <TAB> label");
  return labels;
}

/// The label of a file by its folder: the first folder below `root` (`walk/01.bvh`: "walk"). Throws Error for
/// a file directly in `root`.
inline std::string label_from_folder(const std::filesystem::path& file, const std::filesystem::path& root) {
  const std::filesystem::path below = file.lexically_relative(root);
  require(!below.empty() && below.has_parent_path() && *below.begin() != "..", file.string(),
          " is not in a subfolder of ", root.string(),
          ", expected one named after the clip's class, such as walk/", file.filename().string());
  return below.begin()->string();
}

/// What a pattern finds in a name; empty for fields that the pattern does not have.
struct NameParts {
  std::string label, subject;
};

/// A pattern for file names without extension: `{label}` and `{subject}` match one or more characters except
/// '_', `*` matches any characters or none, everything else matches itself. "dataset-1_*_{label}_*" finds
/// "happy" in dataset-1_walk_happy_001. If a name matches in several ways, each `*` from the left is as short
/// as possible.
class NamePattern {
 public:
  /// Throws Error for other braces, a field that appears twice, and two adjacent fields.
  explicit NamePattern(std::string text) : text_(std::move(text)) {
    for (std::size_t at = 0; at < text_.size();) {
      const std::string_view rest = std::string_view(text_).substr(at);
      const auto field = [&](std::string_view word, Kind kind) {
        if (!rest.starts_with(word)) return false;
        require(std::none_of(parts_.begin(), parts_.end(), [&](const Part& p) { return p.kind == kind; }),
                "the pattern '", text_, "' has ", word, " twice, expected it once");
        require(parts_.empty() || parts_.back().kind == Kind::literal || parts_.back().kind == Kind::any,
                "the pattern '", text_, "' has nothing between ", word,
                " and the field before it: the boundary would be ambiguous");
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
    require(!parts_.empty(), "the file name pattern is empty, expected for example *_{label}_*");
  }

  const std::string& text() const { return text_; }
  bool has_label() const { return has(Kind::label); }
  bool has_subject() const { return has(Kind::subject); }

  /// The label and subject in the name. Throws Error, with pattern and name, for a name that does not match.
  NameParts parse(std::string_view name) const {
    NameParts found;
    // rest[part][at]: whether the parts from `part` on match all of the name from `at` on; filled from the
    // back, with a time that does not grow with the characters that a part may match.
    std::vector<std::vector<char>> rest(parts_.size() + 1, std::vector<char>(name.size() + 1, 0));
    rest[parts_.size()][name.size()] = 1;
    for (std::size_t p = parts_.size(); p-- > 0;)
      for (std::size_t at = name.size() + 1; at-- > 0;) {
        const std::vector<char>& next = rest[p + 1];
        const bool inside = at < name.size(), longer = inside && rest[p][at + 1] != 0;
        switch (parts_[p].kind) {
          case Kind::any:
            rest[p][at] = next[at] != 0 || longer;
            break;
          case Kind::literal:
            rest[p][at] =
                name.substr(at).starts_with(parts_[p].text) && next[at + parts_[p].text.size()] != 0;
            break;
          case Kind::label:
          case Kind::subject:
            rest[p][at] = inside && name[at] != '_' && (next[at + 1] != 0 || longer);
            break;
        }
      }
    require(rest[0][0] != 0, "the name '", name, "' does not match the pattern '", text_,
            "' ({label} and {subject}: one or more characters but '_'; *: any characters)");
    for (std::size_t p = 0, at = 0; p < parts_.size(); ++p) {
      const Kind kind = parts_[p].kind;
      std::size_t n = kind == Kind::literal ? parts_[p].text.size() : kind == Kind::any ? 0 : 1;
      while (rest[p + 1][at + n] == 0) ++n;  // as short as possible
      if (kind == Kind::label) found.label = name.substr(at, n);
      if (kind == Kind::subject) found.subject = name.substr(at, n);
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

  bool has(Kind kind) const {
    return std::any_of(parts_.begin(), parts_.end(), [&](const Part& p) { return p.kind == kind; });
  }

  std::string text_;
  std::vector<Part> parts_;
};

/// The subject of a clip without a pattern: the text before the name's first '_' (`07_01`: "07"). Throws
/// Error for a name without one.
inline std::string subject_from_name(std::string_view name) {
  const std::size_t end = name.find('_');
  require(end != name.npos && end > 0, "the name '", name,
          "' does not begin with a subject and '_', as 07_01 does; give a pattern that locates the subject, "
          "such as {subject}-*");
  return std::string(name.substr(0, end));
}

}  // namespace motiongan::motion

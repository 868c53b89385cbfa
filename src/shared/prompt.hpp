// Model files, texts and names of output files; shared by generate, complete and other verbs.
#pragma once
#include <set>

#include "motiongan/data/motion_format.hpp"
#include "motiongan/data/nearest_descriptions.hpp"
#include "motiongan/data/vocabulary.hpp"
#include "motiongan/formats/tab_lines.hpp"
#include "motiongan/formats/text_file.hpp"
#include "motiongan/train/run.hpp"
#include "shared/command.hpp"

namespace motiongan::command {

/// Throws Error if the text of --text has no words or is not UTF-8.
inline void check_text(const std::string& text) {
  require(!motion::split_words(text).empty(), "--text \"", text, "\" has no words; describe a motion");
  require(motion::is_utf8(text), "the text \"", text, "\" is not UTF-8");
}

/// The texts of a file, one per line; blank lines and lines that start with # are skipped. Throws Error as
/// `file:line: ...` for a text without words or that is not UTF-8, and if there is none.
inline std::vector<std::string> read_prompts(const fs::path& file) {
  const std::string name = file.string(),
                    all = motion::read_text(file, "prompt file", motion::largest_list_file);
  std::vector<std::string> texts;
  motion::for_each_line(all, name, [&](const motion::TextLine& line) {
    require(motion::is_utf8(line.raw), name, ":", line.number,
            ": found text that is not UTF-8; save the file as UTF-8");
    require(!motion::split_words(line.text).empty(), name, ":", line.number, ": \"", line.text,
            "\" has no words; describe a motion");
    texts.emplace_back(line.text);
  });
  require(!texts.empty(), name, " has no prompts; write one per line");
  return texts;
}

/// A file name for a text: its words joined by dashes, at most 60 bytes.
inline std::string slug(const std::string& text) {
  std::string out;
  for (const std::string& word : motion::split_words(text)) {
    if (!out.empty() && out.size() + word.size() > 60) break;
    out += (out.empty() ? "" : "-") + word;
  }
  if (out.size() > 60) {  // one long word: cut it between two characters
    out.resize(60);
    while (!motion::is_utf8(out)) out.pop_back();
  }
  return out;
}

/// Warns of words that the model was not trained on, and names the nearest of its descriptions. Throws Error
/// instead if `strict`.
inline void check_words(const motion::MotionFormat& format, const std::string& text, bool strict) {
  if (const std::string note = motion::word_limit_note(text); !note.empty())
    fmt::print(stderr, "motiongan: a text {}\n", note);
  const std::vector<std::string> words = format.vocabulary.unknown_words(text);
  if (words.empty()) return;
  const auto quoted = [](const std::vector<std::string>& texts) {
    std::string list;
    for (const std::string& one : texts) list += (list.empty() ? "\"" : ", \"") + one + "\"";
    return list;
  };
  const std::string never = fmt::format("\"{}\": the model never saw {}", text, quoted(words));
  const std::vector<std::string> nearest = motion::nearest_descriptions(format.descriptions, text);
  std::string advice;
  if (!nearest.empty())
    advice = "; nearest of its descriptions: " + quoted(nearest);
  else if (!format.descriptions.empty())
    advice = "; its descriptions are, for example: " +
             quoted({format.descriptions.begin(),
                     format.descriptions.begin() +
                         static_cast<std::ptrdiff_t>(std::min<std::size_t>(3, format.descriptions.size()))});
  require(!strict, never, advice);
  fmt::print(stderr, "motiongan: {}{}{}\n", never,
             words.size() == motion::used_words(text).size() ? "; it knows no word of this text"
                                                             : "; treated as unknown",
             advice);
}

/// Adds --strict to a verb that generates for a text.
inline void add_strict_option(CLI::App& verb, bool& strict) {
  verb.add_flag("--strict", strict,
                "refuse a text with words that the model never saw [off: treat them as unknown]");
}

/// NAME_000.bvh and so on, or with another format, for samples `first` to `first` + `count` - 1.
inline std::vector<fs::path> sample_files(const fs::path& folder, const std::string& name, std::size_t first,
                                          std::size_t count, const std::string& format = "bvh") {
  std::vector<fs::path> files;
  for (std::size_t i = 0; i < count; ++i)
    files.push_back(folder / fmt::format("{}_{:03}.{}", name, first + i, format));
  return files;
}

/// "new/walk_000.bvh", or "new/walk_000.bvh to walk_003.bvh".
inline std::string named(const std::vector<fs::path>& files) {
  const std::string first = files.front().string();
  return files.size() == 1 ? first : fmt::format("{} to {}", first, files.back().filename().string());
}

/// Throws Error if a sample number exceeds 32 bits.
inline void check_samples(std::size_t first, std::size_t count) {
  require(first <= 0xFFFFFFFFu && count <= 0xFFFFFFFFu - first, "--first-sample ", first, " and --count ",
          count, " exceed the largest sample number, 4294967295");
}

}  // namespace motiongan::command

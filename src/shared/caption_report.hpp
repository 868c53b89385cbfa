// What is said of captions that fit no clip, and of clips without captions.
#pragma once
#include <algorithm>
#include <string>
#include <vector>

#include "motiongan/data/caption_match.hpp"
#include "shared/command.hpp"

namespace motiongan::command {

/// "a, b, c", with the first five names only.
inline std::string first_names(const std::vector<std::string>& names) {
  constexpr std::size_t most = 5;
  std::string out;
  for (std::size_t i = 0; i < std::min(most, names.size()); ++i) out += (i > 0 ? ", " : "") + names[i];
  return names.size() > most ? out + ", ..." : out;
}

/// A line on the captions that match no clip, and one on the clips without a caption; empty if all fits.
inline std::vector<std::string> caption_remarks(const motion::CaptionReport& report) {
  std::vector<std::string> out;
  if (const auto& names = report.unmatched; !names.empty())
    out.push_back(fmt::format("{} {} no clip: {}", counted(names.size(), "caption"),
                              names.size() == 1 ? "matches" : "match", first_names(names)));
  if (const auto& names = report.without; !names.empty())
    out.push_back(fmt::format("{} {} no caption: {}", counted(names.size(), "clip"),
                              names.size() == 1 ? "has" : "have", first_names(names)));
  return out;
}

/// Where captions are looked for without --captions.
inline constexpr const char* no_captions_found =
    "no captions.tsv, .csv or .json in the folder, no .txt beside the clips, no --captions";

}  // namespace motiongan::command

// What holds for the captions of any file.
#pragma once
#include <cmath>
#include <motiongan/data/captions.hpp>

#include "target.hpp"

namespace motiongan::fuzz {

inline void demand_captions(const motion::CaptionFile& file) {
  for (const motion::CaptionLine& line : file.lines) {
    demand(!line.id.empty(), "a caption has a clip's id");
    demand(motion::is_utf8(line.caption.text), "a caption is UTF-8");
    demand(!motion::split_words(line.caption.text).empty(), "a caption has words");
    if (!line.caption.part) continue;
    const auto [begin, end] = *line.caption.part;
    demand(std::isfinite(begin) && begin >= 0 && end > begin, "a part has a begin before its end");
  }
  const motion::ClipName names[] = {{"a", "sub/a", "a"}, {"b", "b", "b"}};
  try {
    motion::match_captions(file, names);
  } catch (const Error&) {  // ids of other clips
  }
}

}  // namespace motiongan::fuzz

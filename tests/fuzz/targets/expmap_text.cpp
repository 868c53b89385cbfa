// Exponential maps as text.
#include <motiongan/formats/expmap_text.hpp>

#include "../target.hpp"

namespace motiongan::fuzz {

const Target expmap_text_target{
    "expmap_text", [](std::string_view bytes) {
      const motion::ExpmapText text = motion::parse_expmap_text(bytes, "input.txt");
      demand(text.frames > 0 && text.columns % 3 == 0, "there are frames of three numbers per joint");
      demand(text.values.size() == text.frames * text.columns, "all frames have as many numbers");
    }};

}  // namespace motiongan::fuzz

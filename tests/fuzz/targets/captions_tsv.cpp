// Captions as lines of clip id, tab and description.
#include "../captions.hpp"

namespace motiongan::fuzz {

const Target captions_tsv_target{"captions_tsv", [](std::string_view bytes) {
                                   demand_captions(motion::parse_caption_lines(bytes, "captions.tsv"));
                                 }};

}  // namespace motiongan::fuzz

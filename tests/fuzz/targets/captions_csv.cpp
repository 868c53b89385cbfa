// Captions as CSV.
#include "../captions.hpp"

namespace motiongan::fuzz {

const Target captions_csv_target{"captions_csv", [](std::string_view bytes) {
                                   demand_captions(motion::parse_caption_csv(bytes, "captions.csv"));
                                 }};

}  // namespace motiongan::fuzz

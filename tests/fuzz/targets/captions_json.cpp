// Captions as JSON.
#include "../captions.hpp"
#include "../mutate_json.hpp"

namespace motiongan::fuzz {

const Target captions_json_target{
    "captions_json",
    [](std::string_view bytes) { demand_captions(motion::parse_caption_json(bytes, "captions.json")); },
    mutate_json};

}  // namespace motiongan::fuzz

// Labels of clips.
#include <motiongan/data/action_labels.hpp>

#include "../target.hpp"

namespace motiongan::fuzz {

const Target labels_target{"labels", [](std::string_view bytes) {
                             for (const auto& [id, label] : motion::parse_action_labels(bytes, "labels.tsv"))
                               demand(!id.empty() && !label.empty() && motion::is_utf8(label),
                                      "a clip has an id and a label in UTF-8");
                           }};

}  // namespace motiongan::fuzz

// Patterns for file names: a pattern in the first line, a name in each of the others.
#include <motiongan/data/action_labels.hpp>

#include "../target.hpp"

namespace motiongan::fuzz {

const Target name_pattern_target{
    "name_pattern", [](std::string_view bytes) {
      const motion::NamePattern pattern{std::string(motion::take_line(bytes))};
      while (!bytes.empty()) {
        const motion::NameParts parts = pattern.parse(motion::take_line(bytes));
        demand(parts.label.empty() != pattern.has_label(), "a label is found where the pattern has one");
        demand(parts.subject.empty() != pattern.has_subject(), "so is a subject");
      }
    }};

}  // namespace motiongan::fuzz

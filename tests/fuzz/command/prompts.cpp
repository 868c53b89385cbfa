// Files of prompts, one per line.
#include "shared/prompt.hpp"

#include "../memory_folder.hpp"
#include "../target.hpp"

namespace motiongan::fuzz {

const Target prompts_target{
    "prompts", [](std::string_view bytes) {
      for (const std::string& text : command::read_prompts(memory_folder().write("prompts.txt", bytes))) {
        must("a prompt that is read is a text", [&] { command::check_text(text); });
        const std::string name = command::slug(text);
        demand(!name.empty() && name.size() <= 60 && motion::is_utf8(name),
               "a prompt gives the name of a file");
      }
    }};

}  // namespace motiongan::fuzz

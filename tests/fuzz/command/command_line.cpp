// Command lines, one argument per line. They are parsed; no verb is run.
#include "shared/command_line.hpp"

#include <sstream>

#include "../target.hpp"
#include "motiongan/formats/tab_lines.hpp"

namespace motiongan::fuzz {

const Target command_line_target{"command_line", [](std::string_view bytes) {
                                   std::vector<std::string> arguments;
                                   while (!bytes.empty()) arguments.emplace_back(motion::take_line(bytes));
                                   std::ostringstream out, err;
                                   command::CommandLine line(out, err);
                                   const bool runs = !line.parse(arguments).has_value();
                                   demand(runs || !out.str().empty() || !err.str().empty(),
                                          "a command line that runs nothing says why, or shows help");
                                 }};

}  // namespace motiongan::fuzz

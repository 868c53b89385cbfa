// Command lines, one argument per line. They are parsed; no verb is run.
#include "shared/command_line.hpp"

#include <algorithm>
#include <sstream>
#include <utility>
#include <vector>

#include "../target.hpp"
#include "motiongan/formats/tab_lines.hpp"

namespace motiongan::fuzz {
namespace {

/// Keeps the verbs that the arguments name, while it lives: describing the options of all of them takes a
/// hundred times as long as parsing a line.
class OnlyNamedVerbs {
 public:
  explicit OnlyNamedVerbs(const std::vector<std::string>& arguments) : all_(command::Verb::all()) {
    std::erase_if(command::Verb::all(), [&](const command::Verb& verb) {
      const std::string last = verb.name.substr(verb.name.rfind(' ') + 1);
      return std::find(arguments.begin(), arguments.end(), last) == arguments.end();
    });
  }
  OnlyNamedVerbs(const OnlyNamedVerbs&) = delete;
  OnlyNamedVerbs& operator=(const OnlyNamedVerbs&) = delete;
  ~OnlyNamedVerbs() { command::Verb::all() = all_; }

 private:
  std::vector<command::Verb> all_;
};

}  // namespace

const Target command_line_target{"command_line", [](std::string_view bytes) {
                                   std::vector<std::string> arguments;
                                   while (!bytes.empty()) arguments.emplace_back(motion::take_line(bytes));
                                   const OnlyNamedVerbs verbs(arguments);
                                   std::ostringstream out, err;
                                   command::CommandLine line(out, err);
                                   const bool runs = !line.parse(arguments).has_value();
                                   demand(runs || !out.str().empty() || !err.str().empty(),
                                          "a command line that runs nothing says why, or shows help");
                                 }};

}  // namespace motiongan::fuzz

// The command line of all verbs.
#pragma once
#include <iosfwd>
#include <map>
#include <optional>

#include "shared/command.hpp"

namespace motiongan::command {

/// Parses one command line; then runs its verb, which may refer to the parser.
class CommandLine {
 public:
  /// Help goes to `out`, messages about wrong options to `err`.
  CommandLine(std::ostream& out, std::ostream& err);
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  /// Parses the arguments, without the program's name. Returns the exit status if there is nothing to run:
  /// help was asked for, or an option is wrong. Throws Error where a verb refuses an option, and where
  /// several processes were started for a verb of one.
  std::optional<int> parse(std::vector<std::string> arguments);

  /// Runs the verb; returns the exit status.
  int run() { return job_(); }

 private:
  /// The app, or the group that a verb's name begins with.
  CLI::App& parent_of(const Verb& verb);

  std::ostream &out_, &err_;
  CLI::App app_;
  Job job_;
  std::map<std::string, CLI::App*> groups_;
};

}  // namespace motiongan::command

// The motiongan command: parses the command line and runs the verb. Each verb registers itself from its own
// file.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <new>

#include "shared/command.hpp"
#include "shared/shell.hpp"
#include "shared/signals.hpp"

namespace motiongan::command {
namespace {

/// CLI11's help without the "{false}" notes on negated flags.
class Help : public CLI::Formatter {
 public:
  std::string make_option_name(const CLI::Option* option, bool is_positional) const override {
    std::string name = CLI::Formatter::make_option_name(option, is_positional);
    for (const std::string note = "{false}"; name.find(note) != std::string::npos;)
      name.erase(name.find(note), note.size());
    return name;
  }
};

/// What CLI11 says when it could not convert the value of an option, "Could not convert: --batch = 2.5", with
/// what was expected instead.
CLI::ParseError explained(const CLI::ConversionError& error) {
  const std::string_view text = error.what(), start = "Could not convert: ";
  if (refused_number().empty() || !text.starts_with(start)) return error;
  const std::string_view name = text.substr(start.size(), text.find(" = ") - start.size());
  return CLI::ValidationError(std::string(name), refused_number());
}

int run(int argc, char** argv) {
  CLI::App app(
      "motiongan trains GANs on motion clips with captions or class labels, and generates new motion for a\n"
      "text or a class.\n"
      "`motiongan VERB --help` lists the options of a verb; `motiongan demo` is a tour of a few minutes.");
  app.name("motiongan");
  app.set_version_flag("--version", "motiongan " MOTIONGAN_VERSION);
  app.require_subcommand(1);
  app.fallthrough();
  app.formatter(std::make_shared<Help>());
  app.get_formatter()->column_width(34);
  app.add_option_function<std::string>(
         "--device",
         [](const std::string& wish) {
           require(setenv("MOTIONGAN_DEVICE", wish.c_str(), 1) == 0, "cannot set MOTIONGAN_DEVICE");
         },
         "OpenCL device: cpu, gpu, part of its name, or NAME:index (overrides MOTIONGAN_DEVICE; see "
         "`motiongan devices`)")
      ->type_name("DEVICE");
  Job job;
  std::map<std::string, CLI::App*> groups;
  for (const auto& [name, description] :
       {std::pair{"train", "Train a model on motion clips with captions or classes"},
        {"ablate", "Train a model with and without each of its parts, and compare"},
        {"evaluate", "Evaluate models and motion with the papers' metrics and others"}}) {
    groups[name] = app.add_subcommand(name, description);
    groups[name]->require_subcommand(1);
  }
  std::sort(Verb::all().begin(), Verb::all().end());
  for (const auto& [name, add] : Verb::all()) {
    const std::size_t space = name.find(' ');
    add(space == std::string::npos ? app : *groups.at(name.substr(0, space)), job);
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ConversionError& error) {
    return app.exit(explained(error));
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  }
  return job();
}

}  // namespace
}  // namespace motiongan::command

int main(int argc, char** argv) {
  using namespace motiongan::command;
  open_standard_streams();
  // Line-buffered, so that stdout and the progress on stderr keep their order when both go to one file.
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  if (argc > 0 && *argv[0] != '\0') program() = shell_word(argv[0]);
  try {
    const int status = run(argc, argv);
    flush_output();
    return status;
  } catch (const std::bad_alloc&) {
    std::fputs("motiongan: out of memory\n", stderr);
  } catch (const motiongan::DivergedError& error) {
    std::fprintf(stderr, "motiongan: %s\n", error.what());
    return exit_diverged;
  } catch (const std::filesystem::filesystem_error& error) {  // such as a link that leads to itself
    std::fprintf(stderr, "motiongan: %s cannot be reached: %s\n", error.path1().c_str(),
                 error.code().message().c_str());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "motiongan: %s\n", error.what());
  }
  // Also where a pipe broke and the error is that nothing more can be printed.
  return caught_signal() != 0 ? 128 + caught_signal() : exit_failure;
}

// The motiongan command: one verb after another, each in a file of its own.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <new>

#include "shared/command.hpp"

namespace motiongan::command {
namespace {

/// CLI11's help, without the notes on what a negated flag is worth.
class Help : public CLI::Formatter {
 public:
  std::string make_option_name(const CLI::Option* option, bool is_positional) const override {
    std::string name = CLI::Formatter::make_option_name(option, is_positional);
    for (const std::string note = "{false}"; name.find(note) != std::string::npos;)
      name.erase(name.find(note), note.size());
    return name;
  }
};

int run(int argc, char** argv) {
  CLI::App app(
      "motiongan trains GANs on motion clips and their captions or classes, and makes new motion for a "
      "text\nor a class.\n"
      "`motiongan VERB --help` lists the options of a verb; `motiongan demo` shows all of it in minutes.");
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
         "OpenCL device: cpu, gpu, a part of its name, or NAME:index (as MOTIONGAN_DEVICE; see `motiongan "
         "devices`)")
      ->type_name("WISH");
  Job job;
  std::map<std::string, CLI::App*> groups;
  for (const auto& [name, description] : {std::pair{"train", "Train a model on motion clips with captions or classes"},
                                          {"ablate", "Compare a model with itself without each of its parts"},
                                          {"evaluate", "Measure models and motion as the papers do"}}) {
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
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  }
  return job();
}

}  // namespace
}  // namespace motiongan::command

int main(int argc, char** argv) {
  // Lines appear when they are written, also between the lines of the progress bar in a file.
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  if (argc > 0 && *argv[0] != '\0') motiongan::command::program() = argv[0];
  try {
    return motiongan::command::run(argc, argv);
  } catch (const std::bad_alloc&) {
    std::fputs("motiongan: out of memory\n", stderr);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "motiongan: %s\n", error.what());
  }
  return 1;
}

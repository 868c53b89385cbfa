#include "shared/command_line.hpp"

#include <algorithm>

#include "motiongan/core/os.hpp"
#include "shared/ranks.hpp"

#include "motiongan/version.hpp"

namespace motiongan::command {
namespace {

constexpr const char* description =
    "motiongan trains GANs on motion clips with captions or class labels, and generates new motion for a\n"
    "text or a class.\n"
    "`motiongan VERB --help` lists the options of a verb; `motiongan demo` is a tour of a few minutes.";

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

}  // namespace

CommandLine::CommandLine(std::ostream& out, std::ostream& err) : out_(out), err_(err), app_(description) {
  app_.name("motiongan");
  app_.set_version_flag("--version", "motiongan " MOTIONGAN_VERSION_STRING);
  app_.require_subcommand(1);
  app_.fallthrough();
  app_.formatter(std::make_shared<Help>());
  app_.get_formatter()->column_width(34);
  app_.add_option_function<std::string>(
          "--device",
          [](const std::string& wish) {
            require(os::set_environment("MOTIONGAN_DEVICE", wish), "cannot set MOTIONGAN_DEVICE");
          },
          "OpenCL device: cpu, gpu, part of its name, or NAME:index (overrides MOTIONGAN_DEVICE; see "
          "`motiongan devices`)")
      ->type_name("DEVICE");
  for (const auto& [name, does] :
       {std::pair{"train", "Train a model on motion clips with captions or classes"},
        {"ablate", "Train a model with and without each of its parts, and compare"},
        {"evaluate", "Evaluate models and motion with the papers' metrics and others"}}) {
    groups_[name] = app_.add_subcommand(name, does);
    groups_[name]->require_subcommand(1);
  }
  std::sort(Verb::all().begin(), Verb::all().end(),
            [](const Verb& a, const Verb& b) { return a.name < b.name; });
  for (const Verb& verb : Verb::all()) verb.add(parent_of(verb), job_);
}

CLI::App& CommandLine::parent_of(const Verb& verb) {
  const std::size_t space = verb.name.find(' ');
  return space == std::string::npos ? app_ : *groups_.at(verb.name.substr(0, space));
}

std::optional<int> CommandLine::parse(std::vector<std::string> arguments) {
  std::reverse(arguments.begin(), arguments.end());  // CLI11 takes them from the back
  try {
    app_.parse(std::move(arguments));
  } catch (const CLI::ConversionError& error) {
    return app_.exit(explained(error), out_, err_);
  } catch (const CLI::ParseError& error) {
    return app_.exit(error, out_, err_);
  }
  for (const Verb& verb : Verb::all())
    require(verb.runs == Verb::Runs::on_ranks || launched_ranks() == 1 ||
                !parent_of(verb).got_subcommand(verb.name.substr(verb.name.find(' ') + 1)),
            "motiongan ", verb.name, " works in one process, and ", launched_ranks(),
            " were started; start it without mpirun");
  return std::nullopt;
}

}  // namespace motiongan::command

// motiongan models: lists the models that come with motiongan.
#include <algorithm>

#include "motiongan/models/action_gan.hpp"
#include "motiongan/models/dvgan.hpp"
#include "motiongan/models/shipped_models.hpp"
#include "shared/command.hpp"
#include "shared/shell.hpp"

namespace motiongan::command {
namespace {

/// `texts` with commas between them, as many as fit on a line; "..." stands for the others.
std::string some_of(const std::vector<std::string>& texts, bool quoted) {
  std::string out;
  for (const std::string& text : texts) {
    const std::string next = (out.empty() ? "" : ", ") + (quoted ? "\"" + text + "\"" : text);
    if (out.size() + next.size() > 88) return out + ", ...";
    out += next;
  }
  return out;
}

std::string frames_text(std::size_t frames, double rate) {
  return fmt::format("{} at {} frames a second", duration(static_cast<double>(frames) / rate), brief(rate));
}

void print_shipped(const ShippedModel& model) {
  check_shipped(model);
  const std::string where = model.file.string();
  const io::SafeTensors file = io::SafeTensors::read(model.file);
  std::string prompt;
  fmt::print("{}\n", model.name);
  if (holds_model<ActionGan>(file)) {
    const motion::PositionFormat format = model_format<ActionGan>(file, where);
    print_fact("makes", fmt::format("motion of any length in a class: {} after {}",
                                    frames_text(format.frames, format.rate), "the same of given motion"));
    print_fact("classes", some_of(format.classes, false));
    prompt = "--class " + format.classes.front();
  } else {
    const motion::MotionFormat format = model_format<Dvgan>(file, where);
    const bool endless = model_options<Dvgan>(file, where).generator == GeneratorKind::rnn;
    print_fact("makes", "motion for a text, " +
                            (endless ? fmt::format("of any length, at {} frames a second", brief(format.rate))
                                     : frames_text(format.frames, format.rate)));
    print_fact("words", fmt::format("{} in {}: {}", format.vocabulary.size() - 1,
                                    counted(format.descriptions.size(), "description"),
                                    some_of(format.descriptions, true)));
    prompt = "--text " + shell_quoted(format.descriptions.empty() ? "walk" : format.descriptions.front());
  }
  print_fact("file",
             fmt::format("{} ({:.1f} MB)", where, 1e-6 * static_cast<double>(fs::file_size(model.file))));
  print_fact("SHA-256", model.sha256);
  const fs::path card = fs::path(model.file).replace_extension(".md");
  if (fs::exists(card)) print_fact("card", card.string());
  print_fact("try", fmt::format("{} generate {} {} --html made.html", program(), model.name, prompt));
}

int list_models() {
  const std::vector<ShippedModel> models = shipped_models();
  if (models.empty()) {
    std::string searched;
    for (const fs::path& folder : model_folders()) searched += "\n  " + folder.string();
    throw Error("no models are installed; MOTIONGAN_MODELS names folders that have them. Looked in:",
                searched);
  }
  for (const ShippedModel& model : models) print_shipped(model);
  return 0;
}

const Verb models_verb{
    "models", [](CLI::App& app, Job& job) {
      CLI::App* verb = app.add_subcommand(
          "models",
          "List the trained models that come with motiongan: what they make, and whether "
          "their files are whole.\n"
          "All verbs that take a model take these by name. Folders of more, each with a "
          "list SHA256SUMS,\n"
          "are named in MOTIONGAN_MODELS, separated by colons; `motiongan pack` makes them.");
      verb->callback([&job] { job = list_models; });
    }};

}  // namespace
}  // namespace motiongan::command

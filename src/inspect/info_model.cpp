// Prints the contents of safetensors files: models, checkpoints, runs and others.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "inspect/info.hpp"
#include "motiongan/io/fields_json.hpp"
#include "motiongan/io/safetensors.hpp"
#include "motiongan/models/action_gan.hpp"
#include "motiongan/models/dvgan.hpp"
#include "motiongan/train/checkpoint.hpp"
#include "motiongan/train/csv_log.hpp"
#include "motiongan/train/run.hpp"

namespace motiongan::command {
namespace {

std::string millions(std::size_t n) {
  return n < 1000000 ? std::to_string(n) : fmt::format("{} million", brief(1e-6 * static_cast<double>(n), 3));
}

std::size_t count_below(const io::SafeTensors& file, std::string_view prefix) {
  std::size_t n = 0;
  for (const auto& [name, tensor] : file.tensors)
    if (name.starts_with(prefix)) n += tensor.count();
  return n;
}

/// Prints texts with `gap` between them, on lines of at most 100 characters below the fact's name.
void print_wrapped(std::string_view name, const std::vector<std::string>& texts, std::string_view gap) {
  std::string line;
  const auto flush = [&] {
    line.erase(line.find_last_not_of(' ') + 1);
    print_fact(name, line);
    name = "";
    line.clear();
  };
  for (std::size_t i = 0; i < texts.size(); ++i) {
    const std::string text = texts[i] + std::string(i + 1 < texts.size() ? gap : "");
    if (!line.empty() && line.size() + text.size() > 100) flush();
    line += text;
  }
  if (!line.empty()) flush();
}

/// Prints options, as the command or the library stores them in files.
void print_options(std::string_view fact, const std::string& json) {
  const auto options = io::parse_json(json);
  if (!options.is_object()) return;
  std::vector<std::string> texts;
  for (const auto& [key, value] : options.items()) {
    std::string name = key.starts_with("--") ? key.substr(2) : key;
    std::string text = value.is_string() ? value.get<std::string>() : value.dump();
    if (value.is_boolean()) text = value.get<bool>() ? "on" : "off";
    if (text.empty() || value.is_null() || value == nlohmann::json::array() ||
        (name == "procedural" && text == "0"))
      continue;
    if (name == "FOLDER") name = "folder";
    std::replace(name.begin(), name.end(), '_', '-');
    texts.push_back(fmt::format("{} {}", name, text));
  }
  print_wrapped(fact, texts, ", ");
}

void print_positions(const motion::PositionFormat& format) {
  const double second = static_cast<double>(format.frames) / format.rate;
  print_fact("motion", fmt::format("{} frames from the {} before them, at {} per second ({})", format.frames,
                                   format.frames, brief(format.rate), duration(second)));
  print_fact("skeleton",
             fmt::format("{}, root {}; {} per pose vary{}", counted(format.skeleton().size(), "joint"),
                         format.skeleton().joints.front().name, counted(format.dof(), "value"),
                         format.layout.root_track() ? ", including the root's steps, turns and height"
                                                    : "; the root stays in place"));
  print_fact("space", describe(format.space));
  print_wrapped("classes", format.classes, ", ");
}

/// Prints the motion format of a class-conditioned or a text-conditioned model.
void print_format(const io::SafeTensors& file, const std::string& where) {
  const auto text = file.metadata.find("format");
  require(text != file.metadata.end(), where, ": the model has no motion format in its metadata");
  if (holds_model<ActionGan>(file)) return print_positions(ActionGan::read_format(text->second, where));
  const motion::MotionFormat format = Dvgan::read_format(text->second, where);  // a ranker has the same
  print_fact("motion", fmt::format("{} frames at {} per second ({})", format.frames, brief(format.rate),
                                   duration(static_cast<double>(format.frames) / format.rate)));
  print_fact("skeleton",
             fmt::format("{}, root {}; {} per pose vary{}", counted(format.skeleton().size(), "joint"),
                         format.skeleton().joints[format.layout.root()].name, counted(format.dof(), "value"),
                         format.layout.root_position() ? ", including the root's position"
                                                       : "; the root stays in place"));
  print_fact("space", describe(format.space));
  print_fact("words", fmt::format("{}, and {} for all others:", format.vocabulary.size() - 1,
                                  motion::Vocabulary::unknown));
  const std::vector<std::string>& words = format.vocabulary.words();
  print_wrapped("", {words.begin() + 1, words.end()}, " ");
}

void print_other(const io::SafeTensors& file) {
  std::vector<std::vector<std::string>> rows;
  for (const auto& [name, tensor] : file.tensors)
    rows.push_back({name, tensor.dtype, io::shape_text(tensor.shape), std::to_string(tensor.count())});
  print_table({"tensor", "type", "shape", "numbers"}, rows, "lllr", "  ");
  if (!file.metadata.empty()) fmt::print("  metadata\n");
  for (const auto& [key, value] : file.metadata)
    fmt::print("    {}: {}\n", key, value.size() > 300 ? value.substr(0, 300) + "..." : value);
}

}  // namespace

void print_tensors(const fs::path& path) {
  const std::string where = path.string();
  const io::SafeTensors file = io::SafeTensors::read(path);
  const auto model = file.metadata.find("motiongan_model");
  const bool checkpoint = is_checkpoint(file) && model != file.metadata.end();
  const std::size_t numbers = count_below(file, "");
  if (model == file.metadata.end()) {
    fmt::print("{}: {} with {} numbers\n", where, counted(file.tensors.size(), "tensor"), millions(numbers));
    print_other(file);
    return;
  }
  fmt::print("{}: {}\n", where, checkpoint ? "a checkpoint of a training run" : "a model, " + model->second);
  if (checkpoint) {
    print_fact("iteration", file.metadata.at("iteration"));
    for (const char* network : {"generator", "critic", "classifier"})
      if (const std::size_t n = count_below(file, std::string(network) + "."); n > 0)
        print_fact(network, millions(n) + " parameters");
  } else {
    // The seconds to continue, in a file of a class-conditioned model, are no weights.
    print_fact("parameters", millions(numbers - count_below(file, "start.")));
  }
  if (const auto at = file.metadata.find("options"); at != file.metadata.end())
    print_options("model", at->second);
  if (checkpoint) {
    const RunRecord record = read_run_record(file, where);
    const auto note = record.notes.find("options");
    print_options("training", note != record.notes.end() ? note->second
                                                         : detail::checkpoint_text(file, "training", where));
  }
  print_format(file, where);
}

void print_run(const fs::path& folder) {
  const RunFiles files{folder};
  fmt::print("{}: a training run; its log is {}\n", folder.string(), files.log().string());
  print_tensors(files.checkpoint());
  if (!fs::exists(files.log())) return;
  const CsvTable log = read_csv_log(files.log());
  if (log.rows.empty()) return;
  std::vector<std::string> texts;
  for (std::size_t c = 0; c < log.columns.size(); ++c)
    texts.push_back(fmt::format("{} {}", log.columns[c], brief(log.rows.back()[c])));
  print_wrapped("last row", texts, ", ");
}

}  // namespace motiongan::command

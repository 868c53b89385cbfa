// motiongan pack: writes the model of a run as a small file to hand on.
#include <algorithm>

#include "generate/action_priors.hpp"
#include "motiongan/formats/tab_lines.hpp"
#include "motiongan/formats/text_file.hpp"
#include "motiongan/io/atomic_file.hpp"
#include "motiongan/models/action_gan.hpp"
#include "motiongan/models/dvgan.hpp"
#include "motiongan/models/shipped_models.hpp"
#include "motiongan/train/run_folder.hpp"
#include "shared/command.hpp"

namespace motiongan::command {
namespace {

struct PackArgs {
  std::string model, out, data;
  std::size_t starts = 4;
  bool whole = false;
};

/// `count` seconds of each class to start from, from the clips that the run held out for testing.
std::vector<ActionStart> starts_of(const PackArgs& args, const CLI::App& verb,
                                   const motion::PositionFormat& format) {
  std::vector<ActionStart> out;
  if (args.starts == 0) return out;
  const fs::path run = args.model;
  require(fs::exists(RunFiles{run}.split()), run.string(), " is not the folder of a run, from whose clips ",
          "starts could be drawn; give that, or --starts 0");
  ActionDataArgs data;
  take_data_of_run(data, verb, run, "give the clips to draw starts from with --data FOLDER, or --starts 0");
  if (!args.data.empty()) data.folder = args.data, data.procedural = 0;
  fill_in_choices(data);
  for (std::size_t label = 0; label < format.classes.size(); ++label)
    for (GivenPrior& drawn : draw_priors(run, format, data, label, 1, 0, args.starts))
      out.push_back({std::move(drawn.prior), label, std::move(drawn.reference)});
  return out;
}

/// Puts a file's SHA-256 into the list beside it, in place of its old line.
std::string list_in_folder(const fs::path& file) {
  std::string sum = io::sha256_of(file);
  const fs::path list = file.parent_path() / shipped_list;
  const std::string name = file.filename().string();
  std::vector<std::string> lines{sum + "  " + name};
  if (fs::exists(list)) {
    const std::string text = motion::read_text(list, "list of models", motion::largest_list_file);
    motion::for_each_line(text, list.string(), [&](const motion::TextLine& line) {
      if (!line.raw.ends_with("  " + name)) lines.emplace_back(line.raw);
    });
  }
  std::sort(lines.begin(), lines.end(),
            [](const std::string& a, const std::string& b) { return a.substr(64) < b.substr(64); });
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  motion::write_text_atomically(list, text);
  return sum;
}

int pack(const PackArgs& args, const CLI::App& verb) {
  const fs::path file = model_file(args.model), out = args.out;
  require(out.extension() == ".safetensors", "--out ", out.string(), ": the name must end in .safetensors");
  make_folder_of(out);
  const StoredWeights stored = args.whole ? StoredWeights::whole : StoredWeights::half;
  const io::SafeTensors contents = io::SafeTensors::read(file);
  const Context context;
  if (holds_model<ActionGan>(contents)) {
    ActionGan model = model_from<ActionGan>(context, contents, file.string());
    model.set_starts(starts_of(args, verb, model.format()));
    model.save(out, stored);
    if (!model.starts().empty())
      fmt::print("with {} of motion to continue\n", counted(model.starts().size(), "second"));
  } else {
    model_from<Dvgan>(context, contents, file.string()).save(out, stored);
  }
  const std::string sum = list_in_folder(fs::absolute(out));
  fmt::print("wrote {}: {:.2f} MB, of {:.2f} MB in {}\n", shown(out),
             1e-6 * static_cast<double>(fs::file_size(out)), 1e-6 * static_cast<double>(fs::file_size(file)),
             shown(file));
  fmt::print("SHA-256 {}, also in {}\n", sum, shown(fs::absolute(out).parent_path() / shipped_list));
  return 0;
}

const Verb pack_verb{
    "pack", [](CLI::App& app, Job& job) {
      CLI::App* verb = app.add_subcommand("pack",
                                          "Write the model of a training run as one small file: its weights "
                                          "in 16 bits, and all that generate\n"
                                          "needs. The file's SHA-256 goes into the list SHA256SUMS beside "
                                          "it, so that MOTIONGAN_MODELS can name\n"
                                          "the folder: the model is then found by its name, and checked.");
      const auto args = std::make_shared<PackArgs>();
      verb->add_option("MODEL", args->model, model_help)->required()->type_name("");
      verb->add_option("--out", args->out, "the file: FOLDER/NAME.safetensors")
          ->required()
          ->type_name("FILE");
      verb->add_flag("--whole", args->whole, "keep the weights in 32 bits [off]");
      verb->add_option(
              "--starts", args->starts,
              "seconds of motion of each class that the file of a class-conditioned model keeps, for "
              "generate to continue")
          ->capture_default_str()
          ->check(CLI::Range(0, 1000));
      verb->add_option("--data", args->data, "folder of the clips to draw them from [that of the run]")
          ->type_name("FOLDER");
      verb->callback([&job, args, verb] { job = [args, verb] { return pack(*args, *verb); }; });
    }};

}  // namespace
}  // namespace motiongan::command

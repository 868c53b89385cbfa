// motiongan generate: new motion for a text.
#include <fstream>
#include <set>

#include "motiongan/models/dvgan.hpp"
#include "motiongan/motion/bvh.hpp"
#include "motiongan/motion/motion.hpp"
#include "motiongan/train/train.hpp"
#include "show.hpp"

namespace motiongan::command {
namespace {

struct GenerateArgs {
  std::string model, prompts, out = ".", html, png;
  std::vector<std::string> texts;
  GenerateOptions options;
  double rate = 0;
};

/// The model file itself, or the one in the folder of a run.
fs::path model_file(const fs::path& given) {
  if (!fs::is_directory(given)) return given;
  const RunFiles files{given};
  require(fs::exists(files.generator()), given.string(), " holds no ", files.generator().filename().string(),
          "; give a model file, or the --save folder of a training");
  return files.generator();
}

/// The texts of the options, then those of the file, one a line.
std::vector<std::string> all_texts(const GenerateArgs& args) {
  std::vector<std::string> texts = args.texts;
  for (const std::string& text : texts)
    require(!motion::split_words(text).empty(), "--text \"", text, "\" has no words; describe a motion");
  if (!args.prompts.empty()) {
    const std::string all = motion::read_text(args.prompts, "file of prompts");
    std::size_t line = 1;
    for (std::size_t at = 0; at < all.size(); ++line) {
      std::string text = all.substr(at, all.find('\n', at) - at);
      at += text.size() + 1;
      text.erase(text.find_last_not_of(" \t\r") + 1);
      if (text.empty()) continue;
      require(!motion::split_words(text).empty(), args.prompts, ":", line, ": \"", text,
              "\" has no words; describe a motion");
      texts.push_back(text);
    }
    require(!texts.empty(), args.prompts, " has no prompt; write one a line");
  }
  require(!texts.empty(), "no text is given; use --text \"walk\" (as often as you like) or --prompts FILE");
  for (const std::string& text : texts)
    require(motion::is_utf8(text), "the text \"", text, "\" is not UTF-8");
  return texts;
}

/// A file name made of a text: its words joined by dashes, at most about 60 bytes.
std::string slug(const std::string& text) {
  std::string out;
  for (const std::string& word : motion::split_words(text)) {
    if (!out.empty() && out.size() + word.size() > 60) break;
    out += (out.empty() ? "" : "-") + word;
  }
  if (out.size() > 60) {  // one long word: cut it between two characters
    out.resize(60);
    while (!motion::is_utf8(out)) out.pop_back();
  }
  return out;
}

void warn_of_unknown_words(const motion::Vocabulary& vocabulary, const std::string& text) {
  const std::vector<std::string> words = vocabulary.unknown_words(text);
  if (words.empty()) return;
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "\"" : ", \"") + word + "\"";
  fmt::print(stderr, "motiongan: \"{}\": the model never saw {}{}\n", text, list,
             words.size() == motion::split_words(text).size() ? "; it knows none of these words"
                                                              : "; taken as unknown");
}

int generate(const GenerateArgs& args) {
  const std::vector<std::string> texts = all_texts(args);
  require(args.options.first_sample + args.options.count <= 0xFFFFFFFFu, "--first-sample ",
          args.options.first_sample, " and --count ", args.options.count, " go past sample 4294967295");
  const fs::path file = model_file(args.model);
  const Context context;
  const Dvgan model = Dvgan::load(context, file);
  const fs::path out = args.out;
  make_folder(out);

  std::vector<view::ViewedMotion> shown;
  std::set<std::string> names;
  std::size_t frames = 0;
  double rate = 0;
  for (const std::string& text : texts) {
    warn_of_unknown_words(model.format().vocabulary, text);
    std::string name = slug(text);
    for (std::size_t again = 2; !names.insert(name).second; ++again)
      name = fmt::format("{}-{}", slug(text), again);
    std::vector<motion::Motion> motions = model.generate(text, args.options);
    for (std::size_t i = 0; i < motions.size(); ++i) {
      if (args.rate > 0) motions[i] = motion::resample(motions[i], args.rate);
      frames = motions[i].frames;
      rate = motions[i].rate;
      const std::size_t sample = args.options.first_sample + i;
      motion::write_bvh(out / fmt::format("{}_{:03}.bvh", name, sample), motions[i]);
      if (!args.html.empty() || !args.png.empty())
        shown.push_back(
            {args.options.count > 1 ? fmt::format("{} ({})", text, sample) : text, std::move(motions[i])});
    }
    const std::size_t last = args.options.first_sample + args.options.count - 1;
    fmt::print(
        "\"{}\": {}\n", text,
        args.options.count == 1
            ? (out / fmt::format("{}_{:03}.bvh", name, last)).string()
            : fmt::format("{} to {}",
                          (out / fmt::format("{}_{:03}.bvh", name, args.options.first_sample)).string(),
                          fmt::format("{}_{:03}.bvh", name, last)));
  }
  fmt::print("wrote {} of {} at {} per second ({} each), seed {}\n",
             counted(texts.size() * args.options.count, "BVH file"), counted(frames, "frame"), brief(rate),
             duration(static_cast<double>(frames) / rate), args.options.seed);
  if (!args.html.empty()) show_page(args.html, shown, "generated by " + file.string());
  if (!args.png.empty()) show_strip(args.png, shown);
  return 0;
}

}  // namespace

void add_generate(CLI::App& app, Job& job) {
  CLI::App* verb = app.add_subcommand(
      "generate",
      "Make new motion for a text and write it as BVH.\n"
      "Files are called by the text and the number of the sample (walk-slowly_000.bvh); those that are there "
      "are\n"
      "replaced. The same model, text, seed and sample give the same motion, whatever --count is.");
  const auto args = std::make_shared<GenerateArgs>();
  verb->add_option("MODEL", args->model, "model file, or the --save folder of a training")
      ->required()
      ->type_name("");
  verb->add_option("--text", args->texts, "what to show; may be given several times")
      ->type_name("TEXT")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  verb->add_option("--prompts", args->prompts, "file with a text on each line")->type_name("FILE");
  verb->add_option("--count", args->options.count, "motions for each text")
      ->check(positive())
      ->capture_default_str();
  verb->add_option("--seed", args->options.seed, "another seed gives other motions")
      ->check(not_negative())
      ->capture_default_str();
  verb->add_option("--first-sample", args->options.first_sample, "number of the first motion of the seed")
      ->check(not_negative())
      ->capture_default_str();
  verb->add_option("--rate", args->rate, "frames per second of the files, by interpolation [the model's]")
      ->check(CLI::Range(1e-3, 1e4))
      ->type_name("HZ");
  verb->add_option("--out", args->out, "folder to write to; made if missing")
      ->capture_default_str()
      ->type_name("DIR");
  verb->add_option("--html", args->html, "also write a page that plays the motions")->type_name("FILE");
  verb->add_option("--png", args->png, "also write a picture of their poses")->type_name("FILE");
  verb->callback([&job, args] { job = [args] { return generate(*args); }; });
}

}  // namespace motiongan::command

// motiongan search: finds the clips of a collection whose motion matches a text.
#include <future>
#include <nlohmann/json.hpp>

#include "motiongan/data/captions.hpp"
#include "motiongan/formats/read_motion.hpp"
#include "motiongan/models/action_gan.hpp"
#include "motiongan/models/dvgan.hpp"
#include "motiongan/search/collection.hpp"
#include "motiongan/search/ranking.hpp"
#include "shared/caption_report.hpp"
#include "shared/clip_reading.hpp"
#include "shared/motion_files.hpp"
#include "shared/outputs.hpp"
#include "shared/prompt.hpp"
#include "shared/ranks.hpp"
#include "shared/retargeting.hpp"
#include "shared/show.hpp"

namespace motiongan::command {
namespace {

struct SearchArgs {
  std::string model, text, collection, index, captions, json, html, out;
  std::size_t hypotheses = 16, top = 10, hop = 0;
  std::uint64_t seed = 1;
  bool windows = false;
  std::string format = "bvh";
  Retargeting retargeting;
  motion::ClipOptions clips;
  bool strict = false;
};

/// A result, as it is printed.
struct Result {
  std::string clip, path;
  std::vector<std::string> captions;
  double begin = 0, end = 0;  // seconds from the start of the file
  SearchHit hit;
};

struct Found {
  std::vector<Result> results;
  std::vector<std::vector<float>> hypotheses;
  std::size_t clips = 0, windows = 0, left_out = 0, hop = 0;
  double median = 0;
};

/// A clip's name: its path below the collection, without extension.
std::string clip_name(const std::string& path) { return motion::without_extension(path).generic_string(); }

/// The folder that the index's paths are relative to.
fs::path home_of(const std::string& collection) {
  return fs::is_directory(collection) ? fs::path(collection) : fs::path(collection).parent_path();
}

/// The captions of all clips of the index, with a warning of those that fit no clip.
std::vector<std::vector<motion::Caption>> read_captions(const SearchIndex& index, const SearchArgs& args) {
  std::vector<fs::path> files;
  std::vector<motion::ClipName> names;
  for (const SearchClip& clip : index.clips()) {
    files.push_back(home_of(args.collection) / clip.path);
    names.push_back({clip_name(clip.path), clip_name(clip.path), motion::clip_stem(clip.path)});
  }
  motion::CaptionMatch match =
      motion::find_captions(captions_for(args.collection, args.captions), files, names);
  for (const std::string& remark : caption_remarks(match.report))
    fmt::print(stderr, "motiongan: {}: {}\n", match.report.source, remark);
  return std::move(match.of_clip);
}

/// The captions of a stretch of a clip (seconds): those of the whole clip and of parts that it overlaps.
std::vector<std::string> captions_of(const std::vector<motion::Caption>& captions, double begin, double end) {
  std::vector<std::string> out;
  for (const motion::Caption& caption : captions)
    if (!caption.part || (caption.part->begin < end && begin < caption.part->end))
      out.push_back(caption.text);
  return out;
}

Found found_in(const SearchIndex& index, const SearchRanking& ranking, const SearchOptions& options,
               const std::vector<std::vector<motion::Caption>>& captions,
               std::vector<std::vector<float>> hypotheses) {
  const motion::MotionFormat& format = index.format();
  Found found;
  found.hop = search_hop(format, options);
  found.hypotheses = std::move(hypotheses);
  for (const SearchClip& clip : index.clips()) clip.left_out.empty() ? ++found.clips : ++found.left_out;
  found.windows = ranking.windows;
  found.median = ranking.median;
  for (const SearchHit& hit : ranking.hits) {
    const SearchClip& clip = index.clips()[hit.window.clip];
    const double begin = clip.begin + static_cast<double>(hit.window.frame) / format.rate;
    const double end = begin + static_cast<double>(format.frames) / format.rate;
    found.results.push_back({clip_name(clip.path), clip.path,
                             captions_of(captions[hit.window.clip], begin, end), begin, end, hit});
  }
  return found;
}

std::string range_of(const Result& result) {
  return fmt::format("{:.2f}-{:.2f} s", result.begin, result.end);
}

std::string shift_text(int shift, double rate) { return fmt::format("{:+.2f} s", shift / rate); }

void print_results(const Found& found, const SearchArgs& args, const motion::MotionFormat& format) {
  fmt::print(
      "\"{}\": {} of {} (seed {}) against {} of {}; the median {} has distance {:.3f}\n\n", args.text,
      found.hypotheses.size() == 1 ? "1 hypothesis" : fmt::format("{} hypotheses", found.hypotheses.size()),
      args.model, args.seed, counted(found.windows, "window"), counted(found.clips, "clip"),
      args.windows ? "window" : "clip", found.median);
  const bool second = found.hypotheses.size() > 1;
  const bool captions = std::any_of(found.results.begin(), found.results.end(),
                                    [](const Result& result) { return !result.captions.empty(); });
  std::vector<std::string> head{"", "clip", "time", "distance", "nearest, shift"};
  if (second) head.emplace_back("second, distance, shift");
  if (captions) head.emplace_back("caption");
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < found.results.size(); ++i) {
    const Result& result = found.results[i];
    const SearchNeighbour& first = result.hit.nearest.front();
    rows.push_back({fmt::format("{}", i + 1), result.clip, range_of(result),
                    fmt::format("{:.3f}", first.distance),
                    fmt::format("#{} {}", first.hypothesis, shift_text(first.shift, format.rate))});
    if (second) {
      const SearchNeighbour& next = result.hit.nearest[1];
      rows.back().push_back(
          fmt::format("#{} {:.3f} {}", next.hypothesis, next.distance, shift_text(next.shift, format.rate)));
    }
    if (captions) rows.back().push_back(result.captions.empty() ? std::string() : result.captions.front());
  }
  print_table(head, rows, "rllrll" + std::string(captions ? "l" : ""));
}

nlohmann::ordered_json to_json(const Found& found, const SearchArgs& args,
                               const motion::MotionFormat& format) {
  nlohmann::ordered_json json{{"text", args.text},
                              {"model", args.model},
                              {"collection", args.collection},
                              {"hypotheses", found.hypotheses.size()},
                              {"seed", args.seed},
                              {"frames", format.frames},
                              {"rate", format.rate},
                              {"hop", found.hop},
                              {"clips", found.clips},
                              {"left_out", found.left_out},
                              {"windows", found.windows},
                              {"ranked", args.windows ? "windows" : "clips"},
                              {"median_distance", found.median},
                              {"results", nlohmann::ordered_json::array()}};
  for (const Result& result : found.results) {
    nlohmann::ordered_json nearest = nlohmann::ordered_json::array();
    for (const SearchNeighbour& near : result.hit.nearest)
      nearest.push_back({{"hypothesis", near.hypothesis},
                         {"distance", near.distance},
                         {"shift_frames", near.shift},
                         {"shift_seconds", near.shift / format.rate}});
    json["results"].push_back({{"clip", result.clip},
                               {"file", result.path},
                               {"captions", result.captions},
                               {"begin_seconds", result.begin},
                               {"end_seconds", result.end},
                               {"distance", result.hit.distance()},
                               {"nearest", nearest}});
  }
  return json;
}

/// The hypothesis moved by its shift, frame by frame on a window; outside its range it holds its first or
/// last frame.
motion::Motion aligned(const motion::Motion& hypothesis, int shift) {
  const int last = static_cast<int>(hypothesis.frames) - 1;
  const auto frame = [&](int t) {
    return motion::slice(hypothesis, static_cast<std::size_t>(std::clamp(t - shift, 0, last)), 1);
  };
  motion::Motion out = frame(0);
  for (int t = 1; t <= last; ++t) out = motion::join(std::move(out), frame(t));
  return out;
}

/// Shows each result's window next to its nearest hypotheses, frame by frame as they were compared.
void show_results(const Found& found, const SearchArgs& args, const motion::MotionFormat& format) {
  constexpr std::size_t most = 12;
  constexpr double rate = 30;  // of the page; motion at a lower rate is interpolated
  const fs::path folder = home_of(args.collection);
  std::vector<view::ViewedMotion> shown;
  for (std::size_t i = 0; i < std::min(most, found.results.size()); ++i) {
    const Result& result = found.results[i];
    motion::ClipOptions whole = args.clips;
    whole.first_frame = motion::FirstFrame::keep;  // times count from the start of the file
    motion::Motion clip = motion::read_motion(folder / result.path, whole).motion;
    clip = motion::resample(motion::scaled(clip, motion::scale_to(format.skeleton(), clip.skeleton)), rate);
    const std::size_t count = motion::resampled_frames(format.frames, format.rate, rate);
    const std::size_t first =
        std::min(static_cast<std::size_t>(std::lround(result.begin * rate)), clip.frames - 1);
    const std::string caption = result.captions.empty() ? "" : ": " + result.captions.front();
    shown.push_back({fmt::format("{}. {}, {}{}", i + 1, result.clip, range_of(result), caption),
                     motion::slice(clip, first, std::min(count, clip.frames - first))});
    for (const SearchNeighbour& near : result.hit.nearest)
      shown.push_back(
          {fmt::format("{}. hypothesis #{}, distance {:.3f}, shift {}", i + 1, near.hypothesis, near.distance,
                       shift_text(near.shift, format.rate)),
           motion::resample(aligned(format.to_motion(found.hypotheses[near.hypothesis]), near.shift), rate)});
  }
  if (found.results.size() > most) fmt::print("only the first {} results are shown\n", most);
  show_page(args.html, shown, "\"" + args.text + "\" in " + args.collection,
            1 + found.results.front().hit.nearest.size());
}

void check_search_outputs(const SearchArgs& args, const fs::path& model) {
  const std::vector<fs::path> inputs{model,
                                     args.collection,
                                     args.captions,
                                     args.clips.bones,
                                     args.retargeting.skeleton,
                                     args.retargeting.map};
  check_output("--html", args.html, page_output, inputs);
  check_output("--save-map", args.retargeting.save_map, table_output, inputs);
  if (args.json != "-") check_output("--json", args.json, json_output, inputs);
  if (!args.out.empty())
    check_outputs("--out", sample_files(args.out, slug(args.text), 0, args.hypotheses, args.format), inputs);
}

void report_index(const SearchCollection& collection) {
  for (const std::string& warning : collection.warnings) fmt::print(stderr, "motiongan: {}\n", warning);
  if (collection.written)
    fmt::print(stderr, "index {}: {} read, {} kept, {} removed\n", collection.file.string(),
               counted(collection.read, "file"), collection.kept, collection.removed);
}

int search(const SearchArgs& args) {
  check_text(args.text);
  check_samples(0, args.hypotheses);
  const fs::path file = model_file(args.model);
  const std::shared_ptr<Communicator> ranks = join_ranks();
  const bool first = ranks == nullptr || ranks->rank() == 0;
  check_search_outputs(args, file);
  require(!holds_model<ActionGan>(io::SafeTensors::read(file)), file.string(),
          " generates motion for classes; a search needs a text-conditioned model (motiongan train dvgan)");
  std::FILE* const report = args.json == "-" ? stderr : stdout;
  require(!args.retargeting.on() || !args.out.empty(),
          "--skeleton puts the hypotheses that --out writes on another skeleton; give --out DIR");
  TargetBody body(args.retargeting, report);
  const Context context;
  const Dvgan model = Dvgan::load(context, file);
  const motion::MotionFormat& format = model.format();
  check_words(format, args.text, args.strict);
  // The index is read while the device generates the hypotheses. The first rank brings it up to date for all.
  if (!first) ranks->wait_for_all();
  auto opened = std::async(std::launch::async, [&] {
    return open_search_collection(args.collection, format, args.index, args.clips);
  });
  GenerateOptions options;
  options.count = args.hypotheses;
  options.seed = args.seed;
  std::vector<std::vector<float>> hypotheses = model.generate_poses(args.text, options);
  const SearchCollection collection = opened.get();
  if (first) report_index(collection);
  if (first && ranks != nullptr) ranks->wait_for_all();
  const SearchOptions compared{args.top, args.hop, args.windows};
  const SearchRanking ranking = rank_clips(context, collection.index, hypotheses, compared, ranks.get());
  if (!first) return 0;
  const auto captions = read_captions(collection.index, args);
  const Found found = found_in(collection.index, ranking, compared, captions, std::move(hypotheses));
  if (args.json != "-") print_results(found, args, format);
  if (!args.json.empty()) {
    // Replaces what is not UTF-8 in a path, so that the rest can still be written.
    const std::string text =
        to_json(found, args, format).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
    if (args.json == "-") {
      fmt::print("{}", text);
    } else {
      make_folder_of(args.json);
      motion::write_text_atomically(args.json, text);
      fmt::print("wrote {}\n", args.json);
    }
  }
  if (!args.out.empty()) {
    make_folder(args.out);
    const std::vector<fs::path> files =
        sample_files(args.out, slug(args.text), 0, found.hypotheses.size(), args.format);
    for (std::size_t h = 0; h < files.size(); ++h)
      write_motion(files[h], body.put(format.to_motion(found.hypotheses[h])), 0,
                   body.unit_metres(format.space.unit_metres), body.character());
    fmt::print(report, "wrote the hypotheses ({}): {}\n", describe(format.space), named(files));
  }
  if (!args.html.empty()) show_results(found, args, format);
  return 0;
}

const Verb search_verb{
    "search",
    [](CLI::App& app, Job& job) {
      CLI::App* verb = app.add_subcommand(
          "search",
          "Find the clips of a collection whose motion matches a text.\n"
          "The model generates hypotheses for the text; every window of every clip is compared with all of\n"
          "them, at shifts of up to half a window, and clips are listed by the distance of their nearest\n"
          "window. The collection's index is kept in COLLECTION/.motiongan-search, or in the file of "
          "--index.");
      const auto args = std::make_shared<SearchArgs>();
      const auto option = [&](const char* name, auto& member, const char* text) {
        return verb->add_option(name, member, text);
      };
      option("--model", args->model, model_help)->required()->type_name("MODEL");
      option("--text", args->text, "description of the motion to find")->required()->type_name("TEXT");
      add_strict_option(*verb, args->strict);
      option("--collection", args->collection, "folder of clips of the model's skeleton, or one file")
          ->required()
          ->type_name("DIR");
      option("--hypotheses", args->hypotheses, "motions to generate for the text")
          ->check(positive())
          ->capture_default_str();
      option("--seed", args->seed, "random seed; another one gives other hypotheses")
          ->check(not_negative())
          ->capture_default_str();
      option("--top", args->top, "number of results")->check(positive())->capture_default_str();
      verb->add_flag("--windows", args->windows,
                     "list windows instead of clips; a clip may then appear more than once");
      option("--hop", args->hop, "frames between two windows of a clip, at the model's rate [half a window]")
          ->check(positive());
      option("--captions", args->captions,
             "captions to show with the clips [captions.tsv, .csv or .json in the folder, else .txt files]")
          ->check(CLI::ExistingPath)
          ->type_name("FILE");
      add_reading_options(*verb, args->clips, false);
      option("--index", args->index, "where the collection's index is kept")->type_name("FILE");
      option("--json", args->json, "also write the results as JSON; -: to the terminal instead of the table")
          ->type_name("FILE");
      option("--html", args->html, "also write an HTML page: each clip next to its nearest hypotheses")
          ->type_name("FILE");
      option("--out", args->out, "also write the hypotheses here, as motion files")->type_name("DIR");
      add_format_option(*verb, args->format);
      add_skeleton_options(*verb, args->retargeting);
      verb->callback([&job, args] { job = [args] { return search(*args); }; });
    },
    Verb::Runs::on_ranks};

}  // namespace

}  // namespace motiongan::command

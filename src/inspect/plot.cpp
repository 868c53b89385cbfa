// motiongan plot: draws the logs of training runs, and describes the clips that they were trained on.
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "inspect/plot_log.hpp"
#include "motiongan/io/fields_json.hpp"
#include "motiongan/train/run.hpp"
#include "motiongan/view/player.hpp"
#include "shared/captioned_data.hpp"
#include "shared/outputs.hpp"
#include "shared/quality.hpp"
#include "shared/show.hpp"

namespace motiongan::command {
namespace {

struct PlotArgs {
  std::vector<std::string> runs, curves;
  std::string png, html;
  bool data = true;
};

struct Run {
  std::string name;
  fs::path folder;  // empty for a log alone
  CsvTable log;
};

Run read_run(const fs::path& given) {
  const bool folder = fs::is_directory(given);
  Run run{given.lexically_normal().string(), folder ? given : fs::path(),
          read_csv_log(folder ? RunFiles{given}.log() : given)};
  require(!run.log.rows.empty(), given.string(), " has no rows yet: the run has logged no iteration");
  return run;
}

/// One plot for every loss, or for each of those that were `asked` for, of all runs that have it.
std::vector<view::Image> plots(const std::vector<Run>& runs, const std::vector<std::string>& asked) {
  const std::set<std::string> not_drawn{"iteration", "seconds", "iterations_per_second"};
  std::vector<std::string> columns;
  for (const Run& run : runs)
    for (const std::string& name : run.log.columns)
      if (!not_drawn.contains(name) && std::find(columns.begin(), columns.end(), name) == columns.end())
        columns.push_back(name);
  for (const std::string& name : asked)
    require(std::find(columns.begin(), columns.end(), name) != columns.end(),
            "--curves: no run has logged \"", name, "\"; the curves are ",
            fmt::format("{}", fmt::join(columns, ", ")));
  if (!asked.empty()) columns = asked;
  std::vector<view::Image> out;
  for (const std::string& name : columns) {
    std::vector<view::Series> series;
    for (const Run& run : runs) {
      const auto& has = run.log.columns;
      if (std::find(has.begin(), has.end(), name) == has.end()) continue;
      const std::vector<double> values = run.log.column(name);
      series.push_back({run.name, run.log.column("iteration"), smoothed(values, values.size() / 200)});
    }
    out.push_back(
        view::line_plot(series, {.title = name, .x_label = "iteration", .width = 960, .height = 320}));
  }
  return out;
}

/// The images below one another; all have one width.
view::Image stacked(const std::vector<view::Image>& images) {
  view::Image out(images.front().width, images.front().height * images.size());
  std::size_t at = 0;
  for (const view::Image& image : images) {
    std::copy(image.rgb.begin(), image.rgb.end(), out.rgb.begin() + static_cast<std::ptrdiff_t>(at));
    at += image.rgb.size();
  }
  return out;
}

/// Facts of a page or a terminal: a name and a text each.
using Facts = std::vector<std::pair<std::string, std::string>>;

Facts facts_of(const Run& run) {
  Facts out;
  const std::vector<double>& last = run.log.rows.back();
  for (std::size_t c = 0; c < run.log.columns.size(); ++c)
    out.emplace_back(c == 0 ? "last iteration" : run.log.columns[c], brief(last[c], c == 0 ? 8 : 4));
  const auto& has = run.log.columns;
  if (std::find(has.begin(), has.end(), "wasserstein") != has.end()) {
    const CurveSummary w = summarise(run.log.column("wasserstein"));
    out.emplace_back("Wasserstein estimate",
                     fmt::format("peak {} at iteration {:.0f}, {} at the end (running means)", brief(w.peak),
                                 run.log.column("iteration")[w.peak_at], brief(w.last)));
  }
  return out;
}

/// The clips of a text-conditioned run: how many, what they say, how they move.
Facts data_facts(const motion::Dataset& data) {
  Facts out;
  std::map<std::string, double> seconds;  // by description
  std::vector<motion::Motion> windows;
  double all = 0;
  std::vector<float> window(data.format.frames * data.format.dof());
  for (const motion::DatasetClip& clip : data.train) {
    if (clip.derived) continue;
    const double length =
        static_cast<double>(clip.frames) / (data.format.rate * static_cast<double>(data.stride));
    all += length;
    for (const std::string& caption : clip.captions) seconds[caption] += length;
    const std::size_t leap = data.format.frames * data.stride;
    for (std::size_t start = 0; start < data.starts(clip); start += leap) {
      data.window(clip, start, window);
      windows.push_back(data.to_motion(window));
    }
  }
  out.emplace_back("training clips", fmt::format("{}, {} in all; {} held out", data.recorded(), duration(all),
                                                 data.test.size()));
  out.emplace_back("windows", fmt::format("{} frames at {} per second; {} values per pose",
                                          data.format.frames, brief(data.format.rate), data.format.dof()));
  std::vector<std::pair<double, std::string>> order;
  for (const auto& [text, length] : seconds) order.emplace_back(-length, text);
  std::sort(order.begin(), order.end());
  std::string most;
  for (std::size_t i = 0; i < std::min<std::size_t>(order.size(), 8); ++i)
    most += fmt::format("{}{} ({})", i == 0 ? "" : ", ", order[i].second, duration(-order[i].first));
  out.emplace_back("descriptions", fmt::format("{}; most of: {}", order.size(), most));
  const MotionQuality q = measure_quality(windows);
  out.emplace_back("jerk", fmt::format("{} {}/s^3", cell(q.jerk, 1), q.length_unit));
  if (q.feet) {
    out.emplace_back("foot skating", cell(100 * q.feet->ratio(), 1) + " % of steps");
    out.emplace_back("a foot near the floor", cell(100 * q.feet->contact_share(), 1) + " % of frames");
  }
  return out;
}

/// The same for a run whose clips can be read; a note otherwise.
Facts data_facts(const Run& run, const CLI::App& verb) {
  const fs::path checkpoint = RunFiles{run.folder}.checkpoint();
  if (run.folder.empty() || !fs::exists(checkpoint)) return {};
  const std::string note = read_run_record(checkpoint).notes["options"];
  if (note.empty() || io::parse_object(note, checkpoint.string()).contains("--model")) return {};
  try {
    CaptionedDataArgs args;
    take_captioned_data(args, verb, checkpoint, checkpoint);
    return data_facts(load_data(args));
  } catch (const Error& error) {
    return {{"training clips", fmt::format("cannot be read: {}", error.what())}};
  }
}

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) out += c == '<' ? "&lt;" : c == '&' ? "&amp;" : std::string(1, c);
  return out;
}

std::string page(const std::vector<view::Image>& images,
                 const std::vector<std::pair<std::string, Facts>>& tables) {
  std::string out =
      "<!DOCTYPE html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>motiongan plot</title>\n"
      "<style>body{font:15px sans-serif;max-width:980px;margin:2em auto;padding:0 1em}img{width:100%}"
      "table{border-collapse:collapse;margin:1em 0 2em}td{padding:.2em 1.5em .2em "
      "0;vertical-align:top}td:first-child{color:#666;white-space:nowrap}</style>\n";
  for (const auto& [title, facts] : tables) {
    out += fmt::format("<h2>{}</h2>\n<table>\n", escaped(title));
    for (const auto& [name, text] : facts)
      out += fmt::format("<tr><td>{}</td><td>{}</td></tr>\n", escaped(name), escaped(text));
    out += "</table>\n";
  }
  for (const view::Image& image : images) {
    const std::string png = png_bytes("the plot", image);
    const std::span<const std::uint8_t> bytes{reinterpret_cast<const std::uint8_t*>(png.data()), png.size()};
    out += fmt::format("<img alt=\"\" src=\"data:image/png;base64,{}\">\n", view::detail::base64(bytes));
  }
  return out + "</html>\n";
}

int plot(PlotArgs args, const CLI::App& verb) {
  std::vector<Run> runs;
  for (const std::string& given : args.runs) runs.push_back(read_run(given));
  const fs::path beside = runs.size() == 1 ? runs.front().folder : fs::path();
  if (args.png.empty()) args.png = (beside / "plot.png").string();
  if (args.html.empty()) args.html = (beside / "plot.html").string();
  check_output("--png", args.png, picture_output, {});
  check_output("--html", args.html, page_output, {});
  std::vector<std::pair<std::string, Facts>> tables;
  for (const Run& run : runs) {
    tables.emplace_back(run.name, facts_of(run));
    if (args.data)
      if (Facts facts = data_facts(run, verb); !facts.empty())
        tables.emplace_back("clips of " + run.name, std::move(facts));
  }
  for (const auto& [title, facts] : tables) {
    fmt::print("{}\n", title);
    for (const auto& [name, text] : facts) fmt::print("  {:<22} {}\n", name, text);
  }
  const std::vector<view::Image> images = plots(runs, args.curves);
  make_folder_of(args.png);
  write_png(args.png, stacked(images));
  make_folder_of(args.html);
  motion::write_text_atomically(args.html, page(images, tables));
  fmt::print("wrote {} and {}: the curves (running means over a hundredth)\n", args.png, args.html);
  return 0;
}

const Verb plot_verb{
    "plot", [](CLI::App& app, Job& job) {
      CLI::App* verb = app.add_subcommand(
          "plot",
          "Draw the log of a training run, or of several over one another, as a picture and on a page with\n"
          "the last losses and, for text-conditioned runs, what the training clips are like.");
      const auto args = std::make_shared<PlotArgs>();
      verb->add_option("RUNS", args->runs, "folders of runs, or log.csv files")->required()->type_name("");
      verb->add_option("--png", args->png, "picture to write [plot.png in the folder of a single run]")
          ->type_name("FILE");
      verb->add_option("--html", args->html, "page to write [plot.html in the folder of a single run]")
          ->type_name("FILE");
      verb->add_option("--curves", args->curves,
                       "columns of log.csv to draw, such as wasserstein,penalty [all]")
          ->delimiter(',')
          ->type_name("A,B");
      verb->add_flag("--data,!--no-data", args->data, "read the run's clips and describe them [on]");
      verb->callback([&job, args, verb] { job = [args, verb] { return plot(*args, *verb); }; });
    }};

}  // namespace
}  // namespace motiongan::command

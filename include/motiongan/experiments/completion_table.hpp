// The table of completion errors (Lin & Amer, Table 3) with the published rows, as CSV, Markdown and JSON.
#pragma once
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "motiongan/experiments/completion_protocol.hpp"

namespace motiongan {

/// The errors of one model.
struct CompletionRow {
  std::string name;
  std::vector<CompletionErrors> by_action;  ///< [actions]; NaN where not available
  bool published = false;                   ///< from the paper's Table 3
  std::size_t iterations = 0;               ///< of its training; 0: not trained, or not known

  /// Whether there is an error for this action at any time.
  bool has(std::size_t action) const {
    for (const double error : by_action.at(action))
      if (!std::isnan(error)) return true;
    return false;
  }
};

/// The mean over all actions; NaN where any action is NaN.
inline CompletionErrors mean_over_actions(const CompletionRow& row) {
  CompletionErrors out{};
  for (const CompletionErrors& errors : row.by_action)
    for (std::size_t m = 0; m < out.size(); ++m)
      out[m] += errors[m] / static_cast<double>(row.by_action.size());
  return out;
}

/// The rows of Table 3 (Lin & Amer): Human3.6M at 80, 160, 320 and 400 ms; NaN at other times and for actions
/// that the paper does not list. Empty if it lists none of the actions.
inline std::vector<CompletionRow> published_completion_rows(const std::vector<std::string>& actions) {
  struct Published {
    const char* name;
    double errors[4][4];  // walking, eating, smoking, discussion
  };
  static constexpr const char* known[] = {"walking", "eating", "smoking", "discussion"};
  static constexpr Published all[] = {
      {"zero velocity",
       {{.39, .68, .99, 1.15}, {.27, .48, .73, .86}, {.26, .48, .97, .95}, {.31, .67, .94, 1.04}}},
      {"ERD",
       {{.93, 1.18, 1.59, 1.78},
        {1.27, 1.45, 1.66, 1.80},
        {1.66, 1.95, 2.35, 2.42},
        {2.27, 2.47, 2.68, 2.76}}},
      {"LSTM-3LR",
       {{.77, 1.00, 1.29, 1.47},
        {.89, 1.09, 1.35, 1.46},
        {1.34, 1.65, 2.04, 2.16},
        {1.88, 2.12, 2.25, 2.23}}},
      {"SRNN",
       {{.81, .94, 1.16, 1.30}, {.97, 1.14, 1.35, 1.46}, {1.45, 1.68, 1.94, 2.08}, {1.22, 1.49, 1.83, 1.93}}},
      {"seq2seq",
       {{.28, .49, .72, .81}, {.23, .39, .62, .76}, {.33, .61, 1.05, 1.15}, {.31, .68, 1.01, 1.09}}},
      {"DVGAN",
       {{.36, .59, .89, 1.00}, {.39, .61, 1.01, 1.20}, {.28, .49, .85, .97}, {.50, .86, 1.31, 1.53}}}};
  std::vector<CompletionRow> out;
  for (const Published& published : all) {
    CompletionRow row{published.name, {}, true, 0};
    bool any = false;
    for (const std::string& action : actions) {
      CompletionErrors errors;
      errors.fill(std::numeric_limits<double>::quiet_NaN());
      for (std::size_t k = 0; k < 4; ++k)
        if (action == known[k]) {
          any = true;
          for (std::size_t m = 0; m < 4; ++m) errors[m] = published.errors[k][m];
        }
      row.by_action.push_back(errors);
    }
    if (any) out.push_back(std::move(row));
  }
  return out;
}

/// A table of completion errors.
struct CompletionTable {
  motion::ExpmapLayout layout = motion::ExpmapLayout::h36m;
  std::vector<std::string> actions;
  CompletionErrors true_milliseconds{};  ///< true times of CompletionProtocol::milliseconds
  std::vector<CompletionRow> rows;

  /// A table without rows. The published rows are for Human3.6M only.
  explicit CompletionTable(const CompletionData& data) : layout(data.layout()), actions(data.actions()) {
    for (std::size_t m = 0; m < true_milliseconds.size(); ++m)
      true_milliseconds[m] = data.true_milliseconds(m);
  }

  /// Whether the times in the literature differ from the true times.
  bool times_differ() const {
    return std::abs(true_milliseconds[0] - CompletionProtocol::milliseconds[0]) > 1;
  }
};

/// "0.39", or "-" for NaN.
inline std::string error_text(double error, int decimals = 2) {
  if (std::isnan(error)) return "-";
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, error);
  return text;
}

/// CSV with a line for each error: action ("mean" for the mean over actions), model, source ("measured" or
/// "published"), iterations, milliseconds (as in the literature), true_milliseconds, error.
inline std::string completion_csv(const CompletionTable& table) {
  std::string out = "action,model,source,iterations,milliseconds,true_milliseconds,error\n";
  const auto lines = [&](const std::string& action, const CompletionRow& row,
                         const CompletionErrors& errors) {
    for (std::size_t m = 0; m < errors.size(); ++m)
      if (!std::isnan(errors[m]))
        out += concat(action, ",", row.name, ",", row.published ? "published" : "measured", ",",
                      row.iterations > 0 ? concat(row.iterations) : std::string(), ",",
                      CompletionProtocol::milliseconds[m], ",", error_text(table.true_milliseconds[m], 1),
                      ",", error_text(errors[m], 6), "\n");
  };
  for (std::size_t a = 0; a < table.actions.size(); ++a)
    for (const CompletionRow& row : table.rows) lines(table.actions[a], row, row.by_action[a]);
  for (const CompletionRow& row : table.rows) lines("mean", row, mean_over_actions(row));
  return out;
}

/// Markdown: `notes`, a paragraph each, then a table for each action and one for their mean.
inline std::string completion_markdown(const CompletionTable& table, const std::vector<std::string>& notes) {
  std::string out = concat("# Completion error, ", name_of(table.layout), "\n");
  for (const std::string& note : notes) out += "\n" + note + "\n";
  const auto section = [&](const std::string& title, const auto& errors_of) {
    out += "\n## " + title + "\n\n| ms |";
    for (const int ms : CompletionProtocol::milliseconds) out += concat(" ", ms, " |");
    out += "\n|---|";
    for (std::size_t m = 0; m < CompletionProtocol::measured.size(); ++m) out += "---:|";
    out += "\n";
    if (table.times_differ()) {
      out += "| true ms |";
      for (const double ms : table.true_milliseconds) out += " " + error_text(ms, 0) + " |";
      out += "\n";
    }
    for (const CompletionRow& row : table.rows) {
      const CompletionErrors errors = errors_of(row);
      std::string line;
      bool any = false;
      for (const double error : errors)
        line += " " + error_text(error) + " |", any = any || !std::isnan(error);
      if (any) out += "| " + row.name + (row.published ? " (published)" : "") + " |" + line + "\n";
    }
  };
  for (std::size_t a = 0; a < table.actions.size(); ++a)
    section(table.actions[a], [&](const CompletionRow& row) { return row.by_action[a]; });
  if (table.actions.size() > 1)
    section(concat("mean of ", table.actions.size(), " actions"), mean_over_actions);
  return out;
}

/// JSON: {"layout", "milliseconds", "true_milliseconds", "actions", "rows": [{"model", "source",
/// "iterations", "errors": {action: [6]}, "mean": [6]}]}; NaN is written as null.
inline nlohmann::json completion_json(const CompletionTable& table) {
  const auto list = [](std::span<const double> values) {
    nlohmann::json out = nlohmann::json::array();
    for (const double value : values)
      out.push_back(std::isnan(value) ? nlohmann::json() : nlohmann::json(value));
    return out;
  };
  nlohmann::json out, rows = nlohmann::json::array();
  for (const CompletionRow& row : table.rows) {
    nlohmann::json one, errors = nlohmann::json::object();
    for (std::size_t a = 0; a < table.actions.size(); ++a)
      if (row.has(a)) errors[table.actions[a]] = list(row.by_action[a]);
    one["model"] = row.name;
    one["source"] = std::string(row.published ? "published" : "measured");
    one["iterations"] = row.iterations;
    one["errors"] = std::move(errors);
    one["mean"] = list(mean_over_actions(row));
    rows.push_back(std::move(one));
  }
  out["layout"] = std::string(name_of(table.layout));
  for (const int ms : CompletionProtocol::milliseconds) out["milliseconds"].push_back(ms);
  out["true_milliseconds"] = list(table.true_milliseconds);
  out["actions"] = table.actions;
  out["rows"] = std::move(rows);
  return out;
}

}  // namespace motiongan

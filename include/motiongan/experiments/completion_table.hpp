// Table 3: rows of completion errors, the published ones beside them, as text files.
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

/// A line of every action's table.
struct CompletionRow {
  std::string name;
  std::vector<CompletionErrors> by_action;  ///< [actions]; NaN where there is none
  bool published = false;                   ///< from the paper's Table 3
  std::size_t iterations = 0;               ///< of its training; 0: none, or not known

  bool has(std::size_t action) const {
    for (const double error : by_action.at(action))
      if (!std::isnan(error)) return true;
    return false;
  }
};

/// Means over all actions; NaN where one of them has none.
inline CompletionErrors mean_over_actions(const CompletionRow& row) {
  CompletionErrors out{};
  for (const CompletionErrors& errors : row.by_action)
    for (std::size_t m = 0; m < out.size(); ++m)
      out[m] += errors[m] / static_cast<double>(row.by_action.size());
  return out;
}

/// The rows of the paper's Table 3 (SPEC section 8): Human3.6M at 80, 160, 320 and 400 ms, NaN for other
/// times and for actions that are not in it. Rows without any of the actions are left out.
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

/// All rows, and what they are rows of.
struct CompletionTable {
  motion::ExpmapLayout layout = motion::ExpmapLayout::h36m;
  std::vector<std::string> actions;
  CompletionErrors true_milliseconds{};  ///< of CompletionProtocol::milliseconds
  std::vector<CompletionRow> rows;

  /// Without rows yet; the published ones are of Human3.6M and stand in its table only.
  explicit CompletionTable(const CompletionData& data) : layout(data.layout()), actions(data.actions()) {
    for (std::size_t m = 0; m < true_milliseconds.size(); ++m)
      true_milliseconds[m] = data.true_milliseconds(m);
  }

  /// Whether the literature's names of the times are not the true ones.
  bool times_differ() const {
    return std::abs(true_milliseconds[0] - CompletionProtocol::milliseconds[0]) > 1;
  }
};

/// "0.39", or a dash where there is none.
inline std::string error_text(double error, int decimals = 2) {
  if (std::isnan(error)) return "-";
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, error);
  return text;
}

/// A line for each number: action ("mean" for the mean over actions), model, source ("measured" or
/// "published"), iterations, milliseconds (the literature's name), true_milliseconds, error.
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

/// A Markdown table for each action and one for their mean. `notes` stand in front, a paragraph each.
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

/// {"layout", "milliseconds", "true_milliseconds", "actions", "rows": [{"model", "source", "iterations",
/// "errors": {action: [6]}, "mean": [6]}]}; null where there is no error.
inline nlohmann::json completion_json(const CompletionTable& table) {
  const auto list = [](const CompletionErrors& errors) {
    nlohmann::json out = nlohmann::json::array();
    for (const double error : errors)
      out.push_back(std::isnan(error) ? nlohmann::json() : nlohmann::json(error));
    return out;
  };
  nlohmann::json rows = nlohmann::json::array();
  for (const CompletionRow& row : table.rows) {
    nlohmann::json errors = nlohmann::json::object();
    for (std::size_t a = 0; a < table.actions.size(); ++a)
      if (row.has(a)) errors[table.actions[a]] = list(row.by_action[a]);
    rows.push_back({{"model", row.name},
                    {"source", row.published ? "published" : "measured"},
                    {"iterations", row.iterations},
                    {"errors", errors},
                    {"mean", list(mean_over_actions(row))}});
  }
  return {{"layout", name_of(table.layout)},
          {"milliseconds", CompletionProtocol::milliseconds},
          {"true_milliseconds", table.true_milliseconds},
          {"actions", table.actions},
          {"rows", rows}};
}

}  // namespace motiongan

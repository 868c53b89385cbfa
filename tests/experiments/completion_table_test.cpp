// The table of completion errors as CSV, Markdown and JSON, with missing values.
#include <doctest/doctest.h>

#include <limits>
#include <motiongan/experiments/completion_table.hpp>

#include "../support/expmap_files.hpp"

namespace completion_table_test {

using namespace motiongan;
using testing::ExpmapFolder;

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

CompletionTable small_table(bool cmu) {
  const ExpmapFolder folder;
  (cmu ? testing::write_small_cmu : testing::write_small_h36m)(folder.path());
  CompletionTable table{CompletionData(motion::read_expmap_collection(folder.path()))};
  table.rows.push_back({"one", {{.1, .2, .3, .4, .5, .6}, {.3, .4, .5, .6, .7, .8}}, false, 70});
  table.rows.push_back({"two", {{1, 2, 3, 4, 5, none}, {none, none, none, none, none, none}}, false, 0});
  return table;
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("the mean over actions requires all actions") {
  const CompletionTable table = small_table(false);
  const CompletionErrors mean = mean_over_actions(table.rows[0]);
  CHECK(mean[0] == doctest::Approx(.2));
  CHECK(mean[5] == doctest::Approx(.7));
  CHECK(std::isnan(mean_over_actions(table.rows[1])[0]));
  CHECK(table.rows[1].has(0));
  CHECK_FALSE(table.rows[1].has(1));
}

TEST_CASE("published rows exist for the paper's actions only") {
  const auto rows = published_completion_rows({"posing", "eating"});
  REQUIRE(rows.size() == 6);
  CHECK(rows[0].published);
  CHECK_FALSE(rows[5].has(0));
  CHECK(rows[5].name == "DVGAN");
  CHECK(rows[5].by_action[1][0] == .39);
  CHECK(rows[5].by_action[1][3] == 1.20);
  CHECK(std::isnan(rows[5].by_action[1][4]));
  CHECK(rows[1].by_action[1][2] == 1.66);
  CHECK(published_completion_rows({"posing"}).empty());
}

TEST_CASE("CSV: a line for each error") {
  const std::string csv = completion_csv(small_table(true));
  CHECK(csv.starts_with("action,model,source,iterations,milliseconds,true_milliseconds,error\n"));
  CHECK(has(csv, "\nwalking,one,measured,70,80,33.3,0.100000\n"));
  CHECK(has(csv, "\nwashwindow,one,measured,70,1000,416.7,0.800000\n"));
  CHECK(has(csv, "\nwalking,two,measured,,560,233.3,5.000000\n"));
  CHECK(has(csv, "\nmean,one,measured,70,80,33.3,0.200000\n"));
  CHECK_FALSE(has(csv, "nan"));
  CHECK_FALSE(has(csv, "mean,two"));
}

TEST_CASE("Markdown: a table for each action, with the true times if they differ") {
  const std::string cmu = completion_markdown(small_table(true), {"Mind the times."});
  CHECK(
      cmu.starts_with("# Completion error, cmu\n\nMind the times.\n\n## walking\n\n"
                      "| ms | 80 | 160 | 320 | 400 | 560 | 1000 |\n|---|---:|---:|---:|---:|---:|---:|\n"
                      "| true ms | 33 | 67 | 133 | 167 | 233 | 417 |\n"
                      "| one | 0.10 | 0.20 | 0.30 | 0.40 | 0.50 | 0.60 |\n"
                      "| two | 1.00 | 2.00 | 3.00 | 4.00 | 5.00 | - |\n"));
  CHECK(has(cmu, "## mean of 2 actions"));
  CompletionTable h36m = small_table(false);
  for (CompletionRow& row : published_completion_rows(h36m.actions)) h36m.rows.push_back(std::move(row));
  const std::string text = completion_markdown(h36m, {});
  CHECK_FALSE(has(text, "true ms"));
  CHECK(has(text, "| SRNN (published) | 0.81 | 0.94 | 1.16 | 1.30 | - | - |"));
}

TEST_CASE("JSON: null for missing errors") {
  const nlohmann::json json = completion_json(small_table(true));
  CHECK(json["layout"] == "cmu");
  CHECK(json["milliseconds"][5] == 1000);
  CHECK(json["true_milliseconds"][5].get<double>() == doctest::Approx(416.667));
  CHECK(json["rows"][0]["errors"]["walking"][1] == .2);
  CHECK(json["rows"][0]["iterations"] == 70);
  CHECK(json["rows"][1]["errors"]["walking"][5].is_null());
  CHECK_FALSE(json["rows"][1]["errors"].contains("washwindow"));
  CHECK(json["rows"][1]["mean"][0].is_null());
}

}  // namespace completion_table_test

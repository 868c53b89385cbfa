#include "motiongan/train/progress.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include "../support/folders.hpp"
#include "../support/messages.hpp"

namespace progress_test {

using namespace motiongan;
using namespace motiongan::testing;

namespace {

/// What is printed to a temporary file while `use` runs.
template <class Use>
std::string printed(Use use) {
  std::FILE* file = std::tmpfile();
  REQUIRE(file != nullptr);
  use(file);
  std::string out;
  std::rewind(file);
  for (int c; (c = std::fgetc(file)) != EOF;) out += static_cast<char>(c);
  std::fclose(file);
  return out;
}

std::size_t times(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += part.size()) ++n;
  return n;
}

struct Folder {
  std::filesystem::path path = std::filesystem::temp_directory_path() / "motiongan_progress_test";
  Folder() {
    std::filesystem::remove_all(path);
    std::filesystem::create_directory(path);
  }
  ~Folder() { std::filesystem::remove_all(path); }
};

std::string read(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

}  // namespace

TEST_CASE("a progress line shows progress, rate and remaining time") {
  const std::vector<NamedValue> values{{"W", 34.2}, {"penalty", 0.31}};
  const std::string line = detail::progress_line("iteration", 5000, 20000, 3.2, values, 120);
  CHECK(line.size() <= 120);
  CHECK(line.rfind("iteration 5000/20000 [=======>", 0) == 0);
  CHECK(line.find("3.2 it/s  ETA 01:18:08") != std::string::npos);
  CHECK(line.find("  W 34.2  penalty 0.31") != std::string::npos);
  // Narrower: the bar is dropped first, then values from the end.
  const std::string narrow = detail::progress_line("iteration", 5000, 20000, 3.2, values, 54);
  CHECK(narrow.find('[') == std::string::npos);
  CHECK(narrow.find("W 34.2") != std::string::npos);
  CHECK(narrow.find("penalty") == std::string::npos);
  for (std::size_t width = 1; width < 130; ++width)
    CHECK(detail::progress_line("iteration", 5000, 20000, 3.2, values, width).size() <= width);
  CHECK(detail::progress_line("step", 3, 0, 0.25, {}, 80) == "step 3  4 s/it");
  CHECK(detail::progress_line("step", 0, 9, 0, {}, 80).find("ETA --:--:--") != std::string::npos);
  CHECK(detail::progress_line("step", 9, 9, 1, {}, 80).find("ETA 00:00:00") != std::string::npos);
  CHECK(detail::clock_text(90061) == "1d 01:01:01");
}

TEST_CASE("on a terminal the line is redrawn in place, at most once per interval") {
  double time = 100;
  const std::string text = printed([&](std::FILE* file) {
    ProgressBar bar(1000, {.out = file, .terminal = true, .width = 100, .now = [&] { return time; }});
    bar.start(1000);
    for (std::size_t i = 1; i <= 1000; ++i) {
      time += 0.01;
      bar.update(i, {{"W", static_cast<double>(i)}});
      if (i == 500) bar.note("half of it");
    }
    CHECK(bar.rate() == doctest::Approx(100).epsilon(0.01));
    bar.finish();
  });
  CHECK(times(text, "iteration ") > 60);
  CHECK(times(text, "iteration ") < 140);
  CHECK(times(text, "\n") == 2);  // the note's and the end's
  CHECK(text.find("\x1b[Khalf of it\n") != std::string::npos);
  CHECK(text.back() == '\n');
  CHECK(text.find("iteration 1000/1000") != std::string::npos);
}

TEST_CASE("a file gets plain lines at intervals") {
  double time = 0;
  const std::string text = printed([&](std::FILE* file) {
    ProgressBar bar(100, {.out = file, .plain_interval = 10, .now = [&] { return time; }});
    bar.start(100, 40);
    for (std::size_t i = 41; i <= 100; ++i) {
      time += 1;
      bar.update(i);
    }
    bar.finish();
  });
  CHECK(text.find('\r') == std::string::npos);
  CHECK(text.find('\x1b') == std::string::npos);
  CHECK(times(text, "\n") == 7);  // at 41, 51, ... 91, and the end
  CHECK(text.find("iteration 41/100") != std::string::npos);
  CHECK(text.find("iteration 100/100") != std::string::npos);
  CHECK(text.find("1 it/s  ETA 00:00:49") != std::string::npos);  // without the 40 of an earlier run
}

TEST_CASE("the rate is a moving average") {
  double time = 0;
  printed([&](std::FILE* file) {
    ProgressBar bar(0, {.out = file, .terminal = false, .smoothing = 10, .now = [&] { return time; }});
    bar.start(0);
    std::size_t done = 0;
    for (int i = 0; i < 100; ++i) bar.update(++done, {}), time += 1;
    for (int i = 0; i < 100; ++i) bar.update(++done, {}), time += 0.5;
    CHECK(bar.rate() == doctest::Approx(2).epsilon(0.03));
  });
}

TEST_CASE("a log can be read back bit for bit") {
  const Folder folder;
  const auto path = folder.path / "log.csv";
  const double third = 1.0 / 3, tiny = 1e-300;
  {
    CsvLog log(path, {"wasserstein", "penalty"});
    CHECK_FALSE(log.last_iteration());
    log.append(10, std::vector{third, tiny});
    CHECK(read_csv_log(path).rows.size() == 1);  // flushed at once
    log.append(20, std::vector{std::numeric_limits<double>::quiet_NaN(), -0.5});
    CHECK_THROWS_AS(log.append(20, std::vector{1.0, 2.0}), Error);
    CHECK_THROWS_AS(log.append(30, std::vector{1.0}), Error);
    CHECK(log.last_iteration() == 20u);
  }
  const CsvTable table = read_csv_log(path);
  CHECK(table.columns == std::vector<std::string>{"iteration", "wasserstein", "penalty"});
  CHECK(table.column("iteration") == std::vector<double>{10, 20});
  CHECK(table.rows[0][1] == third);
  CHECK(table.rows[0][2] == tiny);
  CHECK(std::isnan(table.rows[1][1]));
  CHECK_THROWS_AS(table.column("loss"), Error);
}

TEST_CASE("a resumed log drops the rows that are computed again and an incomplete row") {
  const Folder folder;
  const auto path = folder.path / "log.csv";
  {
    CsvLog log(path, {"w"});
    for (std::uint64_t i = 1; i <= 5; ++i) log.append(10 * i, std::vector{static_cast<double>(i)});
  }
  const std::string before = read(path);
  std::ofstream(path, std::ios::app | std::ios::binary) << "60,0.3";  // cut off by a crash
  {
    CsvLog log(path, {"w"}, 30);
    CHECK(log.last_iteration() == 30u);
    log.append(40, std::vector{4.0});
    log.append(50, std::vector{5.0});
  }
  CHECK(read(path) == before);
  CHECK_FALSE(has_unfinished(folder.path));
  CsvLog(path, {"w"}, 0);
  CHECK(read(path) == "iteration,w\n");
}

TEST_CASE("a log of another run is not changed") {
  const Folder folder;
  const auto path = folder.path / "log.csv";
  {
    CsvLog log(path, {"a", "b"});
    log.append(1, std::vector{1.0, 2.0});
  }
  const std::string before = read(path);
  CHECK_THROWS_WITH_AS(CsvLog(path, {"a", "c"}, 1), doctest::Contains("iteration,a,b"), Error);
  CHECK_THROWS_WITH_AS(CsvLog(path, {"a", "b"}), doctest::Contains("1 rows of another run"), Error);
  CHECK(read(path) == before);
  std::ofstream(path, std::ios::app) << "2,x,3\n";
  CHECK_THROWS_WITH_AS(read_csv_log(path), doctest::Contains("'x' is not a number"), Error);
  CHECK_THROWS_AS(CsvLog(folder.path / "no" / "log.csv", {"a"}), Error);
  CHECK_THROWS_AS(CsvLog(folder.path / "new.csv", {"a,b"}), Error);
  CHECK_THROWS_AS(read_csv_log(folder.path / "none.csv"), Error);
}

TEST_CASE("a damaged log is repaired to the last whole row, and that is said") {
  const Folder folder;
  const auto path = folder.path / "log.csv", damaged = folder.path / "log.damaged.csv";
  std::vector<std::string> said;
  const auto warn = [&](const std::string& text) { said.push_back(text); };
  const auto resume = [&](std::uint64_t done) { return continued_log(path, {"w"}, done, damaged, warn); };
  {
    CsvLog log(path, {"w"});
    for (std::uint64_t i = 1; i <= 3; ++i) log.append(i, std::vector{static_cast<double>(i)});
  }
  const std::string whole = read(path);
  for (const std::string& tail :
       {std::string(512, '\0'), std::string("x9&%,\n4,4\n"), std::string(9, '\0') + "\n4,4\n"}) {
    std::ofstream(path, std::ios::app | std::ios::binary) << tail;
    said.clear();
    CHECK(resume(9)->last_iteration() == 3u);
    CHECK(read(path) == whole);
    if (tail.find('\n') == std::string::npos) continue;  // an unfinished row is nothing unusual
    REQUIRE(said.size() == 1);
    CHECK(says(said[0], "log.csv:5: "));
    CHECK(says(said[0], "all after it are removed"));
  }
  said.clear();
  std::ofstream(path, std::ios::binary) << std::string(30, '\0') << "\n1,1\n";
  CHECK_FALSE(resume(2)->last_iteration());
  CHECK(read(path) == "iteration,w\n");
  CHECK(read(damaged).size() == 35);
  REQUIRE(said.size() == 2);
  CHECK(says(said[0], "is now " + damaged.string()));
  CHECK(says(said[1], "no rows of iterations 1 to 2"));
}

}  // namespace progress_test

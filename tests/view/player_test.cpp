#include "motiongan/view/player.hpp"

#include <doctest/doctest.h>
#include <sys/resource.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "../support/folders.hpp"
#include "figure_help.hpp"

namespace player_test {

using namespace motiongan;

namespace {

/// The text of the page's data element, as a browser would pass it to JSON.parse.
std::string data_text(const std::string& page) {
  const std::string begin = "<script id=\"clips\" type=\"application/json\">";
  const std::size_t from = page.find(begin) + begin.size();
  REQUIRE(page.find(begin) != std::string::npos);
  return page.substr(from, page.find("</script", from) - from);
}

std::vector<double> decode(const nlohmann::json& clip) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<unsigned> bytes;
  unsigned group = 0, bits = 0;
  for (const char c : clip["data"].get<std::string>()) {
    if (c == '=') break;
    group = (group << 6 | static_cast<unsigned>(digits.find(c))) & 0xffffffu;
    bits += 6;
    if (bits >= 8) {
      bits -= 8;
      bytes.push_back(group >> bits & 255u);
    }
  }
  std::vector<double> out;
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    const int number = static_cast<int>(bytes[i] | bytes[i + 1] << 8);
    out.push_back(clip["origin"][i / 2 % 3].get<double>() +
                  clip["scale"].get<double>() * (number > 32767 ? number - 65536 : number));
  }
  return out;
}

}  // namespace

TEST_CASE("the page contains the positions of forward kinematics") {
  const std::vector<view::ViewedMotion> motions{test::walker(40, 30, "one", 7), test::walker(11, 25, "two")};
  const auto data = nlohmann::json::parse(data_text(view::player_page(motions, {.title = "both"})));
  CHECK(data["title"] == "both");
  REQUIRE(data["clips"].size() == 2);
  CHECK_FALSE(data.contains("group"));
  CHECK(nlohmann::json::parse(data_text(view::player_page(motions, {.group = 2})))["group"] == 2);
  for (std::size_t c = 0; c < 2; ++c) {
    const auto& clip = data["clips"][c];
    const view::Figure figure = view::make_figure(motions[c]);
    CHECK(clip["frames"] == figure.frames);
    CHECK(clip["rate"] == figure.rate);
    CHECK(clip["seed"] == motions[c].seed_frames);
    CHECK(clip["parents"].get<std::vector<int>>() == figure.parents);
    const std::vector<double> values = decode(clip);
    REQUIRE(values.size() == figure.points.size() * 3);
    double worst = 0;
    for (std::size_t i = 0; i < values.size(); ++i)
      worst = std::max(worst, std::abs(values[i] - figure.points[i / 3][i % 3]));
    CHECK(worst <= 0.51 * clip["scale"].get<double>() + 1e-6);
    CHECK(clip["scale"].get<double>() < 0.01);  // under a tenth of a millimetre here
  }
}

TEST_CASE("fast motions are subsampled by whole strides") {
  const std::vector<view::ViewedMotion> fast{test::walker(121, 120, "fast", 31)};
  const auto clip = nlohmann::json::parse(data_text(view::player_page(fast)))["clips"][0];
  CHECK(clip["rate"] == 60);
  CHECK(clip["frames"] == 61);
  CHECK(clip["seed"] == 16);
  const auto points = decode(clip);
  const view::Figure figure = view::make_figure(fast[0]);
  CHECK(points[60 * figure.nodes() * 3] == doctest::Approx(figure.point(120, 0)[0]));
  const auto odd = nlohmann::json::parse(
      data_text(view::player_page(std::vector{test::walker(10, 100, "odd")})))["clips"][0];
  CHECK(odd["rate"] == 50);
}

TEST_CASE("titles are escaped") {
  const std::vector<std::string> titles{
      "</script><script>alert(1)</script>",        "<!--",     "a \"quoted\" \\ back", "l'homme & co\n\ttab",
      "\xe6\xad\xa9\xe3\x81\x8f \xf0\x9f\x95\xba", "/*CLIPS*/"};
  std::vector<view::ViewedMotion> motions;
  for (const std::string& title : titles) motions.push_back(test::walker(3, 30, title));
  const std::string page = view::player_page(motions, {.title = "</title><script>"});
  const std::string text = data_text(page);
  CHECK(text.find('<') == std::string::npos);
  CHECK(text.find('&') == std::string::npos);
  const auto data = nlohmann::json::parse(text);
  for (std::size_t i = 0; i < titles.size(); ++i) CHECK(data["clips"][i]["title"] == titles[i]);
  CHECK(page.find("</title><script>") == std::string::npos);
}

TEST_CASE("the page makes no network requests") {
  const std::string page = view::player_page(std::vector{test::walker(5)});
  for (const char* forbidden : {"http:", "https:", "src=", "href=", "@import", "fetch(", "XMLHttpRequest"})
    CHECK_MESSAGE(page.find(forbidden) == std::string::npos, forbidden);
}

TEST_CASE("every number of the page is finite, or the clip and frame are named") {
  const auto numbers = [](const nlohmann::json& clip) {
    bool finite = true;
    for (const char* key : {"rate", "height", "floor", "heading", "scale"})
      finite = finite && std::abs(clip[key].get<double>()) < 1e30;
    for (const double x : clip["origin"]) finite = finite && std::abs(x) < 1e30;
    return finite;
  };
  auto motions = std::vector{test::walker(5, 30, "far away")};
  motions[0].motion.position(3, 1)[2] = 1e8;
  CHECK(numbers(nlohmann::json::parse(data_text(view::player_page(motions)))["clips"][0]));
  for (const double x : {1e308, -1e308, 1e11}) {
    motions[0].motion.position(3, 1)[2] = x;
    CHECK_THROWS_WITH_AS(view::player_page(motions), doctest::Contains("'far away' has a position of "),
                         Error);
    CHECK_THROWS_WITH_AS(view::player_page(motions), doctest::Contains("in frame 3, expected at most "),
                         Error);
  }
  // A rate that no clip has: one frame is shown, not a stride that does not fit an integer.
  const auto clip = nlohmann::json::parse(
      data_text(view::player_page(std::vector{test::walker(10, 1e200, "quick")})))["clips"][0];
  CHECK(clip["frames"] == 1);
}

TEST_CASE("sixteen clips of eight seconds stay small") {
  std::vector<view::ViewedMotion> motions(16, test::walker(480, 60));
  const double nodes = 9, bytes = 16 * 480 * nodes * 3 * 2 * 4 / 3;
  CHECK(static_cast<double>(view::player_page(motions).size()) < bytes + 40000);
}

TEST_CASE("a page is written whole or not at all") {
  const auto folder = std::filesystem::temp_directory_path() / "motiongan_player_test";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directory(folder);
  const std::vector<view::ViewedMotion> motions{test::walker(5)};
  view::write_player(folder / "page.html", motions);
  std::ifstream in(folder / "page.html", std::ios::binary);
  const std::string written{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  CHECK(written == view::player_page(motions));
  CHECK_FALSE(testing::has_unfinished(folder));

  auto broken = motions;
  broken[0].motion.position(2, 1)[0] = std::numeric_limits<double>::infinity();
  CHECK_THROWS_AS(view::write_player(folder / "page.html", broken), Error);
  CHECK(std::filesystem::file_size(folder / "page.html") == written.size());
  CHECK_THROWS_WITH_AS(view::write_player(folder / "no" / "page.html", motions),
                       doctest::Contains("page.html"), Error);
  // A disk without space: files of at most 4096 bytes may be written.
  rlimit before{};
  REQUIRE(getrlimit(RLIMIT_FSIZE, &before) == 0);
  const rlimit small{4096, before.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  REQUIRE(setrlimit(RLIMIT_FSIZE, &small) == 0);
  CHECK_THROWS_WITH_AS(view::write_player(folder / "page.html", motions),
                       doctest::Contains(".tmp: File too large; does the folder exist"), Error);
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  CHECK_FALSE(testing::has_unfinished(folder));
  CHECK(std::filesystem::file_size(folder / "page.html") == written.size());
  CHECK_THROWS_AS(view::player_page({}), Error);
  CHECK_THROWS_AS(view::player_page(motions, {.max_rate = 0}), Error);
  std::filesystem::remove_all(folder);
}

}  // namespace player_test

// motiongan serve: who is let in, the other kinds of models, and the page in a browser.
#include <doctest/doctest.h>

#include <cmath>
#include <csignal>

#include "browser.hpp"
#include "motiongan/formats/bvh.hpp"
#include "motiongan/models/dvgan.hpp"
#include "motiongan/motion/motion.hpp"
#include "server.hpp"

namespace serve_page_test {

using namespace motiongan::motion;

namespace {

void make_rnn() {
  REQUIRE(call("train dvgan --procedural 6 --save run --iterations 2" + tiny_rnn).status == 0);
}

/// What the first character's root does over the ground, from the BVH file of what was seen.
std::vector<std::pair<double, double>> places(const Page& page) {
  write_file("seen.bvh", page.request("GET", "/characters/0.bvh").body);
  const Motion seen = to_motion(read_bvh("seen.bvh"));
  std::vector<std::pair<double, double>> out;
  for (std::size_t f = 0; f < seen.frames; ++f)
    out.emplace_back(seen.position(f, 0)[0], seen.position(f, 0)[2]);
  return out;
}

/// Runs a server that should refuse to start; one that does start is ended.
Said call_briefly(const std::string& arguments) {
  return shell(std::string("timeout 60 '") + MOTIONGAN_COMMAND + "' serve " + arguments);
}

}  // namespace

TEST_CASE("at the loopback address other web sites are kept out") {
  const TestFolder folder;
  make_rnn();
  const Server server("run");
  if (!server.runs()) return;
  const std::string port = std::to_string(server.port);
  CHECK(server.url == "http://127.0.0.1:" + port + "/");
  const Reply page = server.request("GET", "/");
  CHECK(page.status == 200);
  CHECK(page.body.starts_with("<!DOCTYPE html>"));
  CHECK(page.body.find("function drawBody(") != std::string::npos);  // of the player
  CHECK(page.body.find("function clickAt(") != std::string::npos);
  for (const char* left : {"/*FIGURES*/", "/*PAGE*/", "https://", "src="})
    CHECK(page.body.find(left) == page.body.npos);
  CHECK(page.head.find("frame-ancestors 'none'") != std::string::npos);
  CHECK(page.head.find("no-referrer") != std::string::npos);

  const auto status = [&](const Server::Headers& headers) {
    return server.request("POST", "/sessions", "", headers).status;
  };
  CHECK(status({{"Host", "localhost:" + port}}) == 201);
  CHECK(status({{"Host", "LOCALHOST:" + port}, {"Origin", "http://localhost:" + port}}) == 201);
  CHECK(status({{"Origin", "http://127.0.0.1:" + port}}) == 201);
  for (const std::string& host :
       {std::string("evil.example"), "evil.example:" + port, std::string("127.0.0.1"),
        std::string("127.0.0.1:1"), "127.0.0.1:" + port + ".evil.example", std::string()})
    CHECK_MESSAGE(status({{"Host", host}}) == 403, host);
  for (const std::string& origin :
       {std::string("http://evil.example"), std::string("null"), "https://127.0.0.1:" + port,
        "http://localhost:" + port, std::string("http://127.0.0.1:1")})
    CHECK_MESSAGE(status({{"Origin", origin}}) == 403, origin);
  CHECK(server.request("GET", "/", "", {{"Host", "evil.example"}}).status == 403);

  // A refused request does not bring another one in its body.
  const std::string inner = "POST /sessions HTTP/1.1\r\nHost: 127.0.0.1:" + port + "\r\n\r\n";
  for (const std::string type : {"text/plain", "multipart/form-data; boundary=x"}) {
    const std::string outer = "POST /sessions HTTP/1.1\r\nHost: 127.0.0.1:" + port +
                              "\r\nOrigin: http://evil.example\r\nContent-Type: " + type +
                              "\r\nContent-Length: " + std::to_string(inner.size()) + "\r\n\r\n";
    const std::string answer = send_raw(server.port, outer + inner);
    CHECK_MESSAGE((answer.empty() || answer.find("403") != answer.npos), answer);
    CHECK_MESSAGE(answer.find("201 Created") == answer.npos, answer);
  }
}

TEST_CASE("another address needs the token") {
  const TestFolder folder;
  make_rnn();
  Server server("run --host 0.0.0.0");
  if (!server.runs()) return;
  REQUIRE(server.token.size() == 32);
  const Server second("run --host 0.0.0.0");
  CHECK(second.token != server.token);
  std::string wrong = server.token;
  wrong.back() = wrong.back() == '0' ? '1' : '0';
  for (const std::string& query :
       {std::string(), std::string("?token="), "?token=" + wrong, "?token=" + second.token,
        "?token=" + server.token + "0", "?token=" + server.token.substr(1)}) {
    CHECK_MESSAGE(server.request("GET", "/" + query).status == 403, query);
    CHECK_MESSAGE(server.request("POST", "/sessions" + query).status == 403, query);
  }
  const std::string right = "?token=" + server.token;
  CHECK(server.request("GET", "/" + right, "", {{"Host", "a-name.example:1"}}).status == 200);
  CHECK(server.request("POST", "/sessions" + right, "", {{"Origin", "http://evil.example"}}).status == 403);
  const Page page(server);
  CHECK(page.request("POST", "/characters", R"({"prompt":"walk"})").status == 201);
  CHECK(page.frames("count=2").all.size() == 2);
  CHECK(server.end(SIGTERM) == 128 + SIGTERM);
}

TEST_CASE("a CNN model: windows that begin where the last one ended") {
  const TestFolder folder;
  REQUIRE(call("train dvgan --procedural 6 --save cnn --iterations 2" + tiny).status == 0);
  const Server server("cnn/generator.safetensors");
  if (!server.runs()) return;
  const Page page(server);
  CHECK(page.model.at("made") == "windows");
  CHECK(page.model.at("window") == 16);
  REQUIRE(
      page.request("POST", "/characters", R"({"prompt":"walk","x":50,"z":20,"yaw":0.5,"sample":4})").status ==
      201);
  for (int i = 0; i < 5; ++i) CHECK(page.frames("count=4").all.size() == 4);
  CHECK(page.request("PATCH", "/characters/0", R"({"prompt":"jump"})").status == 200);
  CHECK(page.request("PATCH", "/characters/0", R"({"prompt":"!"})").status == 400);
  CHECK(page.frames("count=2").all.size() == 2);

  const motiongan::Context context;
  const auto model = motiongan::Dvgan::load(context, "cnn/generator.safetensors");
  const PoseLayout& layout = model.format().layout;
  const auto window = [&](const char* text, std::size_t sample, const RootTrack& at) {
    return placed_at(model.generate(text, {.count = 1, .first_sample = sample}).front(), layout.root(), at,
                     layout.has_yaw());
  };
  const Motion first = window("walk", 4, {50, 20, 0.5}),
               second = window("walk", 5, layout.track_of(first, 15)),
               third = window("jump", 6, layout.track_of(second, 3));
  const Motion whole = join(join(first, slice(second, 0, 4)), slice(third, 0, 2));
  write_file("seen.bvh", page.request("GET", "/characters/0.bvh").body);
  write_bvh("made.bvh", whole);
  CHECK(read_bvh("seen.bvh").channels == read_bvh("made.bvh").channels);
  const auto at = places(page);
  CHECK(at[0].first == doctest::Approx(50));
  CHECK(at[0].second == doctest::Approx(20));
  CHECK(at[16] == at[15]);
  CHECK(at[20] == at[19]);
}

TEST_CASE("a model of classes: seconds from drawn or given clips") {
  const TestFolder folder;
  REQUIRE(call("train attention --procedural 51 --save actions --iterations 2 --frames 8 --rate 10 --hidden "
               "8 --batch 4 "
               "--critic-steps 1 --classes walk,run,jump --split-seed 3")
              .status == 0);
  REQUIRE(call("synth clips --clips 3 --seconds 5").status == 0);
  for (const std::string priors : {"", " --clip clips/walk_000.bvh"}) {
    CAPTURE(priors);
    const Server server("actions" + priors);
    if (!server.runs()) return;
    const Page page(server);
    CHECK(page.model.at("classes") == true);
    CHECK(page.model.at("made") == "seconds");
    CHECK(page.model.at("prompts") == Json{"jump", "run", "walk"});
    REQUIRE(page.request("POST", "/characters", R"({"prompt":"walk","x":10,"z":-5})").status == 201);
    const Reply unknown = page.request("POST", "/characters", R"({"prompt":"walks"})");
    CHECK(unknown.status == 400);
    CHECK(unknown.json().at("error").dump().find("did you mean 'walk'?") != std::string::npos);
    const Page::Frames made = page.frames("count=10");
    REQUIRE(made.all.size() == 10);
    CHECK(made.all[0].at(0).size() > 30);
    CHECK(made.all[0].at(0) != made.all[9].at(0));
    CHECK(page.request("PATCH", "/characters/0", R"({"prompt":"jump"})").status == 200);
    CHECK(page.request("PATCH", "/characters/0", R"({"prompt":"fly"})").status == 400);
    CHECK(page.characters().at(0).at("prompt") == "jump");
    const auto at = places(page);
    CHECK(at.size() == 10);
    CHECK(std::hypot(at[0].first - 10, at[0].second + 5) < 20);  // the first step leads away from there
  }
  const auto refused = [](const std::string& arguments, const std::string& why) {
    const Said said = call_briefly("--port 0 " + arguments);
    CHECK_MESSAGE(said.status == 1, arguments);
    CHECK_MESSAGE(said.has(why), said.text);
  };
  refused("actions --clip missing.bvh", "missing.bvh");
  refused("actions --clip clips/walk_000.bvh --data clips", "give --clip or --data, not both");
  fs::copy_file("actions/generator.safetensors", "alone.safetensors");
  refused("alone.safetensors", "--clip CLIP");
  refused("missing", "missing");
  refused("actions --host 203.0.113.7", "cannot listen at port 0 of 203.0.113.7");
  make_rnn();
  refused("run --clip clips/walk_000.bvh", "takes no --clip");
  CHECK(call_briefly("run --characters 0").has("--characters"));
  CHECK(call_briefly("run --port 70000").has("--port"));
  const Server server("run");
  if (!server.runs()) return;
  const Said taken = call_briefly("run --port " + std::to_string(server.port));
  CHECK(taken.status == 1);
  CHECK_MESSAGE(taken.has("it is in use"), taken.text);
}

TEST_CASE("the page draws what is made, in Chromium") {
  if (shell("command -v chromium").status != 0) {
    MESSAGE("skipped: chromium is not installed");
    return;
  }
  const TestFolder folder;
  std::signal(SIGPIPE, SIG_IGN);
  make_rnn();
  const Server server("run");
  if (!server.runs()) return;
  Browser page(server.url + "#prompt=walk&prompt=frobnicate&select=0");
  if (!page.runs()) {
    MESSAGE("skipped: chromium does not start: ", bytes_of("browser.log").substr(0, 500));
    return;
  }
  CHECK(page.becomes_true("document.body.dataset.shown === '2' && +document.body.dataset.drawn > 20"));
  CHECK(page.value("document.getElementById('notes').textContent")
            .dump()
            .starts_with("\"The model never saw \\\"frobnicate\\\". "));
  CHECK(page.value("document.querySelectorAll('#texts option').length") > 3);
  CHECK(page.value("document.querySelectorAll('.row').length") == 2);
  CHECK(page.value("document.querySelector('.row.selected input').value") == "walk");
  // The canvas shows the figures: it has more colours than those of the floor and its lines.
  CHECK(page.value("new Set(new Uint32Array(byId('canvas').getContext('2d').getImageData(0, 0, "
                   "byId('canvas').width, byId('canvas').height).data.buffer)).size") > 50);
  CHECK(page.becomes_true("state.time > 4"));  // a second

  // A click on the floor adds a character there, one on its figure selects it.
  const double x = page.value("byId('canvas').getBoundingClientRect().x"),
               y = page.value("byId('canvas').getBoundingClientRect().y");
  page.value("byId('follow').checked = false, byId('ask').firstElementChild.value = 'jump'");
  const Json place =
      page.value("onFloor(camera(byId('canvas').clientWidth, byId('canvas').clientHeight), 90, 400)");
  REQUIRE(place.size() == 2);
  page.click(x + 90, y + 400);
  CHECK(page.becomes_true("document.body.dataset.shown === '3'"));
  const Json last = page.value("[...people.get(2).last.slice(0, 3)]");
  const double height = page.value("state.model.height");
  CHECK(std::hypot(last[0].get<double>() - place[0].get<double>(),
                   last[2].get<double>() - place[1].get<double>()) < height);
  page.value("pause(true), draw()");
  const Json spot = page.value("people.get(2).spots[0].slice(0, 2)");
  page.click(x + spot[0].get<double>(), y + spot[1].get<double>());
  CHECK(page.value("state.selected") == 2);
  CHECK(page.value("document.querySelector('.row.selected input').value") == "jump");

  // Its text changes, and it is removed.
  page.value(
      "(t => { t.value = 'run'; t.dispatchEvent(new Event('change')); })"
      "(document.querySelector('.row.selected input'))");
  CHECK(page.becomes_true("people.get(2).prompt === 'run'"));
  page.value("document.querySelector('.row.selected button').click()");
  CHECK(page.becomes_true("people.size === 2 && document.querySelectorAll('.row').length === 2"));
  CHECK(page.value("byId('notes').className") == "");  // no error
}

}  // namespace serve_page_test

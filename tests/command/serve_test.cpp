// motiongan serve: the protocol, and that what is sent is what the library makes.
#include <doctest/doctest.h>

#include "../support/glb_reader.hpp"
#include "motiongan/formats/bvh.hpp"
#include "motiongan/models/dvgan.hpp"
#include "motiongan/motion/motion.hpp"
#include "motiongan/sample/motion_stream.hpp"
#include "motiongan/view/figure.hpp"
#include "server.hpp"

namespace serve_test {

using namespace motiongan::motion;

namespace {

/// The points that the player draws of a motion of one frame.
Page::Points points_of(const Motion& frame) {
  Page::Points out;
  for (const Vec3& p : motiongan::view::make_figure({"", frame}).points)
    for (const double x : p) out.push_back(static_cast<float>(x));
  return out;
}

bool alike(const Page::Points& a, const Page::Points& b) {
  if (a.size() != b.size() || a.empty()) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (!(std::abs(a[i] - b[i]) < 1e-3F)) return false;
  return true;
}

void make_rnn() {
  REQUIRE(call("train dvgan --procedural 6 --save run --iterations 2" + tiny_rnn).status == 0);
}

}  // namespace

TEST_CASE("characters of an RNN model: frames are those of MotionStream; texts change; files read back") {
  const TestFolder folder;
  make_rnn();
  Server server("run");
  if (!server.runs()) return;
  const Page page(server);
  CHECK(page.model.at("rate") == 4);
  CHECK(page.model.at("classes") == false);
  CHECK(page.model.at("made") == "frames");
  CHECK(page.model.at("prompts").size() > 3);

  const Reply added =
      page.request("POST", "/characters", R"({"prompt":"walk","x":30,"z":-7,"yaw":1.1,"seed":5,"sample":3})");
  REQUIRE_MESSAGE(added.status == 201, added.body);
  CHECK(added.json().at("id") == 0);
  CHECK(added.json().at("unknown").empty());
  CHECK(page.characters().at(0) == Json{{"id", 0}, {"prompt", "walk"}});  // no figure before it moves
  CHECK(page.request("GET", "/characters/0.bvh").status == 400);          // nothing was seen

  const motiongan::Context context;
  const auto model = motiongan::Dvgan::load(context, "run/generator.safetensors");
  motiongan::MotionStream stream(model);
  const auto walker = stream.add({.text = "walk", .seed = 5, .sample = 3, .at = {30, -7, 1.1}});
  const Page::Frames made = page.frames("count=4");
  CHECK(made.first == 0);
  REQUIRE(made.all.size() == 4);
  Motion whole;
  const auto take = [&] {
    stream.step();
    whole = whole.frames == 0 ? stream.motion(walker) : join(std::move(whole), stream.motion(walker));
    return points_of(stream.motion(walker));
  };
  for (const Page::Frame& frame : made.all) {
    CHECK(frame.size() == 1);
    CHECK(alike(frame.at(0), take()));
  }
  const Json figure = page.characters().at(0).at("figure");
  CHECK(3 * figure.at("parents").size() == made.all[0].at(0).size());
  CHECK(figure.at("parents").at(0) == -1);

  SUBCASE("frames can be asked for again, but not before those that lead to them") {
    const Page::Frames again = page.frames("from=2&count=3");
    CHECK(again.first == 2);
    REQUIRE(again.all.size() == 3);
    CHECK(again.all[0] == made.all[2]);
    CHECK(again.all[1] == made.all[3]);
    CHECK(alike(again.all[2].at(0), take()));
    const Reply early = page.request("GET", "/frames?from=6");
    CHECK(early.status == 400);
    CHECK(early.json().at("error") == "from is 6, expected at most 5, the number of the next frame");
    for (int i = 0; i < 10; ++i) page.frames("count=4");
    const Page::Frames late = page.frames("from=0&count=4");  // gone: there are none of that range
    CHECK(late.all.empty());
    CHECK(late.first > 4);
    for (const char* wrong :
         {"count=0", "count=5", "count=x", "from=-1", "from=1.5", "count=99999999999999999999"})
      CHECK_MESSAGE(page.request("GET", std::string("/frames?") + wrong).status == 400, wrong);
  }
  SUBCASE("a new text") {
    const Reply changed = page.request("PATCH", "/characters/0", R"({"prompt":"jump high"})");
    CHECK_MESSAGE(changed.status == 200, changed.body);
    CHECK(page.characters().at(0).at("prompt") == "jump high");
    stream.set_text(walker, "jump high");
    for (const Page::Frame& frame : page.frames("count=4").all) CHECK(alike(frame.at(0), take()));
    // POST does the same, for those who cannot send PATCH.
    CHECK(page.request("POST", "/characters/0", R"({"prompt":"walk"})").status == 200);
    stream.set_text(walker, "walk");
    for (const Page::Frame& frame : page.frames("count=4").all) CHECK(alike(frame.at(0), take()));
  }
  SUBCASE("words that the model never saw are named, with the nearest descriptions") {
    const Reply unknown = page.request("POST", "/characters", R"({"prompt":"frobnicate walk"})");
    CHECK(unknown.status == 201);
    CHECK(unknown.json().at("unknown") == Json{"frobnicate"});
    CHECK(unknown.json().at("nearest").dump().find("walk") != std::string::npos);
    const Reply changed = page.request("PATCH", "/characters/0", R"({"prompt":"gargle"})");
    CHECK(changed.json().at("unknown") == Json{"gargle"});
    // Text without words: the character keeps its own.
    const Reply none = page.request("PATCH", "/characters/0", R"({"prompt":"?!"})");
    CHECK(none.status == 400);
    CHECK(none.json().at("error").dump().find("has no words") != std::string::npos);
    CHECK(page.characters().at(0).at("prompt") == "gargle");
  }
  SUBCASE("what was seen, as BVH and GLB: at most the last 60 seconds") {
    const Reply bvh = page.request("GET", "/characters/0.bvh");
    CHECK(bvh.status == 200);
    CHECK(bvh.head.find("attachment; filename=\"character-0.bvh\"") != std::string::npos);
    write_file("seen.bvh", bvh.body);
    write_bvh("made.bvh", whole);
    CHECK(bytes_of("seen.bvh") == bytes_of("made.bvh"));
    CHECK(read_bvh("seen.bvh").frames == 4);
    for (int i = 0; i < 75; ++i)  // 304 frames in all: 76 seconds
      for (std::size_t f = page.frames("count=4").all.size(); f > 0; --f) take();
    write_file("long.bvh", page.request("GET", "/characters/0.bvh").body);
    write_bvh("long_made.bvh", slice(whole, 304 - 240, 240));
    const Clip seen = read_bvh("long.bvh"), expected = read_bvh("long_made.bvh");
    CHECK(seen.frames == 240);
    CHECK(seen.channels == expected.channels);
    const Reply glb = page.request("GET", "/characters/0.glb");
    CHECK(glb.status == 200);
    const motiongan::testing::Glb file(glb.body);
    REQUIRE(file.json.at("animations").size() == 1);
    CHECK(file.json.at("animations").at(0).at("name") == "character-0");
    CHECK(page.request("GET", "/characters/0.fbx").status == 404);
    CHECK(page.request("POST", "/characters/0.bvh").status == 405);
  }
  SUBCASE("characters come and go; pages do not see each other's") {
    CHECK(page.request("POST", "/characters", R"({"prompt":"run"})").json().at("sample") == 0);
    CHECK(page.request("POST", "/characters", R"({"prompt":"run"})").json().at("sample") == 1);
    Page::Frame frame = page.frames("").all.at(0);
    CHECK(frame.size() == 3);
    CHECK(frame.at(1) != frame.at(2));
    CHECK(alike(frame.at(0), take()));  // whoever else there is
    const Page other(server);
    CHECK(other.session != page.session);
    CHECK(other.characters().empty());
    CHECK(other.frames("count=2").all.empty());
    CHECK(other.request("DELETE", "/characters/0").status == 404);
    CHECK(page.request("DELETE", "/characters/1").status == 204);
    CHECK(page.request("DELETE", "/characters/1").status == 404);
    CHECK(page.request("PATCH", "/characters/1", R"({"prompt":"run"})").status == 404);
    CHECK(page.request("GET", "/characters/1.bvh").status == 404);
    frame = page.frames("").all.at(0);
    CHECK(frame.size() == 2);
    CHECK(frame.contains(2));
    CHECK(other.request("DELETE", "/session").status == 204);
    CHECK(other.request("GET", "/characters").status == 404);
    CHECK(page.characters().size() == 2);
  }
}

TEST_CASE("what is malformed is refused, and changes nothing") {
  const TestFolder folder;
  make_rnn();
  Server server("run --characters 2");
  if (!server.runs()) return;
  const Page page(server);
  REQUIRE(page.request("POST", "/characters", R"({"prompt":"walk"})").status == 201);
  page.frames("count=2");
  const Json before = page.characters();
  const std::string large(100000, ' ');

  for (const std::string body :
       {"{", "[]", "7", "\"walk\"", "{}", R"({"prompt":7})", R"({"prompt":"walk","x":"1"})",
        R"({"prompt":"walk","x":1e7})", R"({"prompt":"walk","z":1e999})", R"({"prompt":"walk","speed":1})",
        R"({"prompt":"walk","seed":-1})", R"({"prompt":"walk","seed":1.5})",
        R"({"prompt":"walk","sample":4294967296})", R"({"prompt":"..."})", "{\"prompt\":\"\xff\"}"}) {
    const Reply reply = page.request("POST", "/characters", body);
    CHECK_MESSAGE(reply.status == 400, body);
    CHECK_MESSAGE(!reply.json().at("error").get<std::string>().empty(), body);
  }
  CHECK(page.request("POST", "/characters", "{\"prompt\":\"" + std::string(1001, 'a') + "\"}").status == 400);
  CHECK(page.request("POST", "/characters", std::string(1000, '[')).status == 400);
  CHECK(page.request("POST", "/characters").status == 400);  // without a body
  CHECK(
      page.request("POST", "/characters", R"({"prompt":"walk"})", {{"Content-Type", "text/plain"}}).status ==
      400);
  CHECK(page.request("POST", "/characters", R"({"prompt":"walk"})",
                     {{"Content-Type", "multipart/form-data; boundary=x"}})
            .status == 400);
  CHECK(page.request("PATCH", "/characters/0", R"({"prompt":"run","x":1})").status == 400);
  CHECK(page.request("PATCH", "/characters/zero", R"({"prompt":"run"})").status == 400);
  // Bodies beyond the limit, announced or not.
  CHECK(page.request("POST", "/characters", large + R"({"prompt":"walk"})").status == 413);
  const std::string chunk = "186a0\r\n" + large + "\r\n12\r\n{\"prompt\":\"walk\"} \r\n0\r\n\r\n";
  const std::string chunked = send_raw(
      server.port, "POST " + page.path("/characters") +
                       " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(server.port) +
                       "\r\nContent-Type: application/json\r\nTransfer-Encoding: chunked\r\n\r\n" + chunk);
  CHECK_MESSAGE((chunked.empty() || chunked.starts_with("HTTP/1.1 413")), chunked.substr(0, 200));

  CHECK(page.request("PUT", "/characters", "{}").status == 405);
  CHECK(page.request("GET", "/characters/0").status == 405);
  CHECK(page.request("POST", "/frames", "{}").status == 405);
  CHECK(server.request("GET", "/sessions").status == 405);
  CHECK(server.request("GET", "/player.html").status == 404);
  CHECK(server.request("GET", "/characters").status == 400);  // of which session?
  CHECK(server.request("GET", "/characters?session=00").status == 404);
  CHECK(server.request("GET", "/../../etc/passwd").status == 404);
  CHECK(send_raw(server.port, "nonsense\r\n\r\n").starts_with("HTTP/1.1 400"));
  CHECK(page.characters() == before);
  CHECK(page.frames("").first == 2);

  // The bounds of characters and sessions.
  CHECK(page.request("POST", "/characters", R"({"prompt":"walk"})").status == 201);
  const Reply full = Page(server).request("POST", "/characters", R"({"prompt":"walk"})");
  CHECK(full.status == 409);
  CHECK(full.json().at("error").dump().find("--characters") != std::string::npos);
  for (int i = 0; i < 14; ++i) Page{server};
  const Reply crowded = server.request("POST", "/sessions");
  CHECK(crowded.status == 503);
  CHECK(crowded.json().at("error").dump().find("16 open pages") != std::string::npos);

  // Ctrl-C.
  CHECK(server.end(SIGINT) == 130);
  CHECK(send_raw(server.port, "GET / HTTP/1.1\r\n\r\n").empty());
}

}  // namespace serve_test

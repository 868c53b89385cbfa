// The script of the page, run by Node.js with a document that does nothing but count.
#include <doctest/doctest.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "figure_help.hpp"
#include "motiongan/view/player.hpp"

namespace player_script_test {

using namespace motiongan;
namespace fs = std::filesystem;

namespace {

// Elements take what the script sets; drawing counts canvases and lines, and checks every coordinate.
constexpr const char* browser = R"(
"use strict";
const fs = require("fs"), page = fs.readFileSync(process.argv[2], "utf8");
const part = (from, to) => {
  const at = page.indexOf(from) + from.length;
  return page.slice(at, page.indexOf(to, at));
};
const data = part('<script id="clips" type="application/json">', "</script>");
const counts = { drawn: 0, lines: 0, dashed: 0, bad: 0 };
const check = (...list) => { for (const x of list) if (!Number.isFinite(x)) ++counts.bad; };
let dashes = 0;
const pen = { setTransform() { ++counts.drawn; }, fillRect() {}, beginPath() {}, fill() {}, fillText() {},
  stroke() { ++counts.lines; if (dashes) ++counts.dashed; }, setLineDash(list) { dashes = list.length; },
  moveTo: check, lineTo: check, arc: check };
const make = name => ({ name, style: { setProperty() {} }, dataset: {}, children: [], clientWidth: 400,
  clientHeight: 300, checked: true, options: [{ text: "1" }], append(...list) { this.children.push(...list); },
  addEventListener() {}, getContext: () => pen, click() {} });
const elements = { clips: { textContent: data } };
global.document = { documentElement: make("html"), createElement: make,
  getElementById: id => elements[id] ??= make(id) };
global.window = { devicePixelRatio: 1 };
global.location = { hash: "" };
global.matchMedia = () => ({ matches: false, addEventListener() {} });
global.addEventListener = () => {};
let frame = null, sight = null;
global.requestAnimationFrame = f => frame = f;
global.ResizeObserver = class { constructor() {} observe() {} };
global.IntersectionObserver = class {
  constructor(f) { sight = { f, seen: [] }; }
  observe(target) { sight.seen.push(target); }
};
(0, eval)(part('</script>\n<script>', "</script>"));
const show = (from, to, isIntersecting) =>
  sight.f(sight.seen.slice(from, to).map(target => ({ target, isIntersecting })));
const next = () => { counts.drawn = 0; frame(performance.now()); return counts.drawn; };
const said = { clips: sight.seen.length, before: next() };
counts.drawn = 0; show(0, 3, true); said.appearing = counts.drawn;
said.three = next();
show(0, 2, false); said.one = next();
elements.follow.checked = false; counts.lines = counts.dashed = 0; next();
said.lines = counts.lines; said.dashed = counts.dashed;
said.bad = counts.bad;
console.log(Object.entries(said).map(([key, value]) => `${key}=${value}`).join(" "));
)";

std::string said_by(const std::string& command) {
  std::string out;
  std::FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return out;
  char part[4096];
  for (std::size_t n; (n = std::fread(part, 1, sizeof part, pipe)) > 0;) out.append(part, n);
  pclose(pipe);
  return out;
}

std::string run_page(const std::vector<view::ViewedMotion>& motions) {
  const fs::path folder =
      fs::temp_directory_path() / ("motiongan_player_script_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  view::write_player(folder / "page.html", motions);
  std::ofstream(folder / "browser.js") << browser;
  std::string out =
      said_by("node '" + (folder / "browser.js").string() + "' '" + (folder / "page.html").string() + "'");
  fs::remove_all(folder);
  return out;
}

bool has_node() {
  if (std::system("node --version >/dev/null 2>&1") == 0) return true;
  MESSAGE("skipped: there is no node to run the page's script");
  return false;
}

}  // namespace

TEST_CASE("only figures in sight are drawn") {
  if (!has_node()) return;
  const std::string said = run_page(std::vector(1000, test::walker(4)));
  CAPTURE(said);
  // Node.js may have warned of something else before.
  CHECK(said.find("clips=1000 before=0 appearing=3 three=3 one=1 ") != std::string::npos);
  CHECK(said.ends_with(" bad=0\n"));
}

TEST_CASE("a figure that travels far is drawn with few lines and finite coordinates") {
  if (!has_node()) return;
  auto motions = std::vector{test::walker(4), test::walker(4), test::walker(4, 30, "far")};
  motions[2].motion.position(3, 1)[2] = 1e9;
  const std::string said = run_page(motions);
  CAPTURE(said);
  CHECK(said.ends_with(" bad=0\n"));
  const std::size_t at = said.find("lines=");
  REQUIRE(at != std::string::npos);
  CHECK(std::stoul(said.substr(at + 6)) < 500);
}

TEST_CASE("a path is drawn dashed, a target and a ghost beside the figure, all in finite coordinates") {
  if (!has_node()) return;
  auto motions = std::vector(3, test::walker(4));
  const std::string plain = run_page(motions);
  CAPTURE(plain);
  CHECK(plain.ends_with(" dashed=0 bad=0\n"));
  motions[2].marks.path = {{0, 0, 0}, {50, 0, 20}, {100, 0, 0}};
  motions[2].marks.targets = {{{10, 120, 5}, 0, 0.1}};
  motions[2].marks.ghosts = {test::walker(1).motion};
  const std::string marked = run_page(motions);
  CAPTURE(marked);
  CHECK(marked.ends_with(" dashed=1 bad=0\n"));
  const auto lines = [](const std::string& said) { return std::stoul(said.substr(said.find("lines=") + 6)); };
  // The path, the target's line and its circle, and the ghost's limbs.
  CHECK(lines(marked) > lines(plain) + 3);
}

}  // namespace player_script_test

// Outputs never replace inputs, and a write that fails leaves nothing behind.
#include "../../src/shared/outputs.hpp"

#include <doctest/doctest.h>

#include "../support/messages.hpp"
#include "command.hpp"
#include "motiongan/formats/text_file.hpp"

namespace outputs_test {

using namespace motiongan;
using namespace motiongan::command;
using motiongan::testing::message_of;
using motiongan::testing::says;

namespace {

std::string refusal(const fs::path& file, const OutputKind& kind, const std::vector<fs::path>& inputs = {}) {
  return message_of([&] { check_output("--out", file, kind, inputs); });
}

void put(const fs::path& file, const std::string& text = "x") {
  if (file.has_parent_path()) fs::create_directories(file.parent_path());
  write_file(file, text);
}

}  // namespace

TEST_CASE("an output is no input, whatever it is called") {
  const TestFolder folder;
  put("clips/a.bvh");
  put("page");
  fs::create_symlink("page", "link");
  fs::create_hard_link("page", "hard");
  CHECK(
      says(refusal("page", page_output, {"other", "page"}), "--out: page is an input and would be replaced"));
  CHECK(says(refusal("clips/../page", page_output, {"page"}), "is an input"));
  CHECK(says(refusal("link", page_output, {"page"}), "is an input"));
  CHECK(says(refusal("hard", page_output, {"page"}), "is an input"));
  CHECK(refusal("page", page_output, {"clips", "", "missing"}) == "no error");
  CHECK(refusal("new.html", page_output, {"page"}) == "no error");
  CHECK(refusal("", page_output, {"page"}) == "no error");
  CHECK(refusal("/dev/null", table_output) == "no error");
  fs::create_symlink("nowhere", "dangling");
  CHECK(refusal("dangling", page_output) == "no error");
  CHECK(says(refusal("clips", page_output), "--out clips is a folder, expected the name of a file"));
}

TEST_CASE("an output does not end like another kind of file") {
  const TestFolder folder;
  CHECK(says(refusal("a.bvh", page_output), "--out a.bvh would be an HTML page, which cannot end in .bvh"));
  CHECK(says(refusal("a.BVH", page_output), "cannot end in .bvh; use .html, and give input files before"));
  CHECK(says(refusal("m.safetensors", table_output), "a table, which cannot end in .safetensors; use .csv"));
  CHECK(says(refusal("a.csv", json_output), "cannot end in .csv; use .json"));
  CHECK(says(refusal("a.html", picture_output), "cannot end in .html; use .png"));
  for (const char* name : {"a.html", "a.HTM", "a", "a.x", "a.2026"})
    CHECK(refusal(name, page_output) == "no error");
  CHECK(refusal("t.tsv", table_output) == "no error");
}

TEST_CASE("files in a folder of clips are inputs, results of earlier calls are not") {
  const TestFolder folder;
  put("clips/sub/a.bvh");
  put("clips/captions.json");
  put("clips/walk.csv", "frame,Hips.x,Hips.y,Hips.z\n0,1,2,3\n");
  put("clips/stats.csv", "joint,spread\nHips,1\n");
  put("clips/page.html");
  const std::vector<fs::path> inputs{"clips"};
  CHECK(says(refusal("clips/captions.json", json_output, inputs), "captions.json is an input"));
  CHECK(says(refusal("clips/walk.csv", table_output, inputs), "walk.csv is an input"));
  CHECK(refusal("clips/stats.csv", table_output, inputs) == "no error");
  CHECK(refusal("clips/page.html", page_output, inputs) == "no error");
  CHECK(refusal("clips/new.json", json_output, inputs) == "no error");
  const auto several = [&](const std::vector<fs::path>& files) {
    return message_of([&] { check_outputs("--out", files, inputs); });
  };
  CHECK(says(several({"b.bvh", "clips/sub/../sub/a.bvh"}), "a.bvh is an input and would be replaced"));
  CHECK(several({"a.bvh", "clips/b.bvh", "clips-2/a.bvh"}) == "no error");
  CHECK(says(several({"new/a.bvh", "new/b.bvh", "new/a.bvh"}), "two clips would be written as new/a.bvh"));
  CHECK(
      says(message_of([&] { check_output_folder("--out", "clips/sub/..", inputs); }), "is an input; choose"));
  CHECK(message_of([&] { check_output_folder("--out", "new", inputs); }) == "no error");
}

TEST_CASE("the command keeps clips that an option names by mistake") {
  const TestFolder folder;
  REQUIRE(call("synth clips --clips 2").status == 0);
  const std::string walk = bytes_of("clips/walk_000.bvh"), run = bytes_of("clips/run_001.bvh");
  const auto refused = [](const std::string& arguments, const std::string& part) {
    const Said said = call(arguments);
    CAPTURE(said.text);
    CHECK(said.status == 1);
    CHECK(said.has(part));
  };
  refused("view clips/walk_000.bvh --html clips/walk_000.bvh", "cannot end in .bvh");
  refused("view --html clips/walk_000.bvh clips/run_001.bvh", "give input files before the option");
  refused("view clips --png clips/walk_000.bvh", "cannot end in .bvh");
  refused("compare --generated clips --real clips --csv clips/walk_000.bvh", "cannot end in .bvh");
  refused("evaluate motion --generated clips --real clips --json clips/run_001.bvh", "cannot end in .bvh");
  refused("compare --generated clips --real clips --csv clips/captions.tsv", "captions.tsv is an input");
  fs::create_directory("others");
  fs::copy_file("clips/walk_000.bvh", "others/walk_000.bvh");
  refused("clean clips/walk_000.bvh others/walk_000.bvh --out cleaned",
          "two clips would be written as cleaned/walk_000.bvh");
  CHECK_FALSE(fs::exists("cleaned"));
  CHECK(bytes_of("clips/walk_000.bvh") == walk);
  CHECK(bytes_of("clips/run_001.bvh") == run);
}

TEST_CASE("lists of captions that somebody else wrote are kept") {
  const TestFolder folder;
  REQUIRE(call("synth clips --clips 2").status == 0);
  REQUIRE(call("synth clips --clips 3").status == 0);  // its own
  write_file("clips/captions.tsv", "walk_000\tmine\n");
  const Said said = call("synth clips --clips 2");
  CHECK(said.status == 1);
  CHECK(said.has("clips/captions.tsv exists, was not written by this command and would be replaced"));
  CHECK(bytes_of("clips/captions.tsv") == "walk_000\tmine\n");
}

TEST_CASE("a full disk is an error that leaves nothing behind") {
  const TestFolder folder;
  REQUIRE(call("synth clips --clips 2").status == 0);
  for (const std::string arguments :
       {"view clips --html out/page.html", "view clips --png out/poses.png", "synth out"}) {
    const Said said =
        shell("trap '' XFSZ; ulimit -f 2; '" + std::string(MOTIONGAN_COMMAND) + "' " + arguments);
    CAPTURE(said.text);
    CHECK(said.status == 1);
    CHECK(said.has("cannot write "));
    CHECK(said.has("is there free space?"));
    CHECK((!fs::exists("out") || fs::is_empty("out")));
  }
}

TEST_CASE("a link that leads to itself and a pipe are named, and end no call unexplained") {
  const TestFolder folder;
  const Said loop = shell("ln -s loop loop; '" + std::string(MOTIONGAN_COMMAND) + "' info loop");
  CHECK(loop.status == 1);
  CHECK(loop.has("motiongan: loop cannot be reached: "));
  const Said pipe =
      shell("mkfifo x.bvh; timeout 20 '" + std::string(MOTIONGAN_COMMAND) + "' view x.bvh --html p.html");
  CHECK(pipe.status == 1);
  CHECK(pipe.has("x.bvh is a named pipe, expected a regular file"));
}

}  // namespace outputs_test

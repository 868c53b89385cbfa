// BVH files with the faults that are common in practice: read with a note, or an error that says what to do.
#include <doctest/doctest.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "../support/messages.hpp"
#include "motiongan/formats/bvh.hpp"
#include "motiongan/motion/motion.hpp"

namespace bvh_tolerance_test {

using namespace motiongan;
using namespace motiongan::motion;
using motiongan::testing::message_of;
using motiongan::testing::says;

namespace {

const std::string header =
    "HIERARCHY\n"                                    // line 1
    "ROOT Hips\n"                                    // 2
    "{\n"                                            // 3
    "OFFSET 0 1 0\n"                                 // 4
    "CHANNELS 3 Xposition Zrotation Xrotation\n"     // 5
    "JOINT Arm\n"                                    // 6
    "{\n"                                            // 7
    "OFFSET 1 0 0\n"                                 // 8
    "CHANNELS 1 Yrotation\n"                         // 9
    "End Site\n{\nOFFSET 2 0 0\n}\n"                 // 10 to 13
    "}\n"                                            // 14
    "}\n"                                            // 15
    "MOTION\n"                                       // 16
    "Frames: 2\n"                                    // 17
    "Frame Time: 0.0333333\n";                       // 18
const std::string frames = "1 2 3 4\n5 6 7 -8.5\n";  // 19 and 20
const std::string whole = header + frames;

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  REQUIRE(text.find(what) != text.npos);
  for (std::size_t at = 0; (at = text.find(what, at)) != text.npos; at += with.size())
    text.replace(at, what.size(), with);
  return text;
}

Clip read(const std::string& text) { return parse_bvh(text, "a.bvh"); }

/// The clip's one note.
std::string note_of(const std::string& text) {
  const Clip clip = read(text);
  REQUIRE(clip.notes.size() == 1);
  return clip.notes[0];
}

std::string error_of(const std::string& text) {
  return message_of([&] { parse_bvh(text, "a.bvh"); });
}

const std::vector<double> values{1, 2, 3, 4, 5, 6, 7, -8.5};

}  // namespace

TEST_CASE("a sound file has no notes") {
  CHECK(read(whole).notes.empty());
  CHECK(read(whole).channels == values);
}

TEST_CASE("another number of frames than announced is read, with a note") {
  for (const char* const announced : {"0", "1", "3", "1000000000000", "18446744073709551615"}) {
    CAPTURE(announced);
    const std::string text = replaced(whole, "Frames: 2", concat("Frames: ", announced));
    const Clip clip = read(text);
    CHECK(clip.frames == 2);
    CHECK(clip.channels == values);
    CHECK(clip.channels.capacity() < 1000);
  }
  CHECK(note_of(replaced(whole, "Frames: 2", "Frames: 1")) ==
        "a.bvh:17: Frames: says 1, found 2 frames; all 2 are read");
  CHECK(note_of(replaced(whole, "Frames: 2", "Frames: 3")) ==
        "a.bvh:17: Frames: says 3, found only 2 frames; all 2 are read");
  CHECK(note_of(header + "1 2 3 4\n") == "a.bvh:17: Frames: says 2, found only 1 frame; it is read");
  CHECK(error_of(header) ==
        "a.bvh:19:1: found the end of the file, expected 2 frames as the line 'Frames:' says");
  CHECK(read(replaced(header, "Frames: 2", "Frames: 0")).notes.empty());
}

TEST_CASE("a file that is cut off keeps its complete frames") {
  for (const char* const last :
       {"9", "9 9", "9 9 9", "9 9 9 \n", "9 9 9 -", "9 9 9 1.5e", "9 9 9 1e-", "-", "9 9 9 +"}) {
    CAPTURE(last);
    const Clip clip = read(replaced(whole, "Frames: 2", "Frames: 3") + last);
    CHECK(clip.frames == 2);
    CHECK(clip.channels == values);
    REQUIRE(clip.notes.size() == 2);
    CHECK(clip.notes[0] == "a.bvh:17: Frames: says 3, found only 2 frames; all 2 are read");
    CHECK(clip.notes[1] ==
          "a.bvh:21: the last line is cut off: it does not hold the 4 values of a frame, and is ignored");
  }
  // Every cut within the second frame leaves the first, and every cut before it is an error.
  const std::size_t second = header.size() + 8;
  for (std::size_t n = 0; n <= whole.size(); ++n) {
    CAPTURE(n);
    const std::string text = whole.substr(0, n);
    if (n < second - 1)
      CHECK(error_of(text) != "no error");
    else
      CHECK(read(text).frames == (n > second + 7 ? 2 : 1));
  }
  CHECK(says(error_of(header + "1 2 3\n5 6 7 8\n"), "a.bvh:19:6: frame 1 has 3 values, expected 4"));
  CHECK(says(error_of(header + "1 2 3\n"), "a.bvh:19:6: frame 1 has 3 values, expected 4"));
  CHECK(says(error_of(header + "1 2 3 4\n5 6 7 -\n"), "a.bvh:20:7: found '-'"));
  CHECK(says(error_of(header + "1 2 3 4\n5 6 7 1e999"), "which is too large"));
  CHECK(says(error_of(header + "1 2 3 4\n5 6 nan"), "found 'nan'"));
}

TEST_CASE("LF, CRLF and CR end lines, and messages count them alike") {
  for (const char* const end : {"\n", "\r\n", "\r"}) {
    const std::string text = replaced(whole, "\n", end);
    const Clip clip = read(text);
    CHECK(clip.notes.empty());
    CHECK(clip.skeleton == read(whole).skeleton);
    CHECK(clip.channels == values);
    CHECK(says(error_of(replaced(text, "7 -8.5", "x -8.5")), "a.bvh:20:5: found 'x'"));
    CHECK(says(error_of(replaced(text, "1 2 3 4", "1 2 3")), "a.bvh:19:6: frame 1 has 3 values"));
    CHECK(says(error_of(replaced(text, "ROOT Hips", "ROOT")), "a.bvh:2:5: found no name"));
    CHECK(says(note_of(replaced(text, "Frames: 2", "Frames: 3")), "a.bvh:17: "));
  }
}

TEST_CASE("text after the frames is an error; NUL bytes and control-Z are ignored") {
  CHECK(error_of(whole + "END OF FILE\n") == "a.bvh:21:1: found 'END', expected the end of the file");
  CHECK(error_of(whole + whole) == "a.bvh:21:1: found 'HIERARCHY', expected the end of the file");
  CHECK(says(error_of(whole + "9 9 9 9\nEND\n"), "a.bvh:22:1: found 'END', expected the end of the file"));
  CHECK(
      says(error_of(whole + std::string("\0 x", 3)), "a.bvh:21:1: found '\?', expected the end of the file"));
  const std::string nul(3, '\0');
  CHECK(read(whole + nul + "\n").channels == values);
  CHECK(note_of(whole + nul + "\n") ==
        "a.bvh:21: the file ends in 3 NUL or control-Z bytes, which are ignored");
  CHECK(note_of(whole + "\r\n\x1A") ==
        "a.bvh:22: the file ends in 1 NUL or control-Z byte, which is ignored");
  CHECK(read(header + "1 2 3 4\n5 6 7" + nul).frames == 1);
  CHECK(says(error_of(nul), "a.bvh:1:1: found '\?\?\?', expected HIERARCHY"));
}

TEST_CASE("scale channels are read past") {
  const std::string one =
      replaced(replaced(whole, "CHANNELS 1 Yrotation", "CHANNELS 4 Yscale Yrotation Xscale ZSCALE"), " 4\n",
               " 9 4 9 9\n");
  const Clip clip = read(replaced(one, "-8.5", "9 -8.5 9 9"));
  CHECK(clip.skeleton == read(whole).skeleton);
  CHECK(clip.channels == values);
  REQUIRE(clip.notes.size() == 1);
  CHECK(clip.notes[0] ==
        "a.bvh:9: joint 'Arm' has scale channels; scale is not motion, so their values are ignored");
  CHECK(to_motion(clip).rotations == to_motion(read(whole)).rotations);

  const std::string both = replaced(replaced(whole, "CHANNELS 1 Yrotation", "CHANNELS 2 Yrotation Xscale"),
                                    "CHANNELS 3", "CHANNELS 4 Zscale");
  const std::string text = replaced(replaced(both, "1 2 3 4", "1 1 2 3 4 1"), "5 6 7 -8.5", "1 5 6 7 -8.5 1");
  CHECK(read(text).channels == values);
  CHECK(note_of(text) ==
        "a.bvh:5: 2 joints (the first is 'Hips') have scale channels; scale is not motion, "
        "so their values are ignored");
  const std::string nine =
      "CHANNELS 9 Xposition Yposition Zposition Zrotation Xrotation Yrotation Xscale Yscale Zscale";
  const std::string root =
      "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\n" + nine + "\n}\nMOTION\nFrames: 1\nFrame Time: 0.04\n";
  CHECK(read(root + "1 2 3 4 5 6 7 8 9").channels == std::vector<double>{1, 2, 3, 4, 5, 6});
  CHECK(says(error_of(root + "1 2 3 4 5 6"), "frame 1 has 6 values, expected 9"));
  CHECK(says(error_of(replaced(root, nine, "CHANNELS 1 Xscale") + "1"), "has no channels but 1 frames"));
  CHECK(says(error_of(replaced(replaced(root, nine, "CHANNELS 0"), "s: 1", "s: 0") + "1"),
             "a.bvh:10:1: found '1', expected the end of the file: the skeleton has no channels"));
}

TEST_CASE("frame times that look like another unit, or are rounded") {
  const auto note = [](const std::string& time) { return note_of(replaced(whole, "0.0333333", time)); };
  CHECK(note("30") ==
        "a.bvh:18: a frame time of 30 s makes this clip last 60 s; if it is meant as 30 frames per "
        "second, give --fps 30");
  CHECK(read(replaced(whole, "0.0333333", "30")).frame_time == 30);
  CHECK(says(note("120"),
             "makes this clip last 4 min; if it is meant as 120 frames per second, give --fps 120"));
  CHECK(says(note("3600"), "makes this clip last 2 h"));
  CHECK(says(note("29.97"), "if it is meant as 29.97 frames per second, give --fps 29.97"));
  CHECK(says(note("33.3333"), "if it is meant in milliseconds, give --fps 30"));
  CHECK(says(note("8.333"), "if it is meant in milliseconds, give --fps 120"));
  CHECK(note("1") ==
        "a.bvh:18: a frame time of 1 s is 1 frame per second and makes this clip last 2 s; if "
        "another rate is meant, give it with --fps");
  CHECK(says(note("0.0005"),
             "a frame time of 0.0005 s is 2000 frames per second and makes this clip last 0.001 s"));
  CHECK(says(note("0.000002"), "is 500000 frames per second"));
  CHECK(says(error_of(replaced(whole, "0.0333333", "0.0000001")), "expected at least 0.000001"));
  CHECK(note("0.0333") ==
        "a.bvh:18: frame time 0.0333 s is read as 30 frames per second (1/30 s to 4 decimals)");
  CHECK(to_motion(read(replaced(whole, "0.0333333", "0.0333"))).rate == 30);
  for (const char* const sound : {"0.001", "0.0083333", "0.5", "0.04", "0.999"})
    CHECK(read(replaced(whole, "0.0333333", sound)).notes.empty());
}

TEST_CASE("joints of one name get numbers") {
  const auto file = [](const std::vector<std::string>& names) {
    std::string text = "HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n";
    for (const std::string& name : names) text += concat("JOINT ", name, "\n{\nOFFSET 0 1 0\n}\n");
    return text + "}\nMOTION\nFrames: 1\nFrame Time: 0.04\n1\n";
  };
  const Clip two = read(file({"Prop", "Prop"}));
  CHECK(two.skeleton.joints[1].name == "Prop");
  CHECK(two.skeleton.joints[2].name == "Prop_2");
  REQUIRE(two.notes.size() == 1);
  CHECK(two.notes[0] == "a.bvh:10: found a second joint called 'Prop'; it is renamed to 'Prop_2'");
  // Names that are unique in the file stay.
  const Clip more = read(file({"Prop", "Prop", "Prop_2", "Hips", "Prop"}));
  std::vector<std::string> names;
  for (const Joint& j : more.skeleton.joints) names.push_back(j.name);
  CHECK(names == std::vector<std::string>{"Hips", "Prop", "Prop_3", "Prop_2", "Hips_2", "Prop_4"});
  REQUIRE(more.notes.size() == 1);
  CHECK(more.notes[0] ==
        "a.bvh:10: found 3 joints with the name of an earlier joint; they are renamed, the "
        "first from 'Prop' to 'Prop_3'");
  const Clip many = read(file(std::vector<std::string>(20000, "x")));
  CHECK(many.skeleton.joints.back().name == "x_20000");
  CHECK(many.notes.size() == 1);
}

TEST_CASE("End Sites with a name, and more than one") {
  for (const char* const site : {"End Site Toe_End", "End site \"x\"", "END SITE  a b\t"}) {
    for (const char* const brace : {"\n{\n", " {\n", " { "}) {
      const Clip clip = read(replaced(whole, "End Site\n{\n", concat(site, brace)));
      CHECK(clip.skeleton == read(whole).skeleton);
      CHECK(clip.notes.empty());
    }
  }
  const std::string more = "End Site\n{\nOFFSET 9 9 9\n}\n";
  const std::string text = replaced(whole, "OFFSET 2 0 0\n}\n", "OFFSET 2 0 0\n}\n" + more + more);
  CHECK(read(text).skeleton == read(whole).skeleton);
  CHECK(note_of(text) == "a.bvh:14: joint 'Arm' has more than one End Site; only the first is kept");
  CHECK(says(error_of(replaced(whole, "End Site\n{", "End Site Toe\n")),
             "found 'OFFSET', expected { after End Site"));
}

TEST_CASE("a second ROOT is an error that says what to do") {
  CHECK(says(error_of(replaced(whole, "}\nMOTION", "}\nROOT Dog\n{\nOFFSET 0 0 0\n}\nMOTION")),
             "a.bvh:16:1: found a second ROOT, expected MOTION: split the file into one file per skeleton"));
}

TEST_CASE("empty files and dead links are called that") {
  namespace fs = std::filesystem;
  const fs::path folder =
      fs::temp_directory_path() / ("motiongan_bvh_tolerance_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  write_text_atomically(folder / "empty.bvh", "");
  fs::create_symlink("gone.bvh", folder / "dead.bvh");
  write_text_atomically(folder / "walk.bvh", replaced(whole, "Frames: 2", "Frames: 3"));
  const auto error = [&](const char* name) { return message_of([&] { read_bvh(folder / name); }); };
  CHECK(error("empty.bvh") == (folder / "empty.bvh").string() + " is empty, expected a BVH file");
  CHECK(error("dead.bvh") == "BVH file " + (folder / "dead.bvh").string() + " is a dead link (to gone.bvh)");
  CHECK(error("none.bvh") == "BVH file " + (folder / "none.bvh").string() + " does not exist");
  CHECK(says(error("walk.bvh/x.bvh"), "does not exist"));
  CHECK(read_text(folder / "empty.bvh", "caption file").empty());
  const Clip walk = read_bvh(folder / "walk.bvh");
  CHECK(walk.id == "walk");
  REQUIRE(walk.notes.size() == 1);
  CHECK(walk.notes[0].starts_with((folder / "walk.bvh").string() + ":17: Frames: says 3"));
  fs::remove_all(folder);
}

}  // namespace bvh_tolerance_test

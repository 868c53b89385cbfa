// BVH reading and writing: unusual but valid files, broken files and their messages, and round trips.
#include "motiongan/formats/bvh.hpp"

#include <doctest/doctest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "../support/folders.hpp"
#include "motiongan/motion/motion.hpp"

namespace bvh_test {

using namespace motiongan;
using namespace motiongan::motion;

namespace {

const std::string arm =
    "HIERARCHY\n"                                                                 // line 1
    "ROOT Hips\n"                                                                 // 2
    "{\n"                                                                         // 3
    "  OFFSET 0 1.5 -2e0\n"                                                       // 4
    "  CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation\n"  // 5
    "  JOINT Arm\n"                                                               // 6
    "  {\n"                                                                       // 7
    "    OFFSET 1 0 0\n"                                                          // 8
    "    CHANNELS 1 Zrotation\n"                                                  // 9
    "    End Site\n"                                                              // 10
    "    {\n"                                                                     // 11
    "      OFFSET 2 0 0\n"                                                        // 12
    "    }\n"                                                                     // 13
    "  }\n"                                                                       // 14
    "}\n"                                                                         // 15
    "MOTION\n"                                                                    // 16
    "Frames: 2\n"                                                                 // 17
    "Frame Time: 0.0333333\n"                                                     // 18
    "1 2 3 10 20 30 40\n"                                                         // 19
    "1.5 -2.25 3e-1 0 0 0.000001 -179.999999\n";                                  // 20

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  for (std::size_t at = 0; (at = text.find(what, at)) != text.npos; at += with.size())
    text.replace(at, what.size(), with);
  return text;
}

std::string first_replaced(std::string text, const std::string& what, const std::string& with) {
  const std::size_t at = text.find(what);
  REQUIRE(at != text.npos);
  return text.replace(at, what.size(), with);
}

}  // namespace

TEST_CASE("a small file is read as written") {
  const Clip clip = parse_bvh(arm, "arm");
  CHECK(clip.id == "arm");
  CHECK(clip.skeleton.size() == 2);
  CHECK(clip.skeleton.joints[0].offset == Vec3{0, 1.5, -2});
  CHECK(clip.skeleton.joints[1].name == "Arm");
  CHECK(clip.skeleton.joints[1].parent == 0);
  CHECK(clip.skeleton.joints[1].channels == std::vector<Channel>{Channel::z_rotation});
  CHECK(*clip.skeleton.joints[1].end_site == Vec3{2, 0, 0});
  CHECK(clip.frames == 2);
  CHECK(clip.frame_time == 0.0333333);
  CHECK(clip.channels ==
        std::vector<double>{1, 2, 3, 10, 20, 30, 40, 1.5, -2.25, 0.3, 0, 0, 0.000001, -179.999999});
}

TEST_CASE("the same clip in other formatting") {
  const Clip clip = parse_bvh(arm, "arm");
  std::string upper = arm, lower = arm;
  for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
  lower = replaced(replaced(lower, "hips", "Hips"), "arm", "Arm");
  for (const char* word : {"Root", "Joint", "End Site", "Frames", "Frame Time", "Xposition", "Zrotation"}) {
    std::string capital = word;
    for (char& c : capital) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c;
    upper = replaced(upper, word, capital);
  }
  const std::vector<std::string> dresses{
      replaced(arm, "\n", "\r\n"),
      replaced(arm, " ", "\t"),
      replaced(arm, " ", "  \t "),
      replaced(arm, "\n", " \n"),
      replaced(arm, "\n", "\n\n"),
      arm.substr(0, arm.size() - 1),
      arm + "\n\r\n  \n",
      "\xEF\xBB\xBF" + arm,
      lower,
      upper,
      replaced(arm, "\n  {", " {"),
      replaced(arm, "Arm\n  {", "Arm{"),
      replaced(arm, "Frames:", "Frames :"),
      replaced(arm, "Frames: 2", "Frames:2"),
      replaced(arm, " 10 20 30 ", " +10 2.0e+1 3E1 "),
      replaced(replaced(replaced(arm, "End Site\n    {\n      ", "End Site {"), "2 0 0\n    }\n  }\n}",
                        "2 0 0}}}"),
               "1 0 0\n", "1 0 0 ")};
  for (std::size_t i = 0; i < dresses.size(); ++i) {
    CAPTURE(dresses[i]);
    Clip same;
    REQUIRE_NOTHROW(same = parse_bvh(dresses[i], "arm"));
    CHECK(same.skeleton == clip.skeleton);
    CHECK(same.channels == clip.channels);
    CHECK(same.frame_time == clip.frame_time);
  }
}

TEST_CASE("a file may leave out end sites, channels and frames, and mix orders") {
  const Clip clip = parse_bvh(
      "HIERARCHY\nROOT a\n{\nCHANNELS 2 Yrotation Zposition\nOFFSET 0 0 0\nJOINT b c:d_\xC3\xA9 "
      "[x]\n{\nOFFSET 1 2 3\n"
      "JOINT e\n{\nOFFSET 0 0 1\nCHANNELS 0\n}\n}\nJOINT f\n{\nOFFSET 0 0 1\nCHANNELS 3 Zrotation Xrotation "
      "Zrotation\n"
      "}\n}\nMOTION\nFrames: 1\nFrame Time: 1\n1e-400 2 3 4 -0.0",
      "x");
  REQUIRE(clip.skeleton.size() == 4);
  CHECK(clip.skeleton.joints[1].name == "b c:d_\xC3\xA9 [x]");
  CHECK(clip.skeleton.joints[1].channels.empty());
  CHECK(!clip.skeleton.joints[2].end_site);
  CHECK(clip.skeleton.joints[3].parent == 0);
  CHECK(clip.channels == std::vector<double>{0, 2, 3, 4, 0});
  CHECK(parse_bvh(format_bvh(clip), "x").skeleton == clip.skeleton);
  const Motion motion = to_motion(clip);
  CHECK(motion.position(0, 0) == Vec3{0, 0, 2});
  CHECK(motion.rotation(0, 1) == Quat{});
  CHECK(motion.position(0, 1) == Vec3{1, 2, 3});
  const std::string none = first_replaced(arm.substr(0, arm.find("1 2 3 10")), "Frames: 2", "Frames: 0");
  CHECK(parse_bvh(none, "x").frames == 0);
}

TEST_CASE("broken files: the place, what was found, what was expected") {
  struct Case {
    std::string what, with;
    const char* place;
    std::vector<const char*> says;
  };
  const std::vector<Case> cases{
      {"HIERARCHY", "HIERACHY", ":1:1:", {"found 'HIERACHY'", "expected HIERARCHY"}},
      {"ROOT", "JOINT", ":2:1:", {"found 'JOINT'", "expected ROOT"}},
      {"ROOT Hips", "ROOT", ":2:5:", {"no name"}},
      {"ROOT Hips\n{", "ROOT Hips\n", ":4:3:", {"found 'OFFSET'", "expected {", "'Hips'"}},
      {"OFFSET 0 1.5 -2e0", "", ":15:1:", {"'Hips'", "without OFFSET"}},
      {"OFFSET 0 1.5 -2e0", "OFFSET 0 1.5", ":5:3:", {"found 'CHANNELS'", "the z of an OFFSET"}},
      {"OFFSET 1 0 0", "OFFSET 1 0 0\n    OFFSET 1 0 0", ":9:5:", {"second OFFSET"}},
      {"1.5 -2e0", "1,5 -2e0", ":4:12:", {"found '1,5'", "the y of an OFFSET"}},
      {"CHANNELS 6", "CHANNELS 10", ":5:12:", {"10 channels", "at most 9"}},
      {"CHANNELS 6", "CHANNELS 7", ":6:3:", {"found 'JOINT'", "channel 7 of 7"}},
      {"6 Xposition Yposition", "7 Xscale Xscale Yposition", ":5:21:", {"'Xscale' a second time", "scale"}},
      {"CHANNELS 6", "CHANNELS 5", ":5:64:", {"found 'Xrotation'", "only 5 channels"}},
      {"CHANNELS 1", "CHANNELS 2", ":10:5:", {"found 'End'", "channel 2 of 2", "'Arm'"}},
      {"CHANNELS 1", "CHANNELS -1", ":9:14:", {"found '-1'", "number of channels"}},
      {"CHANNELS 1", "CHANNELS one", ":9:14:", {"found 'one'", "number of channels"}},
      {"Yposition", "Xposition", ":5:24:", {"'Xposition' a second time"}},
      {"Xposition Yposition Zposition", "Xrotation Xrotation Zposition", ":5:54:", {"fourth rotation"}},
      {"1 Zrotation", "1 Wrotation", ":9:16:", {"found 'Wrotation'", "Zrotation"}},
      {"JOINT Arm",
       "JIONT Arm",
       ":6:3:",
       {"found 'JIONT'", "expected OFFSET, CHANNELS, JOINT, End Site or }"}},
      {"End Site", "End Seat", ":10:9:", {"found 'Seat'", "expected Site"}},
      {"OFFSET 2 0 0", "CHANNELS 0", ":12:7:", {"found 'CHANNELS'", "expected OFFSET"}},
      {"}\nMOTION", "MOTION", ":15:1:", {"found 'MOTION' in joint 'Hips'"}},
      {"}\nMOTION", "}\nROOT Dog\n{\n", ":16:1:", {"second ROOT"}},
      {"MOTION", "MOTIONS", ":16:1:", {"found 'MOTIONS'", "expected MOTION"}},
      {"Frames:", "Frame:", ":17:1:", {"expected 'Frames:'"}},
      {"Frames: 2", "Frames: -2", ":17:9:", {"found '-2'", "number of frames"}},
      {"Frames: 2", "Frames: 2.5", ":17:9:", {"found '2.5'"}},
      {"Frames: 2", "Frames: 99999999999999999999999", ":17:9:", {"number of frames"}},
      {"Frame Time:", "FrameTime", ":18:1:", {"expected 'Frame Time:'"}},
      {"0.0333333", "0", ":18:13:", {"frame time of 0 "}},
      {"0.0333333", "-0.04", ":18:13:", {"frame time of -0.04"}},
      {"0.0333333", "nan", ":18:13:", {"found 'nan'", "finite"}},
      {"0.0333333", "0.03 s", ":18:18:", {"found 's'", "end of the line"}},
      {"1 2 3 10 20 30 40", "1 2 3 10 20 30", ":19:15:", {"frame 1 has 6 values, expected 7"}},
      {"1 2 3 10 20 30 40", "1 2 3 10 20 30 40 50 60", ":19:19:", {"frame 1 has 9 values, expected 7"}},
      {"1 2 3 10", "1 2 nan 10", ":19:5:", {"found 'nan'", "finite number"}},
      {"1 2 3 10", "1 2 inf 10", ":19:5:", {"found 'inf'"}},
      {"1 2 3 10", "1 2 -Infinity 10", ":19:5:", {"found '-Infinity'"}},
      {"1 2 3 10", "1 2 1e999 10", ":19:5:", {"found '1e999'", "too large"}},
      {"1 2 3 10", "1 2 3x 10", ":19:5:", {"found '3x'"}},
      {"1 2 3 10", "1 2 0x3 10", ":19:5:", {"found '0x3'"}},
      {"1 2 3 10", "1 2 +-3 10", ":19:5:", {"found '+-3'"}},
      {"1 2 3 10", "1 2 } 10", ":19:5:", {"found '}'"}},
      {"1 2 3 10", std::string("1 2 \x01\x02 10"), ":19:5:", {"found '\?\?'"}}};
  for (const Case& c : cases) {
    const std::string text = first_replaced(arm, c.what, c.with);
    CAPTURE(c.what);
    CAPTURE(c.with);
    std::string message;
    try {
      parse_bvh(text, "a b.bvh");
    } catch (const Error& e) {
      message = e.what();
    }
    CAPTURE(message);
    CHECK(message.starts_with(std::string("a b.bvh") + c.place));
    for (const char* word : c.says) CHECK(message.find(word) != message.npos);
  }
}

TEST_CASE("a file truncated before a frame is an error, never a crash; so is any single corrupted byte") {
  const std::size_t first_frame = arm.find("30 40\n") + 4;  // with one digit of its last value
  for (std::size_t n = 0; n < first_frame; ++n) {
    CAPTURE(n);
    CHECK_THROWS_AS(parse_bvh(arm.substr(0, n), "cut"), Error);
  }
  std::size_t errors = 0;
  for (std::size_t n = 0; n < arm.size(); ++n) {
    for (const char c : {'{', '}', '\0', '\n', '\xFF', '9', 'e', '-', '.'}) {
      std::string text = arm;
      text[n] = c;
      try {
        const Clip clip = parse_bvh(text, "x");
        CHECK(clip.channels.size() == clip.frames * clip.skeleton.channel_count());
      } catch (const Error&) {
        ++errors;
      }
    }
  }
  CHECK(errors > arm.size());
}

TEST_CASE("deep nesting is an error that names the joint, not a crash") {
  std::string text = "HIERARCHY\nROOT j\n{\nOFFSET 0 0 0\n";
  for (int i = 0; i < 100000; ++i) text += "JOINT j" + std::to_string(i) + "\n{\nOFFSET 0 0 0\n";
  CHECK_THROWS_WITH_AS(parse_bvh(text, "deep"), doctest::Contains("nested 1001 deep"), Error);
  // The maximum depth works, for writing and reading.
  Skeleton chain;
  for (int i = 0; i < 1000; ++i) chain.joints.push_back({"j" + std::to_string(i), i - 1, {0, 1, 0}, {}, {}});
  CHECK(parse_hierarchy(format_hierarchy(chain), "chain") == chain);
}

TEST_CASE("a million braces and other rubbish") {
  for (const std::string& rubbish :
       {std::string(1000000, '{'), std::string(1000000, '\n'), std::string(1000, '\0'),
        "HIERARCHY\nROOT " + std::string(1000000, '{'), std::string()})
    CHECK_THROWS_AS(parse_bvh(rubbish, "x"), Error);
  CHECK_THROWS_WITH_AS(parse_bvh("", "x"), doctest::Contains("x:1:1: found the end of the file"), Error);
  CHECK_THROWS_WITH_AS(parse_bvh(std::string(1000, 'a'), "x"), doctest::Contains("aaa...'"), Error);
}

TEST_CASE("write, read, write: the same text and the same numbers") {
  Clip clip = parse_bvh(arm, "arm");
  clip.channels = {0.1, 1.0 / 3, -1e-7, 1e-300, 123456789.125, -0.0, 5e-324, 1e20, 2,
                   3,   4,       5,     6,      -359.999999};
  clip.frame_time = 1.0 / 120;
  clip.skeleton.joints[1].offset = {1.0 / 7, 1e-9, -3};
  const std::string text = format_bvh(clip);
  const Clip again = parse_bvh(text, "arm");
  CHECK(again.skeleton == clip.skeleton);
  CHECK(again.channels == clip.channels);
  CHECK(again.frame_time == clip.frame_time);
  CHECK(format_bvh(again) == text);
  CHECK(text.find("e-") == text.npos);
  CHECK(parse_hierarchy(format_hierarchy(clip.skeleton), "h") == clip.skeleton);
  CHECK_THROWS_WITH_AS(parse_hierarchy(format_hierarchy(clip.skeleton) + "MOTI", "h"),
                       doctest::Contains("h:16:1"), Error);
}

TEST_CASE("files are written atomically and read back, and errors name the path") {
  namespace fs = std::filesystem;
  const fs::path folder = fs::temp_directory_path() / ("motiongan_bvh_test_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  Clip clip = parse_bvh(replaced(arm, "\n", "\r\n"), "arm");
  write_bvh(folder / "walk 1.bvh", clip);
  const Clip again = read_bvh(folder / "walk 1.bvh");
  CHECK(again.id == "walk 1");
  CHECK(again.channels == clip.channels);
  CHECK_FALSE(testing::has_unfinished(folder));

  write_bvh(folder / "motion.bvh", to_motion(clip));
  const Clip motion = read_bvh(folder / "motion.bvh");
  CHECK(motion.skeleton == clip.skeleton);
  for (std::size_t i = 0; i < clip.channels.size(); ++i) {
    CHECK(std::abs(std::remainder(motion.channels[i] - clip.channels[i], 360.0)) < 1e-6);
    CHECK(motion.channels[i] == std::round(motion.channels[i] * 1e6) / 1e6);  // six decimals
  }
  const Motion there = to_motion(motion);
  write_bvh(folder / "again.bvh", there);
  CHECK(read_bvh(folder / "again.bvh").channels == motion.channels);

  clip.channels[3] = std::nan("");
  CHECK_THROWS_WITH_AS(write_bvh(folder / "walk 1.bvh", clip), doctest::Contains("frame 1, channel 4"),
                       Error);
  CHECK(read_bvh(folder / "walk 1.bvh").channels == again.channels);  // the old file is unchanged
  CHECK_THROWS_WITH_AS(read_bvh(folder / "none.bvh"), doctest::Contains("does not exist"), Error);
  CHECK_THROWS_WITH_AS(read_bvh(folder), doctest::Contains("is a folder"), Error);
  CHECK_THROWS_WITH_AS(write_bvh(folder / "no" / "x.bvh", again), doctest::Contains("does the folder exist"),
                       Error);
  fs::remove_all(folder);
}

TEST_CASE("skeletons that BVH cannot hold are rejected") {
  Skeleton s = parse_bvh(arm, "arm").skeleton;
  for (const char* name : {"", " a", "a ", "a\nb", "a\rb", "{a", "a{", "a {b"}) {
    s.joints[1].name = name;
    CHECK_THROWS_WITH_AS(format_hierarchy(s), doctest::Contains("cannot be written as BVH"), Error);
  }
  s.joints[1].name = "x{y}";
  CHECK(parse_hierarchy(format_hierarchy(s), "h") == s);
  s.joints[1].parent = -1;
  CHECK_THROWS_WITH_AS(format_hierarchy(s), doctest::Contains("depth-first"), Error);
  CHECK_THROWS_AS(format_hierarchy(Skeleton{}), Error);
}

}  // namespace bvh_test

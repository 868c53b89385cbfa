// Positions as CSV and NPY: known values, round trips, and errors.
#include "motiongan/formats/position_files.hpp"

#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "../support/messages.hpp"

namespace position_files_test {

using namespace motiongan;
using namespace motiongan::motion;
using motiongan::testing::message_of;
using motiongan::testing::says;
namespace fs = std::filesystem;

namespace {

/// A temporary folder, removed at the end.
struct Folder {
  fs::path path =
      fs::temp_directory_path() / ("motiongan_position_files_" + std::to_string(std::uintptr_t(this)));
  Folder() {
    fs::remove_all(path);
    fs::create_directories(path);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() { fs::remove_all(path); }
};

const char* const leg = "# a leg\nHip\t-\r\n\nKnee\tHip\nToe.Tip\tKnee\n";

/// Three frames of the leg in which all values are distinct.
PositionClip leg_clip() {
  PositionClip clip;
  clip.skeleton = parse_bone_list(leg, "leg");
  clip.rate = 30;
  clip.frames = 3;
  for (int i = 0; i < 9; ++i) clip.positions.push_back({0.1 * i, 1.0 / 3 + 7 * i * i, -1e-3 * i});
  return clip;
}

/// An .npy file with this header and these bytes.
std::string npy(const std::string& dictionary, const std::string& data, int version = 1) {
  std::string out = "\x93NUMPY";
  out += static_cast<char>(version);
  out += '\0';
  out += static_cast<char>(dictionary.size());
  out.append(version == 1 ? 1 : 3, '\0');
  return out + dictionary + data;
}

template <class Raw>
void append_raw(std::string& out, Raw raw, bool big) {
  for (std::size_t i = 0; i < sizeof raw; ++i)
    out += static_cast<char>(static_cast<unsigned char>(raw >> (8 * (big ? sizeof raw - 1 - i : i))));
}

/// Numbers 1, 2, 3, ... as they would be laid out in a file.
std::string numbers(std::size_t count, bool single, bool big) {
  std::string out;
  for (std::size_t i = 0; i < count; ++i) {
    if (single)
      append_raw(out, std::bit_cast<std::uint32_t>(static_cast<float>(i + 1)), big);
    else
      append_raw(out, std::bit_cast<std::uint64_t>(static_cast<double>(i + 1)), big);
  }
  return out;
}

}  // namespace

TEST_CASE("a bone list names joints and parents") {
  const Skeleton s = parse_bone_list(leg, "leg");
  REQUIRE(s.size() == 3);
  CHECK(s.joints[0].parent == -1);
  CHECK(s.joints[1].name == "Knee");
  CHECK(s.joints[2].parent == 1);
  const Folder folder;
  write_bone_list(folder.path / "bones.tsv", s);
  CHECK(read_bone_list(folder.path / "bones.tsv") == s);

  const auto wrong = [](const char* text) { return message_of([&] { parse_bone_list(text, "f"); }); };
  CHECK(says(wrong("Hip -\n"), "f:1: found no tab in 'Hip -'"));
  CHECK(says(wrong("Hip\t-\nHip\tHip\n"), "f:2: joint 'Hip' is listed twice"));
  CHECK(says(wrong("Hip\t-\n\nToe\tKnee\nKnee\tHip\n"),
             "f:3: joint 'Toe' has the parent 'Knee', which no line above"));
  CHECK(says(wrong("Hip\t-\nTail\t-\n"), "f:2: found a second root, 'Tail'"));
  CHECK(says(wrong("Hip\tHip\n"), "f:1: joint 'Hip' has the parent 'Hip'"));
  CHECK(says(wrong("Hip\t\n"), "f:1: joint 'Hip' has the parent ''"));
  CHECK(says(wrong("\t-\n"), "f:1: found ''"));
  CHECK(says(wrong("# nothing\n"), "f: found no joints"));
  std::string many = "j0\t-\n", columns;
  for (std::size_t j = 1; j < most_joints; ++j) many += concat("j", j, "\tj", j - 1, "\n");
  CHECK(wrong(many.c_str()) == "no error");
  CHECK(says(wrong((many + "last\tj0\n").c_str()), "f:10001: found more than 10000 joints"));
  for (std::size_t j = 0; j <= most_joints; ++j) columns += concat("j", j, ".x,");
  CHECK(says(message_of([&] { joints_without_bones(columns, false, "c"); }),
             "c:1: found columns of 10001 joints, expected at most 10000"));
  Skeleton odd = s;
  odd.joints[1].name = "left\vKnee";  // a blank of the reader, but within the name
  write_bone_list(folder.path / "bones.tsv", odd);
  CHECK(read_bone_list(folder.path / "bones.tsv") == odd);
  odd.joints[1].name = "#Knee";
  CHECK(says(message_of([&] { write_bone_list(folder.path / "odd.tsv", odd); }),
             "a joint called '#Knee' cannot be written"));
  CHECK_FALSE(fs::exists(folder.path / "odd.tsv"));
}

TEST_CASE("offsets are the first frame's directions and the mean lengths") {
  Skeleton s = parse_bone_list("A\t-\nB\tA\nC\tB\nD\tA\n", "s");
  s.joints[0].offset = {9, 9, 9};
  const std::vector<Vec3> positions{{1, 1, 1}, {3, 1, 1}, {3, 1, 1}, {1, 1, 1},   // AB along x, 2 long
                                    {0, 0, 0}, {0, 4, 0}, {0, 4, 0}, {0, 0, 6}};  // along y, 4 long
  s = with_offsets_of(s, positions);
  CHECK(s.joints[0].offset == Vec3{0, 0, 0});
  CHECK(s.joints[1].offset == Vec3{3, 0, 0});
  CHECK(s.joints[2].offset == Vec3{0, 0, 0});  // C always coincides with B
  CHECK(s.joints[3].offset == Vec3{0, 0, 3});  // D has a direction only in the second frame
  CHECK_THROWS_AS(with_offsets_of(s, std::vector<Vec3>(5)), Error);
  CHECK_THROWS_AS(with_offsets_of(s, {}), Error);
}

TEST_CASE("CSV: columns in any order, times, CRLF") {
  const Skeleton s = parse_bone_list("A\t-\nB\tA\n", "s");
  const PositionClip clip = parse_position_csv(
      "\xEF\xBB\xBFtime, B.z,B.x,B.y,A.x,A.y,A.z\r\n1.000,6,4,5,1,2,3\r\n1.033,+7,4,5,-1e0,2,3\r\n"
      "1.067,8,4,5,1,2,3\r\n\n",
      s, 0, "c");
  CHECK(clip.frames == 3);
  CHECK(clip.rate == doctest::Approx(2 / 0.067));
  REQUIRE(clip.positions.size() == 6);
  CHECK(clip.positions[0] == Vec3{1, 2, 3});
  CHECK(clip.positions[1] == Vec3{4, 5, 6});
  CHECK(clip.positions[2] == Vec3{-1, 2, 3});
  CHECK(clip.positions[5] == Vec3{4, 5, 8});
  CHECK(parse_position_csv("A.x,A.y,A.z,B.x,B.y,B.z\n1,2,3,4,5,6", s, 25, "c").rate == 25);
  CHECK(parse_position_csv("time,A.x,A.y,A.z,B.x,B.y,B.z\n0,1,2,3,4,5,6\n0.008333,1,2,3,4,5,6", s, 25, "c")
            .rate == 120);
}

TEST_CASE("CSV: semicolons and tabs as separators, and the line ends of old programs") {
  const Skeleton s = parse_bone_list("A\t-\nB\tA\n", "s");
  const std::string text = "time,A.x,A.y,A.z,B.x,B.y,B.z\n0,1,2,3,4,5,6.5\n0.04,1,2,3,4,5,7\n";
  const PositionClip clip = parse_position_csv(text, s, 0, "c");
  for (const char separator : {';', '\t'}) {
    std::string other = text;
    for (char& c : other)
      if (c == ',') c = separator;
    const PositionClip same = parse_position_csv(other, s, 0, "c");
    CHECK(same.rate == 25);
    CHECK(same.positions == clip.positions);
    const std::size_t at = other.find("6.5");
    other[at + 1] = ',';
    CHECK(message_of([&] { parse_position_csv(other, s, 0, "c"); }) ==
          "c:2: found '6,5' in column 7 (joint 'B'), expected a finite number with a decimal point, not a "
          "decimal comma: write 1.5, not 1,5");
  }
  std::string mac = text;
  for (char& c : mac)
    if (c == '\n') c = '\r';
  CHECK(parse_position_csv(mac, s, 0, "c").positions == clip.positions);
}

TEST_CASE("a position file is told from a log by its first line") {
  for (const char* const text : {"time,Hips.x,Hips.y,Hips.z\n0,0,90,0\n", "A.x,A.y,A.z",
                                 "\xEF\xBB\xBF"
                                 "A.z;A.y;A.x\r\n",
                                 "A.x\tA.y\tA.z\r1", "time,a.b.x,a.b.y,a.b.z,extra\n"})
    CHECK(is_position_csv(text));
  for (const char* const text : {"", "\n", "iteration,loss,critic_loss\n1,2,3\n", "time,A.x,A.y\n", "x,y,z\n",
                                 ".x,.y,.z\n", "iteration\nA.x,A.y,A.z\n", "a,b,c,d,e,f,A.x,A.y,A.z\n"})
    CHECK_FALSE(is_position_csv(text));
}

TEST_CASE("invalid CSV is an error with its line") {
  const Skeleton s = parse_bone_list("A\t-\nB\tA\n", "s");
  const std::string header = "A.x,A.y,A.z,B.x,B.y,B.z\n";
  const auto wrong = [&](const std::string& text, double rate = 30) {
    return message_of([&] { parse_position_csv(text, s, rate, "c"); });
  };
  CHECK(says(wrong("A.x,A.y,A.z,B.x,B.y\n1,2,3,4,5\n"), "c:1: the column 'B.z' is missing"));
  CHECK(says(wrong("A.x,A.y,A.z,B.x,B.y,B.z,B.x\n"), "c:1: the column 'B.x' appears twice"));
  CHECK(says(wrong("A.x,A.y,A.z,B.x,B.y,B.z,C.x\n"), "c:1: column 7 is for joint 'C'"));
  CHECK(says(wrong("A.x,A.y,A.w\n"), "c:1: column 3 is called 'A.w'"));
  CHECK(says(wrong(""), "c:1: column 1 is called ''"));
  CHECK(says(wrong(header), "c: found no frames"));
  CHECK(says(wrong(header + "1,2,3,4,5,6\n1,2,3,4,5\n"), "c:3: found 5 fields, expected 6"));
  CHECK(says(wrong(header + "1,2,3,4,5,nan\n"), "c:2: found 'nan' in column 6 (joint 'B')"));
  CHECK(says(wrong(header + "1,2,3,4,1e999,6\n"), "c:2: found '1e999' in column 5"));
  CHECK(says(wrong(header + "1,2,,4,5,6\n"), "c:2: found '' in column 3 (joint 'A')"));
  CHECK(says(wrong(header + "1,2,3,4,5,6\n", 0), "the rate is 0"));
  CHECK(says(wrong(header + "1,2,3,4,5,6\n", 0), "--rate or --fps on the command line"));
  CHECK(says(wrong("time," + header + "0,1,2,3,4,5,6\n", 0),
             "the rate is 0"));  // a single frame has no time step
  const std::string row = ",1,2,3,4,5,6\n";
  CHECK(says(wrong("time," + header + "0" + row + "0.1" + row + "0.3" + row), "c:3: the time is 0.1 s"));
  CHECK(says(wrong("time," + header + "1" + row + "0" + row), "expected increasing times"));
  CHECK(says(wrong("time," + header + "x" + row), "c:2: found 'x' in column 1 (time)"));
}

TEST_CASE("NPY: both types, both byte orders, both index orders, both shapes") {
  const Skeleton s = parse_bone_list("A\t-\nB\tA\n", "s");
  for (const char* type : {"<f4", "<f8", ">f4", ">f8"}) {
    const std::string data = numbers(12, type[2] == '4', type[0] == '>');
    for (const bool flat : {false, true}) {
      const char* const shape = flat ? "(2, 6)" : "(2, 2, 3)";
      CAPTURE(type);
      CAPTURE(shape);
      const PositionClip c = parse_position_npy(
          npy(concat("{'descr': '", type, "', 'fortran_order': False, 'shape': ", shape, ", }  \n"), data), s,
          30, "n");
      CHECK(c.rate == 30);
      REQUIRE(c.positions.size() == 4);
      CHECK(c.positions[0] == Vec3{1, 2, 3});
      CHECK(c.positions[1] == Vec3{4, 5, 6});
      CHECK(c.positions[3] == Vec3{10, 11, 12});
      const PositionClip f = parse_position_npy(
          npy(concat("{\"fortran_order\":True,\"shape\":", shape, ",\"descr\":\"", type, "\"}\n"), data, 2),
          s, 30, "n");
      // The frame varies fastest, then the joint, then x, y, z (or the column).
      CHECK(f.positions[0] == (flat ? Vec3{1, 3, 5} : Vec3{1, 5, 9}));
      CHECK(f.positions[1] == (flat ? Vec3{7, 9, 11} : Vec3{3, 7, 11}));
      CHECK(f.positions[2] == (flat ? Vec3{2, 4, 6} : Vec3{2, 6, 10}));
    }
  }
}

TEST_CASE("invalid NPY is an error that says what was found") {
  const Skeleton s = parse_bone_list("A\t-\nB\tA\n", "s");
  const std::string data = numbers(12, true, false);
  const auto wrong = [&](const std::string& bytes, double rate = 30) {
    return message_of([&] { parse_position_npy(bytes, s, rate, "n"); });
  };
  const auto header = [](const char* type, const char* shape) {
    return concat("{'descr': ", type, ", 'fortran_order': False, 'shape': ", shape, ", }\n");
  };
  CHECK(wrong(npy(header("'<f4'", "(2, 2, 3)"), data)) == "no error");
  CHECK(says(wrong("PK\x03\x04 and so on, a zip"), "n: not an .npy file"));
  CHECK(says(wrong(npy(header("'<f4'", "(2, 6)"), data, 9)), "version 9.0"));
  CHECK(says(wrong(npy(header("'<f4'", "(2, 6)"), "").substr(0, 40)), "the file is truncated"));
  CHECK(says(wrong(npy(header("'<i8'", "(2, 6)"), data)), "of type '<i8', expected '<f4'"));
  CHECK(says(wrong(npy(header("[('x', '<f4')]", "(2, 6)"), data)), "structured"));
  CHECK(says(wrong(npy(header("'<f4'", "(4, 3)"), data)),
             "the shape is [4, 3], expected [frames, 2, 3] or [frames, 6]"));
  CHECK(says(wrong(npy(header("'<f4'", "()"), data)), "the shape is []"));
  CHECK(says(wrong(npy(header("'<f4'", "(2, x)"), data)), "the shape contains 'x'"));
  CHECK(says(wrong(npy(header("'<f4'", "(0, 6)"), "")), "found no frames"));
  CHECK(
      says(wrong(npy(header("'<f4'", "(3, 6)"), data)), "found 48 bytes of numbers, expected 3 frames x 6"));
  CHECK(says(wrong(npy("{'descr': '<f4', 'shape': (2, 6)}\n", data)), "no entry 'fortran_order'"));
  CHECK(says(wrong(npy(header("'<f4'", "(2, 6)"), data), 0), "the rate is 0"));
  CHECK(says(wrong(npy(header("'<f4'", "(2, 6)"), data), 0),
             "give --rate or --fps on the command line, the argument `rate` in the API"));
  std::string bad = data;
  bad.replace(32, 4, {"\0\0\x80\x7f", 4});  // number 9 of 12 is infinite
  CHECK(says(wrong(npy(header("'<f4'", "(2, 6)"), bad)), "n: frame 2, joint 'A': found inf"));
}

TEST_CASE("files round-trip, and the bone list next to them is found") {
  const Folder folder;
  const PositionClip clip = leg_clip();
  write_position_npy(folder.path / "leg.npy", clip);
  write_position_csv(folder.path / "leg.csv", clip);
  CHECK(says(message_of([&] { read_position_file(folder.path / "leg.npy", {}, 30); }),
             "create it, or give a bone list"));
  write_bone_list(folder.path / bone_list_name, clip.skeleton);

  const PositionClip n = read_position_file(folder.path / "leg.npy", {}, 30);
  CHECK(n.id == "leg");
  CHECK(n.rate == 30);
  CHECK(n.positions == clip.positions);  // bit for bit
  CHECK(fs::file_size(folder.path / "leg.npy") == 128 + 27 * 8);
  CHECK(length(n.skeleton.joints[1].offset) > 0);

  const PositionClip c = read_position_file(folder.path / "leg.csv", folder.path / bone_list_name, 0);
  CHECK(c.rate == 30);
  REQUIRE(c.frames == 3);
  for (std::size_t i = 0; i < 9; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      CHECK(c.positions[i][k] == doctest::Approx(clip.positions[i][k]).epsilon(1e-7));
  CHECK(says(read_text(folder.path / "leg.csv", "file"), "time,Hip.x,Hip.y,Hip.z,Knee.x,"));

  fs::copy_file(folder.path / "leg.npy", folder.path / "UPPER.NPY");
  fs::copy_file(folder.path / "leg.csv", folder.path / "UPPER.CSV");
  CHECK(read_position_file(folder.path / "UPPER.NPY", {}, 30).positions == clip.positions);
  CHECK(read_position_file(folder.path / "UPPER.CSV", {}, 0).positions == c.positions);
  for (const char* const name : {"empty.csv", "empty.npy"}) {
    write_text_atomically(folder.path / name, "");
    CHECK(says(message_of([&] { read_position_file(folder.path / name, {}, 30); }),
               concat(name, " is empty, expected joint positions")));
  }
  fs::create_symlink("gone.csv", folder.path / "dead.csv");
  CHECK(says(message_of([&] { read_position_file(folder.path / "dead.csv", {}, 30); }),
             "dead.csv is a dead link (to gone.csv)"));

  CHECK(says(message_of([&] { read_position_file(folder.path / "leg.txt", {}, 30); }), "ends in '.txt'"));
  CHECK(says(message_of([&] { read_position_file(folder.path / "no.csv", {}, 30); }), "does not exist"));
  PositionClip bad = clip;
  bad.positions[4][1] = std::numeric_limits<double>::quiet_NaN();
  CHECK(says(message_of([&] { write_position_npy(folder.path / "leg.npy", bad); }), "frame 2, joint 'Knee'"));
  CHECK(read_position_file(folder.path / "leg.npy", {}, 30).positions ==
        clip.positions);  // the old file is unchanged
  bad = clip;
  bad.skeleton.joints[0].name = "Hip,left";
  CHECK_THROWS_AS(write_position_csv(folder.path / "x.csv", bad), Error);
  bad = clip;
  bad.rate = 0;
  CHECK_THROWS_AS(write_position_csv(folder.path / "x.csv", bad), Error);
}

}  // namespace position_files_test

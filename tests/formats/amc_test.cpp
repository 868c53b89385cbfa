// ASF and AMC: rotations and positions against independent values, conversion to BVH, the search for the .asf
// file, and errors.
#include <doctest/doctest.h>

#include <filesystem>
#include <motiongan/formats/amc.hpp>
#include <motiongan/formats/bvh.hpp>
#include <motiongan/motion/kinematics.hpp>
#include <string>
#include <utility>
#include <vector>

#include "../support/expmap_files.hpp"
#include "../support/messages.hpp"

namespace amc_test {

using namespace motiongan;
using namespace motiongan::motion;
using testing::message_of;
using testing::says;

namespace {

// All bones have different axes and orders of rotation; degrees of freedom are subsets in any order.
const char* const asf_text = R"(# a comment
:version 1.10
:name TEST
:units
  mass 1.0
  length 0.45
  angle deg
:documentation
   the words of a section may occur here: begin end
:root
   order TZ TX TY RY RZ RX
   axis ZYX
   position 1 2 3
   orientation 10 -20 30
:bonedata
  begin
     id 1
     name hip
     direction 1 0 0
     length 0.5
     axis 0 0 0 XYZ
  end
  begin
     id 2
     name thigh
     direction 0 -1 0
     length 3
     axis 50 5 -10 YZX
    dof ry
    limits (-90 90)
  end
  begin
     id 3
     name foot
     direction 0 0 1
     length 1
     axis -90 0 20 ZYX
    dof rx ry rz
  end
  begin
     id 4
     name back
     direction 0 0.6 0.8
     length 2
     axis 20 30 -40 XYZ
    dof rx ry rz
    limits (-20.0 45.0)
           (-30.0 30.0)
           (-inf inf)
  end
  begin
     id 5
     name neck
     direction 0.28 0.96 0
     length 1.5
     axis 15 -25 70 ZXY
    dof rz rx
    limits (-20 20)
           (-20 20)
  end
:hierarchy
  begin
    root hip back
    hip thigh
    thigh foot
    back neck
  end
)";

const char* const amc_text = R"(#!OML:ASF TEST.ASF
:FULLY-SPECIFIED
:DEGREES
1
root 7 -4 9 10 20 30
back 5 -15 25
neck 35 -45
thigh 60
foot -10 20 40
2
root 7.5 -4.25 9.125 -170 80 100
back 0 0 90
neck 1e-015 0
foot 1 2 3
thigh -120
)";

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const std::size_t at = text.find(what);
  REQUIRE(at != text.npos);
  return text.replace(at, what.size(), with);
}

std::string asf_refusal(const std::string& what, const std::string& with) {
  return message_of([&] { parse_asf(replaced(asf_text, what, with), "a.asf"); });
}

std::string amc_refusal(const std::string& what, const std::string& with) {
  const AsfSkeleton asf = parse_asf(asf_text, "a.asf");
  return message_of([&] { parse_amc(replaced(amc_text, what, with), asf, 120, "a.amc"); });
}

void check_near(const Vec3& found, const Vec3& expected) {
  for (std::size_t k = 0; k < 3; ++k) CHECK(found[k] == doctest::Approx(expected[k]).epsilon(1e-9));
}

// Where each bone ends, in the order root, hip, thigh, foot, back, neck. Computed with NumPy: rotation
// matrices by Rodrigues' formula about the coordinate axes, a sequence such as XYZ multiplied from the left
// letter by letter; a bone's local rotation is C M inv(C), its global one G = G(parent) C M inv(C), and it
// ends at end(parent) + G direction length. The root is at its position plus its translation, with M in the
// order of its angles (YZX).
const std::vector<std::vector<Vec3>> expected_ends{{{-3.000000000000, 11.000000000000, 10.000000000000},
                                                    {-2.581994388512, 11.264373920419, 9.926666931289},
                                                    {-0.382284306136, 10.642512474875, 7.983843239843},
                                                    {0.087703533091, 11.454398107486, 8.330185773383},
                                                    {-3.997897183770, 11.207013990037, 11.720856303865},
                                                    {-4.483989944031, 12.625036620744, 11.666767051483}},
                                                   {{-3.250000000000, 11.125000000000, 10.500000000000},
                                                    {-2.885665780794, 11.125116171336, 10.157566702525},
                                                    {-3.875024992813, 9.854360364521, 12.688643159102},
                                                    {-4.780018065763, 9.732050772858, 12.281177943777},
                                                    {-4.470826335573, 12.005278765506, 11.817077200991},
                                                    {-5.780555415704, 11.446433784140, 12.288566356182}}};

void check_ends(const Motion& motion) {
  const std::vector<Vec3> starts = joint_positions(motion);
  const std::vector<Vec3> leaves = end_site_positions(motion, forward_kinematics(motion));
  REQUIRE(motion.frames == 2);
  REQUIRE(starts.size() == 12);
  REQUIRE(leaves.size() == 4);
  for (std::size_t f = 0; f < 2; ++f) {
    const std::vector<Vec3>& end = expected_ends[f];
    const Vec3* const start = &starts[6 * f];  // root, hip, thigh, foot, back, neck
    check_near(start[0], end[0]);
    check_near(start[1], end[0]);
    check_near(start[2], end[1]);
    check_near(start[3], end[2]);
    check_near(start[4], end[0]);
    check_near(start[5], end[4]);
    check_near(leaves[2 * f], end[3]);
    check_near(leaves[2 * f + 1], end[5]);
  }
}

}  // namespace

TEST_CASE("a bone of an .asf file is a joint at its start") {
  const AsfSkeleton asf = parse_asf(asf_text, "a.asf");
  std::vector<std::string> names;
  std::vector<int> parents;
  for (const Joint& joint : asf.skeleton.joints) {
    names.push_back(joint.name);
    parents.push_back(joint.parent);
  }
  CHECK(names == std::vector<std::string>{"root", "hip", "thigh", "foot", "back", "neck"});
  CHECK(parents == std::vector<int>{-1, 0, 1, 2, 0, 4});
  const std::vector<Joint>& joints = asf.skeleton.joints;
  CHECK(joints[1].offset == Vec3{0, 0, 0});
  CHECK(joints[2].offset == Vec3{0.5, 0, 0});
  check_near(joints[5].offset, {0, 1.2, 1.6});
  CHECK(!joints[4].end_site);
  REQUIRE(joints[3].end_site);
  CHECK(*joints[3].end_site == Vec3{0, 0, 1});
  CHECK(joints[0].channels.size() == 6);
  CHECK(joints[1].channels.size() == 3);
  REQUIRE(asf.unit_metres);
  CHECK(*asf.unit_metres == doctest::Approx(0.05644444));
  CHECK(!parse_asf(replaced(asf_text, "length 0.45", ""), "a.asf").unit_metres);
}

TEST_CASE("frames of an .amc file put the bones where they belong") {
  const Motion motion = parse_amc(amc_text, parse_asf(asf_text, "a.asf"), 60, "a.amc");
  CHECK(motion.rate == 60);
  CHECK(motion.rotation(0, 1) == Quat{});  // no degrees of freedom
  check_ends(motion);
  check_ends(to_motion(parse_bvh(format_bvh(to_clip(motion, "a")), "a.bvh")));
}

TEST_CASE("a rotation is about the bone's own axes") {
  // The bone points along y and its own x axis is the world's y: rx spins it about itself. Its own y axis is
  // -x: ry = 90 lays it down towards -z.
  const AsfSkeleton asf = parse_asf(
      ":root\norder TX TY TZ RX RY RZ\n:bonedata\nbegin\nname arm\ndirection 0 1 0\nlength 2\naxis 0 0 90 "
      "XYZ\n"
      "dof rx ry\nend\n:hierarchy\nbegin\nroot arm\nend\n",
      "a.asf");
  const Motion motion =
      parse_amc("1\nroot 0 0 0 0 0 0\narm 35 0\n2\nroot 0 0 0 0 0 0\narm 0 90\n", asf, 120, "a");
  const std::vector<Vec3> ends = end_site_positions(motion, forward_kinematics(motion));
  check_near(ends[0], {0, 2, 0});
  CHECK(ends[1][2] == doctest::Approx(-2));
}

TEST_CASE("radians, the file's own rate, and line breaks of other systems") {
  const AsfSkeleton asf = parse_asf(asf_text, "a.asf");
  const Motion turned = parse_amc(
      ":SAMPLES-PER-SECOND 30\r:RADIANS\r1\rroot 0 0 0 0 0 0\rback 0 0 0\rneck 0 0\rthigh 0.5\rfoot 0 0 0\r",
      asf, 120, "a.amc");
  CHECK(turned.rate == 30);
  CHECK(angle_between(turned.rotation(0, 2), {}) == doctest::Approx(0.5));
  const AsfSkeleton radians = parse_asf(
      replaced(replaced(asf_text, "angle deg", "angle rad"), "axis 50 5 -10", "axis 1 0 0"), "a.asf");
  CHECK(angle_between(radians.bones[2].axis, {}) == doctest::Approx(1));
  const Motion same =
      parse_amc("1\r\nroot 0 0 0 0 0 0\r\nback 0 0 0\r\nneck 0 0\r\nthigh 0.5\r\nfoot 0 0 0\r\n", radians,
                120, "a.amc");
  CHECK(angle_between(same.rotation(0, 2), {}) == doctest::Approx(0.5));
}

TEST_CASE("invalid .asf files are errors with their line") {
  CHECK(says(asf_refusal("dof ry", "dof ry l"), "a.asf:29: bone 'thigh' can change its length ('l')"));
  CHECK(says(asf_refusal("dof ry", "dof tx"), "a.asf:29: bone 'thigh' can move along an axis"));
  CHECK(says(asf_refusal("dof ry", "dof rw"), "a.asf:29: found 'rw', expected tx, ty, tz, rx, ry or rz"));
  CHECK(says(asf_refusal("dof ry", "dof ry RY"), "a.asf:29: found 'ry' twice"));
  CHECK(says(asf_refusal("-10 YZX", "-10 YZZ"), "a.asf:28: found 'yzz' as the order of rotations"));
  CHECK(says(asf_refusal("length 3", "length x"), "a.asf:27: found 'x', expected the bone's length"));
  CHECK(says(asf_refusal("length 3", "length -3"), "a.asf:27: bone 'thigh' has a length of -3"));
  CHECK(says(asf_refusal("length 3", "bodymass 3"), "a.asf:31: bone 'thigh' ends without 'length'"));
  CHECK(says(asf_refusal("direction 0 -1 0", "direction 0 -1"), "a.asf:26: 'direction' ends before"));
  CHECK(says(asf_refusal("name thigh", "name hip"), "a.asf:25: the bone 'hip' is listed twice"));
  CHECK(says(asf_refusal("name thigh", "name root"), "a.asf:25: the bone 'root' is listed twice"));
  CHECK(says(asf_refusal("hip thigh\n", "hip thich\n"), "found the bone 'thich', expected root or a bone"));
  CHECK(says(asf_refusal("hip thigh\n", ""), "a.asf: bone 'thigh' is not connected to the root"));
  CHECK(says(asf_refusal("root hip back\n", "back hip\nhip back\n"), "bone 'hip' is not connected"));
  CHECK(says(asf_refusal("back neck\n", "back foot\n"), "bone 'foot' has a second parent, 'back'"));
  CHECK(says(asf_refusal("back neck\n", "back root\n"), "the root is a child of 'back'"));
  CHECK(says(asf_refusal("angle deg", "angle grad"), "a.asf:7: the unit of angles is 'grad'"));
  CHECK(says(asf_refusal("order TZ TX TY RY RZ RX", ""), "a.asf: the section :root has no line 'order'"));
  CHECK(says(message_of([] { parse_asf("HIERARCHY\nROOT Hips\n", "a.bvh"); }), "is this an .asf file?"));
  std::string many = "end\n";
  for (int i = 0; i < 10000; ++i) many += concat("begin\nname b", i, "\ndirection 0 1 0\nlength 1\nend\n");
  CHECK(says(asf_refusal("  end\n", many), "found more than 10000 bones"));
}

TEST_CASE("invalid .amc files are errors with their line") {
  CHECK(says(amc_refusal("neck 35 -45\n", ""), "a.amc:4: frame 1 has no line for bone 'neck', expected one"));
  CHECK(says(amc_refusal("thigh -120\n", ""), "a.amc:10: frame 2 has no line for bone 'thigh'"));
  CHECK(says(amc_refusal("neck 35 -45\n", "neck 35\n"), "a.amc:7: bone 'neck' has 1 value, expected 2"));
  CHECK(
      says(amc_refusal("neck 35 -45\n", "neck 35 -45 1\n"), "a.amc:7: bone 'neck' has 3 values, expected 2"));
  CHECK(says(amc_refusal("neck 35 -45\n", "neck 35 nan\n"), "a.amc:7: found 'nan', expected a bone's value"));
  CHECK(says(amc_refusal("neck 35 -45\n", "nick 35 -45\n"), "a.amc:7: found the bone 'nick'"));
  CHECK(
      says(amc_refusal("thigh 60\n", "neck 35 -45\n"), "a.amc:8: frame 1 has a second line for bone 'neck'"));
  CHECK(says(amc_refusal("2\nroot", "3\nroot"), "a.amc:10: found frame 3 after frame 1, expected frame 2"));
  CHECK(
      says(amc_refusal("1\nroot", "root"), "a.amc:4: found 'root', expected the number of the first frame"));
  const AsfSkeleton asf = parse_asf(asf_text, "a.asf");
  CHECK(says(message_of([&] { parse_amc(":DEGREES\n", asf, 120, "a.amc"); }), "a.amc: found no frames"));
  CHECK(says(message_of([&] { parse_amc(amc_text, asf, 0, "a.amc"); }), "a.amc: the rate is 0"));
}

TEST_CASE("the .asf file of an .amc file") {
  const testing::ExpmapFolder folder;
  const std::filesystem::path amc = folder.path() / "07_01.amc";
  folder.write("07_01.amc", amc_text);
  CHECK(says(message_of([&] { read_amc(amc); }),
             "has 0 .asf files, none called 07_01.asf: give the .asf file"));
  folder.write("skeleton.ASF", asf_text);
  CHECK(find_asf(amc).filename() == "skeleton.ASF");
  CHECK(read_amc(amc).rate == 120);
  folder.write("08.asf", asf_text);
  CHECK(says(message_of([&] { read_amc(amc); }), "has 2 .asf files"));
  CHECK(read_amc(amc, folder.path() / "08.asf", 60).rate == 60);
  folder.write("07.asf", asf_text);
  CHECK(find_asf(amc).filename() == "07.asf");
  folder.write("07_01.asf", asf_text);
  CHECK(find_asf(amc).filename() == "07_01.asf");
  check_ends(read_amc(amc));
  CHECK(says(message_of([] { read_amc("absent/07_01.amc"); }), "absent/07_01.amc does not exist"));
}

}  // namespace amc_test

// Which clip a caption belongs to.
#include <doctest/doctest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "motiongan/data/caption_match.hpp"
#include "motiongan/formats/clip_files.hpp"

namespace caption_match_test {

using namespace motiongan;
using namespace motiongan::motion;
namespace fs = std::filesystem;
using Texts = std::vector<std::string>;

namespace {

/// The captions of each file of `clips/`.
struct Matched {
  std::vector<Texts> texts;
  CaptionReport report;
};

Matched match(const std::string& lines, const std::vector<fs::path>& below) {
  std::vector<fs::path> files;
  for (const fs::path& file : below) files.push_back("clips" / file);
  const CaptionMatch found = match_captions(parse_caption_lines(lines, "c.tsv"),
                                            clip_names(files, clip_ids(files, "clips"), "clips"));
  Matched out{{}, found.report};
  for (const std::vector<Caption>& captions : found.of_clip) {
    out.texts.emplace_back();
    for (const Caption& caption : captions) out.texts.back().push_back(caption.text);
  }
  return out;
}

}  // namespace

TEST_CASE("ids with and without ending, by file name and by path") {
  const std::vector<fs::path> files{"a/walk.bvh", "b/run.BVH", "jump.v2.bvh"};
  for (const char* lines : {"walk\tA\nrun\tB\njump.v2\tC", "walk.bvh\tA\nrun.BVH\tB\njump.v2.bvh\tC",
                            "walk.npy\tA\nrun.CSV\tB\njump.v2\tC", "a/walk\tA\nb/run\tB\njump.v2\tC",
                            "a\\walk.bvh\tA\n./b/run.bvh\tB\n.\\jump.v2.bvh\tC",
                            "WALK\tA\nRun\tB\nJump.V2.bvh\tC", "A/Walk.bvh\tA\nB\\RUN\tB\nJUMP.v2\tC"}) {
    const Matched m = match(lines, files);
    CHECK_MESSAGE((m.texts == std::vector<Texts>{{"A"}, {"B"}, {"C"}}), lines);
    CHECK(m.report.unmatched.empty());
    CHECK(m.report.without.empty());
  }
}

TEST_CASE("a path takes precedence over a name, the exact case over another") {
  const std::vector<fs::path> files{"a/walk.bvh", "b/walk.bvh"};
  CHECK(match("walk\tA\nb/walk.bvh\tB\nb/walk\tC\n", files).texts == std::vector<Texts>{{"A"}, {"B", "C"}});
  CHECK(match("a/walk\tA\nb/walk\tB\nwalk\tC\n", files).report.unmatched.empty());
  CHECK(match("c/walk\tA\nwalk\tB\n", files).report.unmatched == Texts{"'c/walk' (line 1)"});
  // A caption with an exact match does not also serve a clip of another case.
  CHECK(match("walk\tA\n", {"Walk.bvh", "walk.bvh"}).texts == std::vector<Texts>{{}, {"A"}});
  CHECK(match("WALK\tA\nwalk\tB\n", {"Walk.bvh", "walk.bvh"}).texts == std::vector<Texts>{{"A"}, {"B"}});
}

TEST_CASE("captions of no clip and clips without a caption are listed") {
  const Matched m = match("#\nwalk\tA\nfly\tB\nswim\tC\nfly\tD\n", {"run.bvh", "walk.bvh", "x/jump.bvh"});
  CHECK(m.report.source == "c.tsv");
  CHECK(m.report.unmatched == Texts{"'fly' (line 3)", "'swim' (line 4)", "'fly' (line 5)"});
  CHECK(m.report.without == Texts{"run", "jump"});
  const Matched none = match("", {"run.bvh"});
  CHECK(none.report.without == Texts{"run"});
  CHECK(match_captions({}, std::vector<ClipName>{clip_name("run")}).report.without.empty());
  CHECK_THROWS_WITH_AS(
      match("fly\tB\nswim\tC\n", {"run.bvh", "walk.bvh"}),
      doctest::Contains("c.tsv: no caption matches a clip; the first caption is for 'fly' (line 1), "
                        "the first clip is 'run'; expected a clip's file name"),
      Error);
}

}  // namespace caption_match_test

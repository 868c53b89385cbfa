// Caption files as people write them: CSV, JSON, one text file for each clip, and their encodings.
#include <doctest/doctest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "motiongan/data/captions.hpp"

namespace caption_files_test {

using namespace motiongan;
using namespace motiongan::motion;
using namespace std::string_literals;
namespace fs = std::filesystem;
using Texts = std::vector<std::string>;

namespace {

/// A temporary folder, removed at the end.
struct Folder {
  fs::path path = fs::temp_directory_path() / ("motiongan_caption_files_test_" + std::to_string(::getpid()));
  Folder() { fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
  void write(const std::string& name, const std::string& text) const {
    fs::create_directories((path / name).parent_path());
    write_text_atomically(path / name, text);
  }
};

Captions csv(const std::string& text) { return captions_by_id(parse_caption_csv(text, "c.csv")); }
Captions json(const std::string& text) { return captions_by_id(parse_caption_json(text, "c.json")); }

std::vector<std::size_t> lines_of(const CaptionFile& file) {
  std::vector<std::size_t> out;
  for (const CaptionLine& line : file.lines) out.push_back(line.line);
  return out;
}

}  // namespace

TEST_CASE("CSV with quotes, comments and any line ends") {
  const Captions c =
      csv("# a comment, \"with a quote\r\nwalk_01,\"slow, careful walk\"\r\n\r\nwalk_01, plain \n"
          "\"run, 02\" , \"he said \"\"run\"\"\"\rjump,over\n");
  CHECK(c.at("walk_01") == Texts{"slow, careful walk", "plain"});
  CHECK(c.at("run, 02") == Texts{"he said \"run\""});
  CHECK(csv("jump,over a \"ditch\"").at("jump") == Texts{"over a \"ditch\""});
  CHECK(csv("").empty());
  CHECK(csv("walk,\"over\r\ntwo lines\"\nrun,fast\n").at("walk") == Texts{"over two lines"});
  CHECK(lines_of(parse_caption_csv("a,\"x\ny\"\n#\nb,z,,\n", "c.csv")) == std::vector<std::size_t>{1, 4});
}

TEST_CASE("CSV: the separator and a header are recognised") {
  CHECK(csv("id;caption\nwalk;slow, careful\n").at("walk") == Texts{"slow, careful"});
  CHECK(csv("walk;slow, careful\n").at("walk") == Texts{"slow, careful"});
  CHECK(csv("Name\tText\nwalk\tslow; careful\n").at("walk") == Texts{"slow; careful"});
  CHECK(csv("\xEF\xBB\xBF"
            "file,description\nwalk.bvh,slow\n")
            .size() == 1);
  const Captions c = csv("id,take,Description,file\n7,2,slow walk,walk.bvh\n8,1,fast run,run.bvh\n");
  CHECK(c.size() == 2);
  CHECK(c.at("walk.bvh") == Texts{"slow walk"});
  CHECK(csv("name,seconds\nwalk,slow\n").size() == 2);  // no caption column: not a header
}

TEST_CASE("CSV errors name the line") {
  const auto refused = [](const std::string& text, const char* why) {
    CHECK_THROWS_WITH_AS(csv(text), doctest::Contains(why), Error);
  };
  refused("a,b\nwalk,slow, careful\n",
          "c.csv:2: found 3 columns, expected 2: clip id and caption; put a text");
  refused("id,caption\nwalk,slow, careful\n", "c.csv:2: found 3 columns, expected 2 as in the header");
  refused("a,b\nwalk\n", "c.csv:2: found 1 column, expected 2");
  refused("a,b\nc,\"open\nd,e\n", "c.csv:2: found a quote that is not closed");
  refused("a,\"b\" c\n", "c.csv:1: found 'c' after a closing quote");
  refused("a,b\nwalk,\n", "c.csv:2: clip 'walk' has the description '', expected at least one word");
  refused("a,b\n,walk\n", "c.csv:2: found no clip id for the caption 'walk'");
  refused("a,b\nc,caf\xE9\n", "c.csv:2: found text that is not UTF-8; save the file as UTF-8");
}

TEST_CASE("JSON objects and lists") {
  const Captions c = json(R"({"walk": ["slow walk", " careful "], "run.bvh": "run"})");
  CHECK(c.at("walk") == Texts{"slow walk", "careful"});
  CHECK(c.at("run.bvh") == Texts{"run"});
  const Captions list = json(
      "\xEF\xBB\xBF"
      R"([{"id": "walk", "caption": "slow"}, {"clip": "walk", "texts": ["a", "b"]},
    {"id": 3, "file": "run.bvh", "description": "r"}, {"name": "jump", "captions": "up"}, {"id": 4, "text": "t"}])");
  CHECK(list.size() == 4);
  CHECK(list.at("walk") == Texts{"slow", "a", "b"});
  CHECK(list.at("run.bvh") == Texts{"r"});
  CHECK(list.at("jump") == Texts{"up"});
  CHECK(list.at("4") == Texts{"t"});
  CHECK(json("{}").empty());
}

TEST_CASE("JSON errors name the file and the place") {
  const auto refused = [](const std::string& text, const char* why) {
    CHECK_THROWS_WITH_AS(json(text), doctest::Contains(why), Error);
  };
  refused("{\"walk\":\n \"a\",}", "c.json: parse error at line 2, column 6");
  refused("{\"walk\": \"caf\xE9\"}", "expected JSON in UTF-8");
  refused("", "c.json: parse error at line 1");
  refused("3", "c.json: found 3, expected {\"clip\"");
  refused(R"({"walk": 3})", "c.json: clip 'walk' has the captions 3, expected a string or a list");
  refused(R"({"walk": [null]})", "c.json: clip 'walk' has the caption null, expected a string");
  refused(R"({"walk": "-"})", "clip 'walk' has the description '-', expected at least one word");
  refused(R"({"walk": "a", "walk": "b"})", "clip 'walk' appears twice");
  refused(R"([{"id": "a", "text": "b"}, {"text": "b"}])", "c.json: entry 1 has no clip id");
  refused(R"([{"id": "a"}])", "c.json: entry 0 has no caption, expected \"caption\"");
  refused(R"(["a"])", "c.json: entry 0 is \"a\", expected an object");
  refused(R"([{"id": [], "text": "b"}])", "c.json: entry 0 has the clip id [], expected a string");
}

TEST_CASE("encodings and line ends") {
  CHECK(parse_captions("a\tb\rc\td\r\ne\tf", "c.tsv").size() == 3);
  CHECK(parse_caption_lines("\xEF\xBB\xBF"
                            "a\tb\r\r\n\r# x\rc\td",
                            "c.tsv")
            .lines.back()
            .line == 5);
  for (const std::string& text : {"\xFF\xFE"
                                  "a\0\t\0b\0"s,
                                  "\xFE\xFF\0a\0\t\0b"s, "a\0\t\0b\0\n\0"s, "\0a\0\t\0b"s}) {
    const char* why = ": found UTF-16 text, expected UTF-8; save it as UTF-8";
    CHECK_THROWS_WITH_AS(parse_captions(text, "c.tsv"), doctest::Contains(why), Error);
    CHECK_THROWS_WITH_AS(parse_caption_csv(text, "c.csv"), doctest::Contains(why), Error);
    CHECK_THROWS_WITH_AS(parse_caption_json(text, "c.json"), doctest::Contains(why), Error);
  }
  CHECK_THROWS_WITH_AS(parse_captions("a\tb\n\nc\tcaf\xE9\n", "c.tsv"),
                       doctest::Contains("c.tsv:3: found text"), Error);
}

TEST_CASE("the ending tells the format") {
  const Folder folder;
  folder.write("a.CSV", "walk,\"a, b\"\n");
  folder.write("a.Json", R"({"walk": "a, b"})");
  folder.write("a.tsv", "walk\ta, b\n");
  folder.write("a.txt", "walk\ta, b\n");
  for (const char* name : {"a.CSV", "a.Json", "a.tsv", "a.txt"})
    CHECK(read_captions(folder.path / name) == Captions{{"walk", {"a, b"}}});
  const std::string path = (folder.path / "a.CSV").string();
  folder.write("a.CSV", "walk\n");
  CHECK_THROWS_WITH_AS(read_captions(path), doctest::Contains((path + ":1: found 1 column").c_str()), Error);
}

TEST_CASE("text files with one caption on each line, some of parts") {
  const Folder folder;
  folder.write("texts/a/walk.txt",
               "\xEF\xBB\xBFslow walk\r\n\r\nhe walks.#he/PRON walk/VERB#0.0#0.0\n"
               "turns left#turn/VERB left/ADV#2.0#4.5\nall#x#nan#nan\nthen on#x#4.5#nan\n"
               "take #3 of #4 # really\n");
  const CaptionFile file = read_caption_folder(folder.path / "texts");
  REQUIRE(file.lines.size() == 6);
  CHECK(file.lines[0].id == "a/walk");
  CHECK(file.lines[0].caption == Caption{"slow walk"});
  CHECK(file.lines[1].caption == Caption{"he walks."});
  CHECK(file.lines[2].caption == Caption{"turns left", CaptionPart{2, 4.5}});
  CHECK(file.lines[3].caption == Caption{"all"});
  CHECK(file.lines[4].caption ==
        Caption{"then on", CaptionPart{4.5, std::numeric_limits<double>::infinity()}});
  CHECK(file.lines[5].caption == Caption{"take #3 of #4 # really"});
  CHECK(lines_of(file) == std::vector<std::size_t>{1, 3, 4, 5, 6, 7});
  CHECK(read_captions(folder.path / "texts").at("a/walk").size() == 4);  // those of parts are left out
  const auto refused = [&](const std::string& text, const std::string& why) {
    folder.write("bad/walk.txt", text);
    CHECK_THROWS_WITH_AS(read_caption_file(folder.path / "bad"),
                         doctest::Contains(("walk.txt:2: " + why).c_str()), Error);
  };
  refused("a\nb#x#4.0#2.0\n", "found the times 4 to 2 s, expected an end after the start");
  refused("a\n...\n", "found '...', expected a caption of at least one word");
  refused("a\n0.5 1.25 3\n", "found only numbers");
  refused("a\ncaf\xE9\n", "found text that is not UTF-8");
}

TEST_CASE("text files beside the clips, in texts/ in their folder or beside it") {
  const Folder folder;
  const std::vector<fs::path> files{folder.path / "in/a/run.bvh", folder.path / "in/jump.bvh",
                                    folder.path / "in/kick.bvh", folder.path / "in/run.bvh",
                                    folder.path / "in/walk.bvh"};
  const std::vector<std::string> ids{"a/run", "jump", "kick", "run", "walk"};
  const std::vector<ClipName> names = clip_names(files, ids, folder.path / "in");
  folder.write("in/README.txt", "");
  CHECK(read_captions_beside(files, names).lines.empty());
  CHECK(find_captions({}, files, names).report.source.empty());
  folder.write("in/README.txt", "\xFF");  // of no clip: not read
  folder.write("in/Walk.TXT", "a walk");
  folder.write("in/texts/jump.txt", "a jump\nup\n");
  folder.write("texts/run.txt", "a run");
  folder.write("texts/walk.txt", "not read");
  const CaptionMatch match = find_captions({}, files, names);
  CHECK(match.report.source == "the .txt files beside the clips");
  CHECK(match.of_clip[0].empty());  // not the text of the other run
  CHECK(match.of_clip[1] == std::vector<Caption>{{"a jump"}, {"up"}});
  CHECK(match.of_clip[3] == std::vector<Caption>{{"a run"}});
  CHECK(match.of_clip[4] == std::vector<Caption>{{"a walk"}});
  CHECK(match.report.without == Texts{"a/run", "kick"});
  CHECK(match.report.unmatched.empty());
}

TEST_CASE("pipes and links that lead to themselves are no captions, and are named") {
  const Folder folder;
  fs::create_symlink("loop.txt", folder.path / "loop.txt");
  REQUIRE(mkfifo((folder.path / "pipe.txt").c_str(), 0600) == 0);
  const auto beside = [&](const std::string& name) {
    const std::vector<fs::path> files{folder.path / (name + ".bvh")};
    read_captions_beside(files, std::vector<ClipName>{{name, name, name}});
  };
  CHECK_THROWS_WITH_AS(beside("loop"), doctest::Contains("loop.txt cannot be reached"), Error);
  CHECK_THROWS_WITH_AS(beside("pipe"), doctest::Contains("pipe.txt is a named pipe"), Error);
  CHECK_THROWS_WITH_AS(read_caption_file(folder.path / "pipe.txt"), doctest::Contains("is a named pipe"),
                       Error);
  CHECK_NOTHROW(beside("other"));
  folder.write("huge.json", "");
  fs::resize_file(folder.path / "huge.json", largest_list_file + 1);  // sparse
  CHECK_THROWS_WITH_AS(read_caption_file(folder.path / "huge.json"),
                       doctest::Contains("huge.json has 268435457 bytes, expected at most 268435456"), Error);
}

}  // namespace caption_files_test

// Captions and prompts in the formats that people have, through the command.
#include <doctest/doctest.h>

#include "command.hpp"

namespace captions_test {

namespace {

const std::string data = " --frames 8 --rate 8 --hidden 8 --batch 2 --critic-steps 1 --iterations 2 ";

void refused(const std::string& arguments, const std::string& why) {
  const Said said = call(arguments);
  CHECK(said.status == 1);
  CHECK_MESSAGE(said.has(why), said.text);
}

}  // namespace

TEST_CASE("caption files in train, info and search") {
  const TestFolder folder;
  REQUIRE(call("synth clips --clips 4 --seconds 4").status == 0);
  const std::string tsv = bytes_of("clips/captions.tsv");
  const Said trained = call("train dvgan clips --save a" + data);
  CHECK_MESSAGE(trained.has("from clips/captions.tsv\n"), trained.text);
  fs::remove("clips/captions.tsv");

  // The same captions as JSON give the same data and so the same model.
  std::string json;
  for (std::size_t at = tsv.find('\n') + 1; at < tsv.size();) {  // after the comment
    const std::size_t tab = tsv.find('\t', at), end = tsv.find('\n', at);
    json += (json.empty() ? "[" : ",") + ("{\"file\": \"" + tsv.substr(at, tab - at)) +
            ".bvh\", \"text\": \"" + tsv.substr(tab + 1, end - tab - 1) + "\"}";
    at = end + 1;
  }
  write_file("clips/captions.json", json + "]");
  const Said again = call("train dvgan clips --save b" + data);
  CHECK_MESSAGE(again.has("from clips/captions.json\n"), again.text);
  CHECK(bytes_of("a/generator.safetensors") == bytes_of("b/generator.safetensors"));

  // CSV comes before JSON.
  write_file("clips/captions.csv", "file,description\r\nWALK_000.bvh,\"a walk, slow\"\r\nfly,\"up\"\r\n");
  const Said csv = call("train dvgan clips --save c" + data);
  CHECK_MESSAGE(csv.has("from clips/captions.csv; 3 of 4 clips captioned by file names"), csv.text);
  CHECK(csv.has("1 caption matches no clip: 'fly' (line 3)"));
  CHECK(csv.has("3 clips have no caption: "));
  const Said info = call("info clips");
  CHECK_MESSAGE(info.has("from clips/captions.csv; 3 clips captioned by file names"), info.text);
  CHECK(info.has("1 caption matches no clip: 'fly' (line 3)"));
  CHECK(info.has("a walk, slow"));
  const Said search = call("search --model a --text walk --collection clips");
  CHECK_MESSAGE(search.has("motiongan: clips/captions.csv: 1 caption matches no clip: 'fly' (line 3)"),
                search.text);
  CHECK(search.has("a walk, slow"));

  write_file("none.csv", "id;text\nfly;up\n");
  for (const char* verb :
       {"info clips", "train dvgan clips", "search --model a --text walk --collection clips"})
    refused(
        verb + std::string(" --captions none.csv"),
        "none.csv: no caption matches a clip; the first caption is for 'fly' (line 2), the first clip is '");
}

TEST_CASE("text files beside the clips, with parts") {
  const TestFolder folder;
  REQUIRE(call("synth clips --clips 4 --seconds 4").status == 0);
  fs::remove("clips/captions.tsv");
  const Said named = call("info clips");
  CHECK_MESSAGE(
      named.has("taken from file names (no captions.tsv, .csv or .json in the folder, no .txt beside"),
      named.text);
  fs::create_directory("clips/texts");
  write_file("clips/texts/walk_000.txt", "walks#walk/VERB#0.0#2.0\nstops#stop/VERB#2.0#4.0\nall of it\n");
  write_file("clips/run_001.txt", "runs#x#0.0#2.0\nstumbles#x#2.0#4.0\n");
  const Said said = call("train dvgan clips --save run" + data);
  CHECK_MESSAGE(said.has("from the .txt files beside the clips; 2 of 7 clips captioned by file names"),
                said.text);
  CHECK(said.has("2 clips have no caption: "));
  CHECK(said.has("4 parts with captions of their own; 1 whole clip left out, covered by such parts"));
  const std::string split = bytes_of("run/split.tsv");
  for (const char* id : {"walk_000\n", "walk_000@0.0-2.0\n", "walk_000@2.0-4.0\n", "run_001@0.0-2.0\n"})
    CHECK_MESSAGE(split.find(id) != std::string::npos, split);
  CHECK(split.find("run_001\n") == std::string::npos);
  const Said info = call("info clips");
  CHECK_MESSAGE(info.has("60     2 s      1  stumbles"), info.text);
  CHECK(info.has("120     4 s      1  all of it"));
  const Said found = call("search --model run --text walk --collection clips --windows --top 99");
  CHECK_MESSAGE(found.has("stumbles"), found.text);
  CHECK(
      call("train dvgan clips --captions clips/texts --save c" + data).has("from clips/texts; 3 of 6 clips"));
  CHECK(call("train dvgan --resume --save run --iterations 3").status == 0);
}

TEST_CASE("a caption that begins with a bracket is a caption") {
  const TestFolder folder;
  REQUIRE(call("synth clips --clips 1 --seconds 2").status == 0);
  write_file("clips/captions.tsv", "walk_000\t(slow) walk\n");
  const Said said = call("info clips");
  CHECK_MESSAGE(said.has("from clips/captions.tsv\n"), said.text);
  CHECK(said.has("(slow) walk"));
}

TEST_CASE("prompt files") {
  const TestFolder folder;
  REQUIRE(call("synth clips --clips 4 --seconds 4").status == 0);
  REQUIRE(call("train dvgan clips --save run" + data).status == 0);
  write_file("p.txt", "\xEF\xBB\xBFwalk\r\n# comment\r\n\r\n \t\r\n  run\rjump");
  const Said said = call("generate run --prompts p.txt --out a");
  CHECK_MESSAGE(said.status == 0, said.text);
  for (const char* name : {"walk", "run", "jump"})
    CHECK(said.has(std::string("\"") + name + "\": a/" + name + "_000.bvh"));
  CHECK(said.has("wrote 3 BVH files"));
  REQUIRE(call("generate run --text walk --out b").status == 0);
  CHECK(bytes_of("a/walk_000.bvh") == bytes_of("b/walk_000.bvh"));
  write_file("wide.txt", std::string("\xFF\xFEw\0a\0\n\0", 8));
  refused("generate run --prompts wide.txt", "wide.txt: found UTF-16 text, expected UTF-8; save it as UTF-8");
  write_file("latin.txt", "walk\ncaf\xE9\n");
  refused("generate run --prompts latin.txt", "latin.txt:2: found text that is not UTF-8");
  write_file("empty.txt", "# nothing\n");
  refused("generate run --prompts empty.txt", "empty.txt has no prompts; write one per line");
}

}  // namespace captions_test

// Words, vocabularies, caption files and captions made from names.
#include "motiongan/data/captions.hpp"

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "motiongan/data/nearest_descriptions.hpp"

namespace captions_test {

using namespace motiongan;
using namespace motiongan::motion;

TEST_CASE("words are lower-case runs of letters and digits") {
  CHECK(split_words("Walk, on UNEVEN-terrain (2x)!") ==
        std::vector<std::string>{"walk", "on", "uneven", "terrain", "2x"});
  CHECK(split_words("caf\xC3\xA9 na\xC3\xAFve") == std::vector<std::string>{"caf\xC3\xA9", "na\xC3\xAFve"});
  CHECK(split_words(" .,;\t").empty());
}

TEST_CASE("a vocabulary is sorted, starts with <unk>, and does not depend on the captions' order") {
  const std::vector<std::string> captions{"walk slowly", "Jump, walk", "10 jumps"};
  const Vocabulary v = Vocabulary::from_captions(captions);
  CHECK(v.words() == std::vector<std::string>{"<unk>", "10", "jump", "jumps", "slowly", "walk"});
  const std::vector<std::string> other{"10 jumps", "jump walk slowly"};
  CHECK(Vocabulary::from_captions(other).words() == v.words());
  CHECK(v.encode("WALK to jump") == std::vector<int>{5, 0, 2});
  CHECK(v.encode("fly") == std::vector<int>{0});
  CHECK(v.unknown_words("walk to the jump") == std::vector<std::string>{"to", "the"});
  CHECK_THROWS_WITH_AS(v.encode("?!"), doctest::Contains("'?!' has no words"), Error);
  CHECK_THROWS_AS(v.encode(""), Error);
  CHECK(Vocabulary(v.words()).encode("slowly") == std::vector<int>{4});
  CHECK(Vocabulary().words() == std::vector<std::string>{"<unk>"});
  CHECK_THROWS_AS(Vocabulary(std::vector<std::string>{}), Error);
  CHECK_THROWS_AS(Vocabulary({"walk"}), Error);
  CHECK_THROWS_WITH_AS(Vocabulary({"<unk>", "a", "a"}), doctest::Contains("'a', appears twice"), Error);
  CHECK_THROWS_AS(Vocabulary({"<unk>", "A"}), Error);
  CHECK_THROWS_AS(Vocabulary({"<unk>", ""}), Error);
}

TEST_CASE("only the first words of a very long caption are used") {
  std::string caption = "first";
  for (std::size_t i = 1; i < most_caption_words; ++i) caption += " word";
  const std::vector<std::string> captions{caption, caption + " unused" + caption};
  const Vocabulary v = Vocabulary::from_captions(captions);
  CHECK(v.words() == std::vector<std::string>{"<unk>", "first", "word"});
  CHECK(v.encode(captions[0]).size() == 256);
  CHECK(v.encode(captions[1]) == v.encode(captions[0]));
  CHECK(v.unknown_words(captions[1]).empty());
  CHECK(word_limit_note(captions[0]).empty());
  CHECK(word_limit_note(captions[1]) == "has 512 words, of which the first 256 are used");
  std::string letters;  // as many words in as few bytes
  for (std::size_t i = 0; i < 257; ++i) letters += "a ";
  CHECK(word_limit_note(letters) == "has 257 words, of which the first 256 are used");
}

TEST_CASE("a caption has a longest line") {
  const std::string fits(longest_line - 3, 'a'), longer(longest_line - 1, 'a');
  CHECK(parse_captions("w\t" + fits, "c.tsv").at("w").size() == 1);
  CHECK_THROWS_WITH_AS(parse_captions("w\twalks\nw\t" + longer, "c.tsv"),
                       doctest::Contains("c.tsv:2: found a line of 65537 bytes, expected at most 65536"),
                       Error);
  CHECK_THROWS_WITH_AS(parse_caption_csv("w," + longer + "aa", "c.csv"),
                       doctest::Contains("c.csv:1: clip 'w' has a description of 65537 bytes"), Error);
}

TEST_CASE("caption files") {
  const Captions c = parse_captions(
      "\xEF\xBB\xBF# clip\tdescription\r\n01_01\tforward jumps, turn around\r\n\r\n  \n 01_02 \t climb \tup\n"
      "01_01\tplayground\n  # more\n05\tlast",
      "c.tsv");
  REQUIRE(c.size() == 3);
  CHECK(c.at("01_01") == std::vector<std::string>{"forward jumps, turn around", "playground"});
  CHECK(c.at("01_02") == std::vector<std::string>{"climb \tup"});
  CHECK(c.at("05") == std::vector<std::string>{"last"});
  CHECK(parse_captions("", "c.tsv").empty());
  CHECK_THROWS_WITH_AS(parse_captions("a\tb\n\nno tab here\n", "c.tsv"),
                       doctest::Contains("c.tsv:3: found no tab in 'no tab here'"), Error);
  CHECK_THROWS_WITH_AS(parse_captions("a\tb\nx\t\n", "c.tsv"), doctest::Contains("c.tsv:2: clip 'x'"), Error);
  CHECK_THROWS_WITH_AS(parse_captions("x\t - \n", "c.tsv"), doctest::Contains("at least one word"), Error);
  CHECK_THROWS_WITH_AS(parse_captions("\tb\n", "c.tsv"), doctest::Contains("c.tsv:1: found no clip id"),
                       Error);
  CHECK_THROWS_WITH_AS(parse_captions("a\tcaf\xE9\n", "c.tsv"), doctest::Contains("not UTF-8"), Error);
  CHECK_THROWS_WITH_AS(read_captions("/no/such/file"),
                       doctest::Contains("caption file /no/such/file does not exist"), Error);
}

TEST_CASE("captions from names") {
  CHECK(caption_from_name("x/dataset-1_walk_not-confident_001.bvh") == "dataset walk not confident");
  CHECK(caption_from_name("data/jumping/01_07.bvh") == "jumping");
  CHECK(caption_from_name("cmu/01/01_07.bvh") == "01");
  CHECK(caption_from_name("01.bvh") == "motion");
  CHECK(caption_from_name("Run2.bvh") == "run");
}

TEST_CASE("UTF-8 is validated") {
  CHECK(is_utf8(""));
  CHECK(is_utf8("plain"));
  CHECK(is_utf8("\xC3\xA9 \xE6\xAD\xA9 \xF0\x9F\x95\xBA"));
  for (const char* bad :
       {"\xE9", "a\x80", "\xC0\xAF", "\xE0\x80\xAF", "\xED\xA0\x80", "\xF4\x90\x80\x80", "\xC3", "\xFF"})
    CHECK(!is_utf8(bad));
}

TEST_CASE("nearest descriptions share words or their beginnings") {
  const std::vector<std::string> known{"walk", "run / jog", "walk on uneven terrain", "jump", "dance"};
  CHECK(nearest_descriptions(known, "running") == std::vector<std::string>{"run / jog"});
  CHECK(nearest_descriptions(known, "walk") == std::vector<std::string>{"walk", "walk on uneven terrain"});
  CHECK(nearest_descriptions(known, "uneven walks", 1) == std::vector<std::string>{"walk on uneven terrain"});
  CHECK(nearest_descriptions(known, "zzz").empty());
  CHECK(nearest_descriptions({}, "walk").empty());
}

}  // namespace captions_test

// Numbers that are none, out of range or too large: refused by name, before anything is made.
#include <doctest/doctest.h>

#include <initializer_list>

#include "command.hpp"

namespace numbers_test {

namespace {

/// The command must fail with this message and leave the folder as it was.
void refused(const std::string& arguments, const std::string& message) {
  CAPTURE(arguments);
  const Said said = call(arguments);
  CHECK(said.status != 0);
  CHECK_MESSAGE(said.has(message), said.text);
  CHECK(fs::is_empty(fs::current_path()));
}

}  // namespace

TEST_CASE("numbers that are not finite or not whole") {
  const TestFolder folder;
  for (const std::string bad : {"nan", "inf", "-inf", "1e999", "0x10", "two", "3x", "' 3'"}) {
    refused("view x.bvh --rate " + bad, "--rate: ");
    refused("synth clips --seconds=" + bad, "--seconds: expected a finite number, above 0, not ");
    refused("train dvgan --procedural --minutes=" + bad,
            "--minutes: expected a finite number, at least 0, not ");
    refused("ablate dvgan --procedural --save s --save-every=" + bad,
            "--save-every: expected a finite number");
    refused("train dvgan --procedural --batch=" + bad, "--batch: expected ");
    refused("generate run --seed=" + bad, "--seed: expected ");
  }
  refused("train dvgan --procedural --batch 2.5", "--batch: expected a whole number, at least 1, not 2.5");
  refused("train dvgan --procedural --batch 1e3", "--batch: expected a whole number, at least 1, not 1e3");
  refused("search --model m --text t --collection c --top 2.5", "--top: expected a whole number, not 2.5");
  refused("synth clips --seconds ''", "--seconds: expected a finite number, above 0, not nothing");
  refused("evaluate completion x --samples nan", "--samples");
}

TEST_CASE("whole numbers are neither wrapped nor clamped") {
  const TestFolder folder;
  for (const std::string large : {"18446744073709551616", "36893488147419103232", "99999999999999999999999"})
    refused("synth clips --seed " + large,
            "--seed: expected a whole number of at most 18446744073709551615, not " + large);
  refused("synth clips --seed -1", "--seed: expected at least 0, not -1");
  refused("train attention --procedural --batch -1", "--batch: expected at least 1, not -1");
}

TEST_CASE("a number with leading zeros is decimal") {
  const TestFolder folder;
  CHECK(call("synth ten --clips 010 --seconds 1").has("wrote 10 clips"));
  CHECK(call("synth nine --clips +009 --seconds 1").has("wrote 9 clips"));
}

TEST_CASE("steps and iterations that would overflow") {
  const TestFolder folder;
  const std::string all = "18446744073709551615", train = "train dvgan --procedural 4 --save run ";
  CHECK(call(train + "--critic-steps " + all).has("an iteration has " + all + " steps, expected at most"));
  CHECK(call(train + "--iterations " + all).has("iterations is " + all + ", expected at most"));
  CHECK(call("train attention --procedural 4 --save run --generator-steps " + all)
            .has("an iteration has " + all + " steps, expected at most"));
}

TEST_CASE("a training that does not fit is refused at once, with what is needed and what to lower") {
  const TestFolder folder;
  refused("train dvgan --procedural 4 --hidden 100000000", "--hidden: expected 1 to 65536, not 100000000");
  const std::string train = "train dvgan --procedural 4 --frames 16 --save run ";
  for (const std::string size : {"--batch 100000000", "--batch 18446744073709551615", "--hidden 65536"}) {
    CAPTURE(size);
    const Said said = call(train + size);
    CHECK(said.status == 1);
    CHECK_MESSAGE(said.has("motiongan: this training does not fit: the networks have "), said.text);
    CHECK(said.has("lower --batch (now "));
    CHECK_FALSE(fs::exists("run/checkpoint.safetensors"));
  }
  const Said limited =
      shell("MOTIONGAN_MEMORY_MB=1 '" MOTIONGAN_COMMAND "' " + train + "--hidden 16 --batch 4");
  CHECK(limited.status == 1);
  CHECK_MESSAGE(limited.has("1 MB (MOTIONGAN_MEMORY_MB)"), limited.text);
  const Said attention = call("train attention --procedural 20 --save run --batch 100000000");
  CHECK_MESSAGE(attention.has("this training does not fit"), attention.text);
  const Said ranker = call("train ranker --procedural 20 --frames 16 --save run --batch 100000000");
  CHECK_MESSAGE(ranker.has("this training does not fit"), ranker.text);
}

TEST_CASE("a dry run says what a training takes, and writes nothing") {
  const TestFolder folder;
  const auto dry = [](const std::string& arguments, std::initializer_list<const char*> facts) {
    CAPTURE(arguments);
    const Said said = call(arguments + " --dry-run");
    CHECK(said.status == 0);
    for (const char* fact : facts) CHECK_MESSAGE(said.has(fact), std::string(fact), said.text);
    CHECK(fs::is_empty(fs::current_path()));
  };
  const std::string small = " --procedural 8 --hidden 16 --batch 4 ";
  dry("train dvgan" + tiny + "--procedural 6 --iterations 1000",
      {"  generator ", "  critic ", " parameters", "  device ", "  host ", " operations", " an iteration, ",
       " for 1000 iterations"});
  dry("train dvgan" + tiny_rnn + "--procedural 6", {"  generator ", "  critic ", "  time "});
  dry("train ranker --frames 16" + small, {"  ranker ", "  time ", " for 2000 iterations"});
  dry("train attention --frames 8" + small, {"  generator ", "  critic ", "  classifier ", "  time "});
  dry("train attention --frames 8 --model lstm" + small, {"  generator ", "  time "});
  dry("ablate dvgan --frames 16 --variants cnn-cnn-final,rnn-rnn --ranker-hidden 16 --critic-steps 1 --save "
      "s" +
          small,
      {"ranker\n", "cnn-cnn-final\n", "rnn-rnn\n", " for 300 iterations", " for 600 iterations"});
  dry("ablate attention --frames 8 --variants full,lstm --future 8 --save s --procedural 34 --hidden 16 "
      "--batch 4",
      {"full\n", "lstm\n", "  classifier ", " an iteration ("});
}

TEST_CASE("a run that is resumed says what is left") {
  const TestFolder folder;
  REQUIRE(call("train dvgan --procedural 6 --save run --iterations 2" + tiny).status == 0);
  const std::string before = bytes_of("run/checkpoint.safetensors");
  const Said said = call("train dvgan --resume --save run --iterations 5 --dry-run");
  CHECK(said.status == 0);
  CHECK_MESSAGE(said.has(" for 3 iterations"), said.text);
  CHECK(bytes_of("run/checkpoint.safetensors") == before);
  CHECK(std::distance(fs::directory_iterator("run"), fs::directory_iterator()) == 6);
}

}  // namespace numbers_test

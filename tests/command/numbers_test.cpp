// Numbers that are none, out of range or too large: refused by name, before anything is made.
#include <doctest/doctest.h>

#include "command.hpp"

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

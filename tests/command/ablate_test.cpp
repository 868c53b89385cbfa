// The second paper's comparison through the command: seven tiny trainings, their tables, and going on.
#include <doctest/doctest.h>

#include <algorithm>

#include <limits>
#include <motiongan/io/safetensors.hpp>
#include <sstream>

#include "command.hpp"
#include "motiongan/train/csv_log.hpp"

namespace ablate_test {

namespace {

const std::string small =
    "ablate attention --procedural 36 --classes walk,run --frames 8 --rate 8 --hidden 8 --batch 4 "
    "--critic-steps 1 --future 20 --windows 6 --log-every 1";

std::string checkpoint(const std::string& folder) { return bytes_of(folder + "/checkpoint.safetensors"); }

std::size_t lines_of(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace

TEST_CASE("all seven variants are trained, measured and drawn; a second call trains nothing") {
  const TestFolder folder;
  const Said said = call(small + " --iterations 2 --save cmp --unit-metres 0.01");
  CHECK_MESSAGE(said.status == 0, said.text);
  CHECK(said.has("lstm seed-1: finished after 2 iterations"));
  CHECK(said.has("the paper says"));
  CHECK(said.has("measured on test clips: run (3 windows of 1 clip), walk (3 windows of 1 clip)"));
  CHECK(said.has("seam mm"));
  const std::string table = bytes_of("cmp/table.csv");
  for (const char* name :
       {"truth", "full", "no_attention", "no_blend", "no_skeleton", "no_losses", "neither", "lstm", "still"})
    CHECK(table.find("\n" + std::string(name) + ",") != std::string::npos);
  CHECK(table.find("\nfull,2,") != std::string::npos);
  CHECK(lines_of(table) == 10);
  CHECK(lines_of(bytes_of("cmp/runs.csv")) == 8);
  CHECK(lines_of(bytes_of("cmp/angles.csv")) == 21);
  CHECK(bytes_of("cmp/angles.csv")
            .starts_with(
                "frame,seconds,truth,full,no_attention,no_blend,no_skeleton,no_losses,neither,lstm\n"));
  for (const char* picture : {"angles.png", "strip_10s.png", "strip_30s.png"})
    CHECK(bytes_of(fs::path("cmp") / picture).starts_with("\x89PNG"));

  // Without a word of the data: they are those of the first training.
  const std::string before = checkpoint("cmp/full/seed-1");
  const Said again =
      call("ablate attention --save cmp --iterations 2 --future 20 --windows 6 --unit-metres 0.01");
  CHECK_MESSAGE(again.status == 0, again.text);
  CHECK(again.has("full seed-1: already trained"));
  CHECK(again.has("lstm seed-1: already trained"));
  CHECK_FALSE(again.has("training for"));
  CHECK(checkpoint("cmp/full/seed-1") == before);
  CHECK(bytes_of("cmp/table.csv") == table);

  SUBCASE("models of other data are not measured as if test clips were strange to them") {
    const Said other = call(small + " --save cmp --evaluate-only --split-seed 5");
    CHECK(other.status == 1);
    CHECK_MESSAGE(other.has("this model was trained on other data"), other.text);
  }
  SUBCASE("some of them, and some that are not there") {
    fs::remove_all("cmp/no_blend");
    const Said some = call(small + " --save cmp --evaluate-only");
    CHECK(some.status == 0);
    CHECK(some.has("not trained, left out: no_blend"));
    CHECK(lines_of(bytes_of("cmp/table.csv")) == 9);
    const Said asked = call(small + " --save cmp --evaluate-only --variants no_blend");
    CHECK(asked.status == 1);
    CHECK(asked.has("there is no model of the variant no_blend"));
  }
}

TEST_CASE("a variant that had a part of its budget goes on to the same bits") {
  const TestFolder folder;
  const std::string two = small + " --variants full,lstm";
  REQUIRE(call(two + " --save whole --iterations 3").status == 0);
  REQUIRE(call(two + " --save parts --iterations 1").status == 0);
  CHECK(checkpoint("parts/full/seed-1") != checkpoint("whole/full/seed-1"));
  // As if it had been killed before the variant was marked as finished.
  fs::remove("parts/full/seed-1/finished.json");
  const Said rest = call(two + " --save parts --iterations 3");
  CHECK_MESSAGE(rest.status == 0, rest.text);
  CHECK(rest.has("full seed-1: training for 3 iterations; 1 iteration ("));
  CHECK(rest.has("lstm seed-1: training for 3 iterations; 1 iteration ("));
  CHECK(checkpoint("parts/full/seed-1") == checkpoint("whole/full/seed-1"));
  CHECK(checkpoint("parts/lstm/seed-1") == checkpoint("whole/lstm/seed-1"));
  CHECK(motiongan::read_csv_log("parts/full/seed-1/log.csv").column("iteration") ==
        std::vector<double>{1, 2, 3});
  CHECK(bytes_of("parts/table.csv") == bytes_of("whole/table.csv"));
}

TEST_CASE("with several seeds the tables hold their mean, and runs.csv each of them") {
  const TestFolder folder;
  const std::string two = small + " --variants full,lstm --iterations 1 --save cmp";
  REQUIRE(call(two).status == 0);
  const std::string first = checkpoint("cmp/full/seed-1");
  const Said said = call(two + " --seeds 2");
  CHECK_MESSAGE(said.status == 0, said.text);
  CHECK(said.has("full seed-1: already trained"));
  CHECK(said.has("full seed-2: finished after 1 iteration"));
  CHECK(said.has(" ± "));
  CHECK(said.has("even: within 10% or two standard errors"));
  CHECK(checkpoint("cmp/full/seed-1") == first);
  CHECK(checkpoint("cmp/full/seed-2") != first);
  const auto column = [](const char* file, const char* variant) {
    std::istringstream lines(bytes_of(file));
    std::vector<double> out;
    for (std::string line; std::getline(lines, line);) {
      std::vector<std::string> cells;
      std::istringstream parts(line);
      for (std::string cell; std::getline(parts, cell, ',');) cells.push_back(cell);
      // curve_error_deg follows the iterations.
      if (cells[0] == variant)
        out.push_back(std::stod(cells[std::string(file).ends_with("runs.csv") ? 3 : 2]));
    }
    return out;
  };
  const std::vector<double> runs = column("cmp/runs.csv", "full"), mean = column("cmp/table.csv", "full");
  REQUIRE(runs.size() == 2);
  REQUIRE(mean.size() == 1);
  CHECK(runs[0] != runs[1]);
  CHECK(mean[0] == doctest::Approx((runs[0] + runs[1]) / 2).epsilon(1e-4));

  // A comparison of an earlier version has its one seed in the variant's own folder.
  fs::create_directory("old");
  for (const char* variant : {"full", "lstm"})
    fs::rename(fs::path("cmp") / variant / "seed-1", fs::path("old") / variant);
  const Said old =
      call("ablate attention --save old --iterations 1 --future 20 --windows 6 --variants full,lstm");
  CHECK_MESSAGE(old.has("full seed-1: already trained"), old.text);
  CHECK_MESSAGE(old.has("lstm seed-1: already trained"), old.text);
}

TEST_CASE("a damaged checkpoint is an error, a run that diverges is reported and left") {
  const TestFolder folder;
  const std::string two = small + " --variants full,lstm --save cmp";
  REQUIRE(call(two + " --iterations 1").status == 0);
  // A damaged file is not a run that diverged: it must not count as finished.
  const fs::path checkpoint_file = "cmp/full/seed-1/checkpoint.safetensors";
  const auto whole = motiongan::io::SafeTensors::read(checkpoint_file);
  auto damaged = whole;
  auto& bias = damaged.tensors.at("generator.decode.bias");
  std::vector<float> values = bias.as<float>();
  values[0] = std::numeric_limits<float>::quiet_NaN();
  bias = motiongan::io::SafeTensor::of(bias.shape, values);
  damaged.write(checkpoint_file);
  fs::remove("cmp/full/seed-1/finished.json");
  const Said refused = call(two + " --iterations 3");
  CHECK(refused.status == 1);
  CHECK_MESSAGE(refused.has("generator.decode.bias"), refused.text);
  CHECK_FALSE(fs::exists("cmp/full/seed-1/finished.json"));
  // One that really diverges costs the others nothing.
  whole.write(checkpoint_file);
  const Said diverged =
      call(small + " --variants full,lstm --save wild --iterations 40 --learning-rate 1e30");
  CHECK_MESSAGE(diverged.has("full seed-1: training diverged by iteration"), diverged.text);
  CHECK_MESSAGE(diverged.has("lstm seed-1: training for"), diverged.text);
}

TEST_CASE("minutes are a budget too: a variant ends with them and is not trained again") {
  const TestFolder folder;
  const Said said = call(small + " --variants lstm --minutes 0.02 --save cmp");
  CHECK_MESSAGE(said.status == 0, said.text);
  CHECK(said.has("lstm seed-1: training for 1.2 s"));
  const std::string before = checkpoint("cmp/lstm/seed-1");
  CHECK(call(small + " --variants lstm --minutes 0.02 --save cmp").has("lstm seed-1: already trained"));
  CHECK(checkpoint("cmp/lstm/seed-1") == before);
  const Said more = call(small + " --variants lstm --minutes 0.03 --save cmp");
  CHECK_MESSAGE(more.has("already done"), more.text);
  CHECK(checkpoint("cmp/lstm/seed-1") != before);
}

TEST_CASE("a comparison that cannot be is refused before it begins") {
  const TestFolder folder;
  const auto refused = [](const std::string& arguments, const std::string& why) {
    const Said said = call(arguments);
    CHECK(said.status == 1);
    CHECK_MESSAGE(said.has(why), said.text);
  };
  refused("ablate attention --save cmp", "there is nothing to compare on");
  refused(small + " --save cmp --variants full,half", "there is no variant 'half'");
  refused(small + " --save cmp --evaluate-only", "there is no model in cmp");
  std::string long_future = small;
  long_future.replace(long_future.find("--future 20"), 11, "--future 500");
  refused(long_future + " --save cmp", "test clips lasts 508 frames");
  refused(small + " --save cmp --minutes 0", "there is no limit on the training");
  CHECK_FALSE(fs::exists("cmp/full"));
  CHECK(call(small).status > 1);  // no --save: usage
}

}  // namespace ablate_test

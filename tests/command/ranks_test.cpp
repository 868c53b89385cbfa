// Trainings divided among ranks by the command: the same bits with any number of processes, also after one of
// them was killed.
#include <doctest/doctest.h>

#include "../support/expmap_files.hpp"
#include "command.hpp"

namespace ranks_test {

namespace {

const std::string training =
    "train dvgan clips --frames 16 --hidden 8 --batch 8 --critic-steps 2 --split-seed 3 --shards 4 ";

/// The command on several processes, two threads of OpenCL at most for each.
std::string on_ranks(int ranks, const std::string& arguments) {
  return "POCL_MAX_PTHREAD_COUNT=1 timeout 120 mpirun --allow-run-as-root --oversubscribe --bind-to none "
         "-n " +
         std::to_string(ranks) + " '" + MOTIONGAN_COMMAND + "' " + arguments;
}

bool has_mpi() {
  if (shell("mpirun --version").status != 0) {
    MESSAGE("skipped: there is no mpirun; on Debian: apt-get install openmpi-bin libopenmpi-dev");
    return false;
  }
  const TestFolder folder;
  if (!shell(on_ranks(2, "train dvgan none --save none")).has("without MPI")) return true;
  MESSAGE("skipped: the command was built without MPI");
  return false;
}

}  // namespace

TEST_CASE("--shards: a resumed run keeps them, and ends as one that was not stopped") {
  const TestFolder folder;
  REQUIRE(call("synth clips --clips 6 --seconds 5").status == 0);
  REQUIRE(call(training + "--save whole --iterations 4").status == 0);
  REQUIRE(call(training + "--save parts --iterations 2").status == 0);
  const Said rest = call("train dvgan --resume --save parts --iterations 4");
  CHECK_MESSAGE(rest.status == 0, rest.text);
  CHECK(bytes_of("parts/generator.safetensors") == bytes_of("whole/generator.safetensors"));
  const Said other = call("train dvgan --resume --save parts --iterations 5 --shards 8");
  CHECK(other.status != 0);
  CHECK_MESSAGE(other.has("the run was started with --shards 4"), other.text);
  const Said uneven = call("train dvgan clips --frames 16 --hidden 8 --batch 9 --shards 4 --save uneven");
  CHECK(uneven.status != 0);
  CHECK_MESSAGE(uneven.has("a batch of 9 cannot be cut into 4 shards of equal size"), uneven.text);
}

TEST_CASE("mpirun: the same bits with 1, 2 and 4 processes, and other options are refused") {
  if (!has_mpi()) return;
  const TestFolder folder;
  REQUIRE(call("synth clips --clips 6 --seconds 5").status == 0);
  REQUIRE(call(training + "--save one --iterations 3").status == 0);
  for (const int ranks : {2, 4}) {
    const std::string save = "on" + std::to_string(ranks);
    const Said said = shell(on_ranks(ranks, training + "--iterations 3 --save " + save));
    CHECK_MESSAGE(said.status == 0, said.text);
    CHECK(said.has("finished after 3 of 3 iterations"));
    CHECK(bytes_of(save + "/generator.safetensors") == bytes_of("one/generator.safetensors"));
    CHECK(bytes_of(save + "/critic.safetensors") == bytes_of("one/critic.safetensors"));
  }
  const std::string rank = "'" + std::string(MOTIONGAN_COMMAND) + "' " + training;
  const Said said = shell("timeout 120 mpirun --allow-run-as-root --oversubscribe -n 1 " + rank +
                          "--save no --iterations 3 : -n 1 " + rank + "--save no --iterations 3 --lambda 5");
  CHECK(said.status != 0);
  CHECK_MESSAGE(said.has("rank 1 was started with another training than rank 0: \"training\" is"), said.text);
}

TEST_CASE("mpirun: generate shares the motions, and writes the files that one process writes") {
  if (!has_mpi()) return;
  const TestFolder folder;
  REQUIRE(call("synth clips --clips 6 --seconds 5").status == 0);
  REQUIRE(call(training + "--save text --iterations 1").status == 0);
  REQUIRE(
      call("train attention --procedural 51 --save classes --iterations 1 --frames 8 --rate 10 --hidden 8 "
           "--batch 4 --critic-steps 1 --noise 4 --classes walk,run")
          .status == 0);
  for (const char* what : {"text --text walk --text run --count 5 --first-sample 2",
                           "classes --class walk --seconds 2 --count 3"}) {
    CAPTURE(what);
    fs::remove_all("one");
    fs::remove_all("three");
    REQUIRE(call(std::string("generate ") + what + " --out one").status == 0);
    const Said said = shell(on_ranks(3, std::string("generate ") + what + " --out three"));
    CHECK_MESSAGE(said.status == 0, said.text);
    std::size_t files = 0;
    for (const auto& entry : fs::directory_iterator("one")) {
      CHECK(bytes_of(entry.path()) == bytes_of("three" / entry.path().filename()));
      ++files;
    }
    CHECK(files ==
          static_cast<std::size_t>(std::distance(fs::directory_iterator("three"), fs::directory_iterator())));
  }
  const Said page = shell(on_ranks(2, "generate text --text walk --html page.html"));
  CHECK(page.status != 0);
  CHECK_MESSAGE(page.has("--html needs all motions in one process"), page.text);
}

TEST_CASE("mpirun: ranks train different variants; the first waits, and reports as one process does") {
  if (!has_mpi()) return;
  const TestFolder folder;
  const std::string attention =
      "ablate attention --procedural 36 --classes walk,run --frames 8 --rate 8 --hidden 8 --batch 4 "
      "--critic-steps 1 --future 20 --windows 6 --variants full,lstm,no_attention --iterations 2 --save ";
  const std::string dvgan =
      "ablate dvgan clips --variants cnn-cnn-final,rnn-cnn-dense --seeds 1 --frames 16 --hidden 8 --batch 4 "
      "--critic-steps 1 "
      "--ranker-hidden 8 --ranker-iterations 2 --samples 2 --descriptions 3 --iterations 1 --save ";
  motiongan::testing::write_small_h36m("h36m");
  const std::string completion =
      "evaluate completion h36m --models zero,lstm,seq2seq,dvgan --hidden 8 --batch 2 --dvgan-hidden 8 "
      "--dvgan-batch 2 --dvgan-frames 8 --critic-steps 1 --samples 3 --iterations 2 --dvgan-iterations 1 "
      "--save ";
  REQUIRE(call("synth clips --clips 8 --seconds 5").status == 0);
  for (const std::string& what : {attention, dvgan, completion}) {
    CAPTURE(what);
    for (const char* save : {"one", "shared"}) fs::remove_all(save);
    const Said alone = call(what + "one"), shared = shell(on_ranks(2, what + "shared"));
    CHECK_MESSAGE(alone.status == 0, alone.text);
    CHECK_MESSAGE(shared.status == 0, shared.text);
    std::size_t models = 0;
    for (const auto& entry : fs::recursive_directory_iterator("one")) {
      const fs::path other = "shared" / entry.path().lexically_relative("one");
      CHECK_MESSAGE(fs::exists(other), other.string());
      if (entry.path().extension() != ".safetensors" || entry.path().filename() == "checkpoint.safetensors")
        continue;
      CHECK_MESSAGE(bytes_of(entry.path()) == bytes_of(other), other.string());
      ++models;
    }
    CHECK(models >= 3);
    CHECK(bytes_of("one/table.csv") == bytes_of("shared/table.csv"));
  }
}

TEST_CASE("mpirun: the ranks of a search compare a part of the collection each") {
  if (!has_mpi()) return;
  const TestFolder folder;
  REQUIRE(call("synth clips --clips 6 --seconds 6").status == 0);
  REQUIRE(call(training + "--save run --iterations 1").status == 0);
  for (const char* what : {"", " --windows --hop 2 --top 30"}) {
    const std::string search = std::string("search --model run --text walk --collection clips") + what;
    fs::remove_all("clips/.motiongan-search");
    const Said shared = shell(on_ranks(3, search + " --json three.json"));
    CHECK_MESSAGE(shared.status == 0, shared.text);
    CHECK(shared.has("6 files read"));
    REQUIRE(call(search + " --json one.json").status == 0);
    CHECK(bytes_of("one.json") == bytes_of("three.json"));
  }
}

TEST_CASE("mpirun: a verb of one process is refused") {
  if (!has_mpi()) return;
  const TestFolder folder;
  const Said said = shell(on_ranks(2, "devices"));
  CHECK(said.status != 0);
  CHECK_MESSAGE(said.has("motiongan devices works in one process, and 2 were started"), said.text);
}

TEST_CASE("mpirun: a rank is killed; the job ends, and goes on with another number of ranks") {
  if (!has_mpi()) return;
  const TestFolder folder;
  REQUIRE(call("synth clips --clips 6 --seconds 5").status == 0);
  const Said killed =
      shell("(" + on_ranks(2, training + "--save run --iterations 100000 --save-every 0.01") +
            "; echo ended with $?) & while ! grep -q ^3, run/log.csv 2>/dev/null; do sleep 0.2; done; "
            "sleep 1; pkill -9 -n -f -- '--save run --iterations 100000'; wait");
  CHECK_MESSAGE(killed.has("ended with"), killed.text);
  CHECK_FALSE(killed.has("ended with 0"));
  REQUIRE(fs::exists("run/checkpoint.safetensors"));
  const Said info = call("info run/checkpoint.safetensors");
  const std::size_t at = info.text.find("iteration");
  REQUIRE_MESSAGE(at != std::string::npos, info.text);
  const long done = std::stol(info.text.substr(info.text.find_first_of("0123456789", at)));
  const std::string more = std::to_string(done + 2);
  const Said rest = shell(on_ranks(4, "train dvgan --resume --save run --iterations " + more));
  CHECK_MESSAGE(rest.status == 0, rest.text);
  REQUIRE(call(training + "--save whole --iterations " + more).status == 0);
  CHECK(bytes_of("run/generator.safetensors") == bytes_of("whole/generator.safetensors"));
}

}  // namespace ranks_test

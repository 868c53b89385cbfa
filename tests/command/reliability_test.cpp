// What the command keeps and says when it is stopped, runs twice, diverges or cannot print.
#include <doctest/doctest.h>

#include <motiongan/train/csv_log.hpp>
#include <motiongan/train/run_folder.hpp>

#include "command.hpp"

namespace reliability_test {

using motiongan::read_run_record;

namespace {

const std::string command = std::string("'") + MOTIONGAN_COMMAND + "'";
const std::string train = "train dvgan --procedural 6 --log-every 1" + tiny;

/// Starts a training, waits for rows of its log, and then runs `then`, in which $pid is its process.
Said while_training(const std::string& then, const std::string& before = "", const std::string& after = "") {
  return shell(
      before + in_background + train + " --save run " + after +
      " & pid=$!; for i in $(seq 600); do [ $(cat run/log.csv 2>/dev/null | wc -l) -gt 3 ] && break; "
      "sleep 0.05; done; " +
      then);
}

}  // namespace

TEST_CASE("SIGTERM, SIGHUP and a broken pipe stop a run and save it") {
  for (const auto& [name, status] : {std::pair{"TERM", 143}, {"HUP", 129}, {"PIPE", 141}}) {
    CAPTURE(name);
    const TestFolder folder;
    const Said said = while_training(std::string("kill -") + name + " $pid; wait $pid");
    CHECK_MESSAGE(said.status == status, said.text);
    CHECK(said.has("saved in run"));
    CHECK(read_run_record("run/checkpoint.safetensors").iteration >= 3);
  }
}

TEST_CASE("a second signal of another kind ends the process at once") {
  const TestFolder folder;
  // Both are pending when the process goes on: nothing depends on its speed.
  const Said said =
      while_training("kill -STOP $pid; kill -TERM $pid; kill -INT $pid; kill -CONT $pid; wait $pid");
  CHECK_MESSAGE((said.status == 143 || said.status == 130), said.text);
  CHECK_FALSE(said.has("saved in run"));
}

TEST_CASE("a signal that was ignored at the start stays ignored") {
  const TestFolder folder;
  const Said said = while_training(
      "kill -HUP $pid; n=$(cat run/log.csv | wc -l); for i in $(seq 600); do [ $(cat run/log.csv | wc -l) "
      "-gt "
      "$((n + 2)) ] && break; sleep 0.05; done; kill -INT $pid; wait $pid",
      "trap '' HUP; ");
  CHECK_MESSAGE(said.status == 130, said.text);
  CHECK(said.has("saved in run"));
}

TEST_CASE("a second process in a folder is refused and names the first") {
  const TestFolder folder;
  const Said said =
      while_training(command + " " + train + " --save run; echo first $?; " + command +
                     " train dvgan --resume --save run; echo second $?; echo pid $pid; kill -INT "
                     "$pid; wait $pid");
  CHECK(said.status == 130);
  CHECK(said.has("first 1"));
  CHECK(said.has("second 1"));
  const std::size_t at = said.text.find("pid ");
  REQUIRE(at != said.text.npos);
  const std::string pid = said.text.substr(at + 4, said.text.find('\n', at) - at - 4);
  CHECK_MESSAGE(said.has("run is in use by process " + pid + " on "), said.text);
  // Nothing of the first was moved or written over.
  CHECK_FALSE(fs::exists("run/log.unsaved.csv"));
  CHECK(motiongan::read_csv_log("run/log.csv").rows.size() ==
        read_run_record("run/checkpoint.safetensors").iteration);
}

TEST_CASE("a run that diverges keeps its last good checkpoint and has a status of its own") {
  const TestFolder folder;
  // It saves after every iteration: on a fast device all is over within a fraction of a second.
  const Said said = call(
      "train dvgan --procedural 4 --hidden 8 --frames 8 --rate 8 --batch 2 --critic-steps 1 --iterations "
      "4000 --save-every 1e-6 --learning-rate 0.8 --save run");
  CHECK_MESSAGE(said.status == 3, said.text);
  CHECK(said.has("motiongan: training diverged by iteration "));
  const std::size_t kept = read_run_record("run/checkpoint.safetensors").iteration;
  const Said resumed = call("train dvgan --resume --save run --iterations " + std::to_string(kept + 1));
  CHECK_MESSAGE(resumed.has("resuming after iteration " + std::to_string(kept)), resumed.text);
  CHECK((resumed.status == 0 || resumed.status == 3));

  const Said huge = call(
      "train dvgan --procedural 4 --hidden 8 --frames 8 --rate 8 --batch 2 --iterations 2 "
      "--lambda 1e25 --save huge");
  CHECK_MESSAGE(huge.status == 3, huge.text);
  CHECK_FALSE(fs::exists("huge/checkpoint.safetensors"));
}

TEST_CASE("closed standard streams do not take the place of files") {
  const TestFolder folder;
  CHECK(shell(command + " " + train + " --iterations 3 --save run <&- >&- 2>&-").status == 0);
  CHECK(motiongan::read_csv_log("run/log.csv").rows.size() == 3);
}

TEST_CASE("output that cannot be written is an error") {
  const TestFolder folder;
  for (const char* what : {"--help", "--version", "devices", "train dvgan --help"}) {
    CAPTURE(what);
    CHECK(shell(command + " " + what + " 2>/dev/null >/dev/full").status == 1);
  }
  CHECK(shell(command + " devices 2>&1 >/dev/full").has("No space left on device"));
}

TEST_CASE("a table can go to standard output and to a pipe") {
  const TestFolder folder;
  REQUIRE(call("synth clips --clips 2 --seconds 4").status == 0);
  const Said said = call("compare --generated clips --real clips --csv /dev/stdout");
  CHECK_MESSAGE(said.status == 0, said.text);
  CHECK(said.has(","));
  CHECK(shell("mkfifo pipe; timeout 60 cat pipe > copy & " + command +
              " compare --generated clips --real clips --csv pipe; wait")
            .status == 0);
  CHECK(bytes_of("copy").size() > 100);
  CHECK(fs::is_fifo("pipe"));
}

}  // namespace reliability_test

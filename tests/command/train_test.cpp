// Training through the command: what it says, stopping and resuming, and what it refuses.
#include <doctest/doctest.h>

#include <cstdlib>

#include "command.hpp"
#include "motiongan/io/safetensors.hpp"
#include "motiongan/train/csv_log.hpp"

namespace train_test {

namespace {

std::string checkpoint(const std::string& folder) { return bytes_of(folder + "/checkpoint.safetensors"); }

}  // namespace

TEST_CASE("a run that is stopped and resumed ends bit-equal to one that was not") {
  const TestFolder folder;
  REQUIRE(call("synth clips --clips 6 --seconds 5").status == 0);
  const Said whole = call("train dvgan clips --save whole --iterations 4" + tiny);
  CHECK(whole.status == 0);
  CHECK(whole.has("4 for training, 2 held out for testing"));
  CHECK(whole.has("from clips/captions.tsv"));
  CHECK(whole.has("finished after 4 of 4 iterations; saved in whole"));
  for (const char* file :
       {"generator.safetensors", "critic.safetensors", "checkpoint.safetensors", "log.csv", "split.tsv"})
    CHECK(fs::exists(fs::path("whole") / file));

  REQUIRE(call("train dvgan clips --save parts --iterations 2" + tiny).status == 0);
  CHECK(checkpoint("parts") != checkpoint("whole"));
  const Said rest =
      call("train dvgan --resume --save parts --iterations 4");  // the options are in the checkpoint
  CHECK(rest.status == 0);
  CHECK(rest.has("resuming after iteration 2"));
  CHECK(checkpoint("parts") == checkpoint("whole"));
  CHECK(bytes_of("parts/generator.safetensors") == bytes_of("whole/generator.safetensors"));
  CHECK(motiongan::read_csv_log("parts/log.csv").column("iteration") == std::vector<double>{1, 2, 3, 4});

  SUBCASE("a finished run says so, and a run is not written over") {
    CHECK(call("train dvgan --resume --save parts").has("has all its 4 iterations already"));
    const Said again = call("train dvgan clips --save parts" + tiny);
    CHECK(again.status == 1);
    CHECK(again.has("motiongan: parts already holds a run; continue it with --resume"));
  }
  SUBCASE("other options are refused when resuming") {
    const Said batch = call("train dvgan --resume --save parts --iterations 5 --batch 8");
    CHECK(batch.status == 1);
    CHECK(batch.has("the run was started with batch = 4, now it is 8"));
    const Said rate = call("train dvgan --resume --save parts --iterations 5 --rate 5");
    CHECK(rate.status == 1);
    CHECK(rate.has("started with other data"));
    CHECK(checkpoint("parts") == checkpoint("whole"));
  }
}

TEST_CASE("the suggested command can be pasted into a shell, and long captions are cut") {
  const TestFolder folder;
  REQUIRE(call("synth clips --clips 2 --seconds 5").status == 0);
  std::string captions;
  for (const char* id : {"walk_000", "run_001"}) captions += std::string(id) + "\tshe \"goes\" `on` $5\n";
  write_file("clips/captions.tsv", captions);
  const Said said = call("train dvgan clips --save 'my run' --iterations 1" + tiny);
  CHECK_MESSAGE(said.status == 0, said.text);
  CHECK_MESSAGE(said.has("generate \"my run\" --text 'she \"goes\" `on` $5'"), said.text);
  std::string line = "walk_000\tshe goes";
  for (int i = 0; i < 300; ++i) line += " on";
  write_file("clips/captions.tsv", line + "\nrun_001\tgoes\n");
  const Said cut = call("train dvgan clips --save cut --iterations 1" + tiny);
  CHECK_MESSAGE(cut.status == 0, cut.text);
  CHECK_MESSAGE(cut.has("'walk_000': its caption has 302 words, of which the first 256 are used"), cut.text);
  const std::string longer = line.substr(line.find('\t') + 1);
  CHECK(call("generate cut --text '" + longer + "'")
            .has("a text has 302 words, of which the first 256 are used"));
}

TEST_CASE("the recurrent networks: any number of frames, stopped and resumed") {
  const TestFolder folder;
  const std::string train =
      "train dvgan --procedural 6 --generator rnn --critic rnn --frames 12 --hidden 8 --batch 4 "
      "--critic-steps 1";
  const Said whole = call(train + " --save whole --iterations 3");
  CHECK(whole.status == 0);
  CHECK_MESSAGE(whole.has("RNN, "), whole.text);
  REQUIRE(call(train + " --save parts --iterations 1").status == 0);
  REQUIRE(call("train dvgan --resume --save parts --iterations 3").status == 0);
  CHECK(checkpoint("parts") == checkpoint("whole"));
  const Said model = call("info whole/generator.safetensors");
  CHECK(model.has("dvgan_rnn_generator"));
  CHECK(model.has("final-cut off"));
  const Said leaky = call(train + " --leak 0.1 --iterations 1 --save leaky");
  CHECK_MESSAGE(leaky.has("leak 0.1"), leaky.text);
  CHECK(call("info leaky/generator.safetensors").has("leak 0.1"));
  CHECK(call("train dvgan --procedural 6 --leak 0.1 --save other").has("--leak needs --generator rnn"));
  const Said cnn_critic = call("train dvgan --procedural 6 --generator rnn --frames 12 --save other");
  CHECK(cnn_critic.status == 1);
  CHECK(cnn_critic.has("12; the nearest are 8 and 16"));
  CHECK(call("train dvgan --procedural 6 --generator gru --save other").status > 1);  // usage
}

TEST_CASE("Ctrl-C saves and says how to go on; a killed run resumes from its last checkpoint") {
  const TestFolder folder;
  const std::string train = "train dvgan --procedural 6 --log-every 1" + tiny;
  const std::string start = in_background + train;
  // Runs until some rows of the log are there, then gets the signal.
  const auto interrupt = [&](const std::string& save, const std::string& more, const std::string& signal) {
    return shell(start + " --save " + save + more + " & pid=$!; for i in $(seq 600); do " + "[ $(cat " +
                 save + "/log.csv 2>/dev/null | wc -l) -gt 4 ] && " + "[ -e " + save + "/" +
                 (signal == "KILL" ? "checkpoint.safetensors" : "log.csv") +
                 " ] && break; sleep 0.1; done; " + "kill -" + signal + " $pid; wait $pid");
  };
  const Said stopped = interrupt("stopped", "", "INT");
  CHECK(stopped.status == 130);
  CHECK(stopped.has("of 20000 iterations; saved in stopped"));
  CHECK(stopped.has("motiongan train dvgan --resume --save stopped"));

  const Said killed = interrupt("killed", " --save-every 0.001", "KILL");
  CHECK(killed.status == 128 + 9);
  const std::size_t done =
      std::stoul(motiongan::io::SafeTensors::read("killed/checkpoint.safetensors").metadata.at("iteration"));
  const std::string to = std::to_string(done + 2);
  const Said resumed = call("train dvgan --resume --save killed --iterations " + to);
  CHECK(resumed.status == 0);
  CHECK(resumed.has("resuming after iteration " + std::to_string(done)));
  CHECK(resumed.has("finished after " + to + " of " + to + " iterations"));
  REQUIRE(call(train + " --save whole --iterations " + to).status == 0);
  CHECK(checkpoint("killed") == checkpoint("whole"));
}

TEST_CASE("a training that cannot be is refused before it begins") {
  const TestFolder folder;
  REQUIRE(call("synth clips --clips 3 --seconds 5").status == 0);
  const auto refused = [](const std::string& arguments, const std::string& why) {
    const Said said = call("train dvgan " + arguments);
    CHECK(said.status == 1);
    CHECK_MESSAGE(said.has(why), said.text);
    CHECK(said.has("motiongan: "));
    CHECK_FALSE(fs::exists("save"));  // the default of --save is below it
  };
  refused("", "there is nothing to train on");
  refused("nowhere", "nowhere does not exist");
  refused("clips --procedural 4", "not both");
  refused("clips --frames 33", "33; the nearest are 32 and 64");
  refused("clips --frames 64", "none of 3 clips holds 64 frames at 4 per second");
  refused("--resume", "--resume needs --save");
  refused("--resume --save empty", "there is no run to resume in empty");
  refused("clips --save clips/walk_000.bvh", "cannot create the folder");
  write_file("bad.tsv", "walk_000\twalk\nrun_001 run\n");
  refused("clips --captions bad.tsv --frames 16", "bad.tsv:2: found no tab");
  write_file("mute.tsv", "walk_000\t...\n");
  refused("clips --captions mute.tsv --frames 16", "mute.tsv:1: clip 'walk_000' has the description '...'");
  write_file("clips/walk_000.bvh", bytes_of("clips/walk_000.bvh").substr(0, 2000));
  refused("clips --frames 16", "walk_000.bvh:");
  fs::create_directory("broken");
  write_file("broken/checkpoint.safetensors", "not a checkpoint");
  refused("--resume --save broken", "broken/checkpoint.safetensors");
  refused("clips --device tpu", "no OpenCL device matches \"tpu\"");
  CHECK(call("train dvgan clips --validation deep").status > 1);  // usage
}

TEST_CASE("a run of an earlier version is described, generates and resumes") {
  const char* set = std::getenv("MOTIONGAN_SHARED");
  const fs::path shared = set ? fs::path(set) : fs::path(MOTIONGAN_SOURCE_DIR) / "../shared";
  const fs::path run = shared / "models/cmu-cnn-6115", clips = shared / "data/cmu";
  if (!fs::exists(run) || !fs::exists(clips)) {
    MESSAGE("skipped: there is no ", run.string(), " with the clips it was trained on");
    return;
  }
  const TestFolder folder;
  fs::create_directory("run");
  for (const auto& entry : fs::directory_iterator(run)) {
    fs::copy(entry.path(), "run" / entry.path().filename());
    fs::permissions("run" / entry.path().filename(), fs::perms::owner_write, fs::perm_options::add);
  }
  const Said info = call("info run");
  CHECK_MESSAGE(info.has("validation dense"), info.text);
  CHECK(call("generate run --text walk").has("walk_000.bvh"));
  const std::string data = fs::absolute(clips).lexically_normal().string();
  const Said more = call("train dvgan --resume --save run --iterations 6116 " + data + " --captions " + data +
                         "/captions.tsv");
  CHECK_MESSAGE(more.status == 0, more.text);
  CHECK(more.has("finished after 6116 of 6116 iterations"));
}

}  // namespace train_test

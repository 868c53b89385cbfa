// The demo, cut short, and the verbs that need no model.
#include <doctest/doctest.h>

#include "command.hpp"

namespace demo_test {

TEST_CASE("the demo writes what it promises, again and again, and spares other people's folders") {
  const TestFolder folder;
  for (int i = 0; i < 2; ++i) {
    const Said said = call("demo --minutes 0.01");
    CHECK_MESSAGE(said.status == 0, said.text);
    CHECK(said.has("wrote demo-out/shipped: 12 BVH files"));
    CHECK(said.has("wrote demo-out/bvh: 18 BVH files"));
    CHECK(said.has("The Wasserstein estimate"));
    CHECK(said.has("motiongan train dvgan my-clips"));
    for (const char* file : {"shipped.html", "shipped.png", "shipped/walk.bvh", "shipped/karate.bvh",
                             "motions.html", "poses.png", "training.png", "README.txt",
                             "bvh/walk_generated_1.bvh", "save/generator.safetensors"})
      CHECK(fs::exists(fs::path("demo-out") / file));
    const fs::directory_iterator shipped("demo-out/shipped");
    CHECK(std::distance(begin(shipped), end(shipped)) == 12);
    write_file("demo-out/bvh/old.bvh", "from the run before");
  }
  fs::remove("demo-out/bvh/old.bvh");
  // What it suggests works: the checkpoint knows its options.
  const Said more = call("train dvgan --resume --save demo-out/save --minutes 0.001");
  CHECK(more.status == 0);
  CHECK(more.has("68"));
  fs::create_directory("mine");
  write_file("mine/precious.txt", "keep");
  const Said refused = call("demo --out mine");
  CHECK(refused.status == 1);
  CHECK(refused.has("was not made by the demo"));
  CHECK(bytes_of("mine/precious.txt") == "keep");
}

TEST_CASE("devices marks the selected device; --device and MOTIONGAN_DEVICE choose another") {
  const Said said = call("devices");
  CHECK(said.status == 0);
  CHECK(said.has("\n*  "));
  CHECK(said.has("is the selected device"));
  const Said wrong = call("--device abacus devices");
  CHECK(wrong.status == 1);
  CHECK(wrong.has("none of these devices matches \"abacus\""));
  CHECK(call("devices --device abacus").status == 1);
  CHECK(shell(std::string("MOTIONGAN_DEVICE=abacus '") + MOTIONGAN_COMMAND + "' devices").status == 1);
}

TEST_CASE("help and usage") {
  for (const char* verb :
       {"devices", "train dvgan", "generate", "info", "view", "compare", "synth", "demo"}) {
    const Said said = call(std::string(verb) + " --help");
    CHECK(said.status == 0);
    CHECK(said.has("Usage: motiongan "));
  }
  CHECK(call("--version").has("motiongan "));
  CHECK(call("").status > 1);
  CHECK(call("dance").status > 1);
  const TestFolder folder;
  CHECK(call("synth out --clips 0").status == 1);
  CHECK(call("synth out --seconds -1").status > 100);
}

}  // namespace demo_test

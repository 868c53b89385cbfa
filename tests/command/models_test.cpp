// Shipped models: packing a run, listing, and every way to name one.
#include <doctest/doctest.h>

#include <cmath>

#include "../support/setting.hpp"
#include "command.hpp"
#include "motiongan/formats/bvh.hpp"
#include "motiongan/io/sha256.hpp"
#include "server.hpp"

namespace models_test {

using motiongan::testing::Setting;

TEST_CASE("a run is packed, listed, found by its name, and checked") {
  const TestFolder folder;
  REQUIRE(call("synth clips --clips 6 --seconds 5").status == 0);
  REQUIRE(call("train dvgan clips --save run --iterations 3" + tiny).status == 0);
  Said said = call("pack run --out box/walker.safetensors");
  REQUIRE(said.status == 0);
  const std::string sum = motiongan::io::sha256(bytes_of("box/walker.safetensors"));
  CHECK(said.has("SHA-256 " + sum));
  CHECK(bytes_of("box/SHA256SUMS") == sum + "  walker.safetensors\n");
  CHECK(fs::file_size("box/walker.safetensors") <
        0.7 * static_cast<double>(fs::file_size("run/generator.safetensors")));
  CHECK(shell("cd box && sha256sum -c --quiet SHA256SUMS").status == 0);

  const Setting here("MOTIONGAN_MODELS", (fs::current_path() / "box").c_str());
  said = call("models");
  CHECK(said.status == 0);
  for (const char* part :
       {"walker\n", "motion for a text, 4 s at 4 frames a second", "words", "MB)", sum.c_str()})
    CHECK(said.has(part));
  CHECK(call("info walker").has("a model, dvgan_cnn_generator"));
  CHECK(call("generate walker --text walk --out a").status == 0);
  CHECK(call("generate box/walker.safetensors --text walk --out b").status == 0);
  CHECK(bytes_of("a/walk_000.bvh") == bytes_of("b/walk_000.bvh"));

  SUBCASE("packing again replaces the line, and other models keep theirs") {
    REQUIRE(call("pack run --out box/also.safetensors --whole").status == 0);
    REQUIRE(call("pack run --out box/walker.safetensors --whole").status == 0);
    const std::string whole = motiongan::io::sha256(bytes_of("box/walker.safetensors"));
    CHECK(bytes_of("box/SHA256SUMS") == whole + "  also.safetensors\n" + whole + "  walker.safetensors\n");
    CHECK(call("generate walker --text walk --out c").status == 0);
    CHECK(call("generate run --text walk --out d").status == 0);
    CHECK(bytes_of("c/walk_000.bvh") == bytes_of("d/walk_000.bvh"));
  }
  SUBCASE("a damaged model and an unknown name are refused") {
    CHECK(call("generate walke --text walk").has("the shipped models are "));
    shell("printf x >>box/walker.safetensors");
    for (const char* verb : {"generate walker --text walk", "models", "info walker"}) {
      said = call(verb);
      CHECK(said.status == 1);
      CHECK(said.has("box/walker.safetensors: the SHA-256 is "));
    }
  }
  SUBCASE("--out needs the ending that models have, and a ranker makes no motion") {
    CHECK(call("pack run --out box/walker.bin").has("must end in .safetensors"));
    REQUIRE(call("train ranker clips --save rk --iterations 2 --frames 16 --hidden 8 --batch 4").status == 0);
    said = call("pack rk/ranker.safetensors --out box/rk.safetensors");
    CHECK(said.status == 1);
    CHECK(said.has("holds a model called"));
    CHECK(!fs::exists("box/rk.safetensors"));
  }
}

TEST_CASE("the file of a class-conditioned model keeps seconds to continue, and needs no clips") {
  const TestFolder folder;
  REQUIRE(call("synth clips --clips 34 --seconds 4").status == 0);
  const std::string training =
      "train attention clips --pattern {label}_* --save run --iterations 2 --frames 8 --rate 10 --hidden 8 "
      "--batch 4 --critic-steps 1 --classes walk,run,jump --split-seed 3";
  const Said trained = call(training);
  REQUIRE_MESSAGE(trained.status == 0, trained.text);
  const Said packed = call("pack run --out box/mover.safetensors --whole --starts 2");
  REQUIRE_MESSAGE(packed.status == 0, packed.text);
  CHECK(packed.has("with 6 seconds of motion to continue"));
  const auto parameters = [](const std::string& model) {
    const std::string text = call("info " + model).text;
    const std::size_t at = text.find("  parameters ");
    return text.substr(at, text.find('\n', at) - at);
  };
  CHECK(parameters("box/mover.safetensors") == parameters("run/generator.safetensors"));
  fs::remove_all("clips");
  const Setting here("MOTIONGAN_MODELS", (fs::current_path() / "box").c_str());
  CHECK(call("models").has("classes     jump, run, walk"));
  const Said made = call("generate mover --class walk --seconds 2 --count 3 --out a");
  REQUIRE_MESSAGE(made.status == 0, made.text);
  CHECK(made.has("walk_"));  // the clips that it says it continues
  for (const char* file : {"a/walk_000.bvh", "a/walk_001.bvh", "a/walk_002.bvh"})
    CHECK(motiongan::motion::read_bvh(file).frames == 28);

  if (Server server("mover"); server.runs()) {
    const Page page(server);
    CHECK(page.model.at("classes") == true);
    CHECK(page.request("POST", "/characters", R"({"prompt":"walk"})").status == 201);
  }

  SUBCASE("the motion is that of the clip that the second is from") {
    REQUIRE(call("synth clips --clips 34 --seconds 4").status == 0);
    std::string line = made.text.substr(made.text.find("a/walk_000.bvh"));
    line = line.substr(0, line.find('\n'));
    const std::string clip = line.substr(line.find("walk_0", 15)), id = clip.substr(0, clip.find(' ')),
                      at = clip.substr(clip.find(" from ") + 6);
    const Said same = call("generate box/mover.safetensors --class walk --seconds 2 --from clips/" + id +
                           ".bvh --at " + at.substr(0, at.find(' ')) + " --out b");
    REQUIRE_MESSAGE(same.status == 0, same.text);
    const motiongan::motion::Clip x = motiongan::motion::read_bvh("a/walk_000.bvh"),
                                  y = motiongan::motion::read_bvh("b/walk_000.bvh");
    REQUIRE(x.channels.size() == y.channels.size());
    for (std::size_t i = 0; i < x.channels.size(); ++i)
      CHECK(x.channels[i] == doctest::Approx(y.channels[i]).epsilon(1e-3));
  }
  SUBCASE("without starts, a clip is asked for; a file alone has none to draw from") {
    REQUIRE(call("pack box/mover.safetensors --out box/bare.safetensors --starts 0").status == 0);
    CHECK(call("generate bare --class walk").has("give the second to continue with --from CLIP: "));
    CHECK(call("pack box/mover.safetensors --out box/more.safetensors").has("is not the folder of a run"));
  }
}

TEST_CASE("every model in the box has a card, is of at most 12 MB, and makes motion") {
  const TestFolder folder;
  const fs::path box = fs::path(MOTIONGAN_COMMAND).parent_path() / "models";
  const std::string list = bytes_of(box / "SHA256SUMS"), table = bytes_of(box / "README.md");
  const Said models = call("models");
  std::size_t count = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(box)) {
    const fs::path& file = entry.path();
    if (file.extension() != ".safetensors") continue;
    const std::string name = file.stem().string();
    CAPTURE(name);
    ++count;
    CHECK(fs::file_size(file) <= 12'000'000);
    CHECK(list.find(motiongan::io::sha256(bytes_of(file)) + "  " + name + ".safetensors\n") !=
          std::string::npos);
    CHECK(table.find("](" + name + ".md)") != std::string::npos);
    const std::string card = bytes_of(box / (name + ".md"));
    for (const char* part :
         {"## Beside real motion", "## Weaknesses", "## Acknowledgement", "NSF EIA-0196217"})
      CHECK(card.find(part) != std::string::npos);
    CHECK(models.has(name + "\n"));
    const bool classes = call("info " + name).has("attention_generator");
    const Said made = call(motiongan::concat("generate ", name, " --out out-", name,
                                             classes ? " --class walk --seconds 2" : " --text walk"));
    REQUIRE_MESSAGE(made.status == 0, made.text);
    const motiongan::motion::Clip clip = motiongan::motion::read_bvh("out-" + name + "/walk_000.bvh");
    CHECK(static_cast<double>(clip.frames) * clip.frame_time >= 2);
    for (const double value : clip.channels) REQUIRE(std::isfinite(value));
  }
  CHECK(count >= 2);
}

}  // namespace models_test

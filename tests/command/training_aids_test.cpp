// Aids of training: previews, plots, derived clips, schedules; and words that a model never saw.
#include <doctest/doctest.h>

#include "command.hpp"
#include "motiongan/io/safetensors.hpp"

namespace training_aids_test {

TEST_CASE("a training writes previews, and its log is plotted") {
  const TestFolder folder;
  REQUIRE(call("synth clips --clips 6 --seconds 5").status == 0);
  REQUIRE(call("train dvgan clips --save run --iterations 4 --preview 0.00001" + tiny).status == 0);
  const std::string page = bytes_of("run/preview.html");
  CHECK(page.find("after 4 iterations") != std::string::npos);
  CHECK(bytes_of("run/preview.png").starts_with("\x89PNG"));

  const Said one = call("plot run");
  CHECK(one.status == 0);
  CHECK(one.has("last iteration         4"));
  CHECK(one.has("training clips         4,"));
  CHECK(one.has("a foot near the floor"));
  CHECK(one.has("wrote run/plot.png and run/plot.html"));
  CHECK(bytes_of("run/plot.png").starts_with("\x89PNG"));
  const std::string plots = bytes_of("run/plot.html");
  CHECK(plots.find("data:image/png;base64,iVBOR") != std::string::npos);
  CHECK(plots.find("foot skating") != std::string::npos);

  REQUIRE(call("train dvgan clips --save other --iterations 2 --seed 2" + tiny).status == 0);
  fs::remove_all("clips");
  const Said both = call("plot run other/log.csv --png both.png --html both.html");
  CHECK(both.status == 0);
  CHECK(both.has("cannot be read"));  // the clips are gone; the curves are still drawn
  CHECK(bytes_of("both.png").starts_with("\x89PNG"));
  const Said none = call("plot nowhere");
  CHECK(none.status == 1);
  CHECK(none.has("nowhere"));
  CHECK(call("plot run --png curves.txt").status == 1);
  const auto pictures = [] {
    const std::string written = bytes_of("some.html");
    std::size_t count = 0;
    for (std::size_t at = 0; (at = written.find("<img ", at)) != std::string::npos; ++at) ++count;
    return count;
  };
  const std::string some = "plot run --no-data --png some.png --html some.html --curves ";
  CHECK(call(some + "wasserstein").status == 0);
  CHECK(pictures() == 1);
  CHECK(call(some + "penalty,wasserstein").status == 0);
  CHECK(pictures() == 2);
  const Said unknown = call(some + "seconds");
  CHECK(unknown.status == 1);
  CHECK_MESSAGE(unknown.has("no run has logged \"seconds\"; the curves are wasserstein, penalty"),
                unknown.text);
}

TEST_CASE("mirrored and stretched clips, by description, what the body shows, a schedule") {
  const TestFolder folder;
  REQUIRE(call("synth clips --clips 6 --seconds 5").status == 0);
  const std::string options =
      " --mirror --stretch 0.1 --balance --root-rotation support --critic-sees both --loss-smooth 1"
      " --loss-contact 1 --lr-schedule cosine" +
      tiny;
  const Said whole = call("train dvgan clips --save whole --iterations 4" + options);
  CHECK(whole.status == 0);
  CHECK(whole.has("4 for training, 2 held out for testing; 20 derived from those for training"));
  CHECK(bytes_of("whole/split.tsv").find("mirrored") == std::string::npos);
  // The schedule's length is saved: a run that stops early resumes along the same curve.
  REQUIRE(call("train dvgan clips --save parts --iterations 2 --lr-iterations 4" + options).status == 0);
  REQUIRE(call("train dvgan --resume --save parts --iterations 4").status == 0);
  CHECK(motiongan::io::SafeTensors::read("parts/generator.safetensors").tensors ==
        motiongan::io::SafeTensors::read("whole/generator.safetensors").tensors);
  CHECK(call("generate whole --text walk --out made").status == 0);
}

TEST_CASE("presets set what the command line does not") {
  const TestFolder folder;
  REQUIRE(call("synth clips --clips 6 --seconds 5").status == 0);
  const auto options = [](const std::string& run, const char* key) {
    return motiongan::io::SafeTensors::read(run + "/checkpoint.safetensors").metadata.at(key);
  };
  REQUIRE(call("train dvgan clips --save steady --iterations 1" + tiny).status == 0);
  CHECK(options("steady", "training").find("\"critic_sees\":\"both\"") != std::string::npos);
  CHECK(options("steady", "format").find("\"root_rotation\":\"support\"") != std::string::npos);
  REQUIRE(call("train dvgan clips --save paper --preset paper --iterations 1" + tiny).status == 0);
  CHECK(options("paper", "training").find("\"critic_sees\":\"rotations\"") != std::string::npos);
  CHECK(options("paper", "format").find("\"root_rotation\":\"expmap\"") != std::string::npos);
  CHECK(options("paper", "training").find("\"ema\":0.0") != std::string::npos);
  REQUIRE(call("train dvgan clips --save mixed --preset paper --critic-sees positions --iterations 1" + tiny)
              .status == 0);
  CHECK(options("mixed", "training").find("\"critic_sees\":\"positions\"") != std::string::npos);
  // A resumed run keeps its options, whatever the preset would be.
  CHECK(call("train dvgan --resume --save paper --iterations 2").status == 0);
  const Said unknown = call("train dvgan clips --save x --preset fast" + tiny);
  CHECK(unknown.status > 100);
  CHECK_MESSAGE(unknown.has("--preset: fast not in {steady,paper}"), unknown.text);

  const std::string actions =
      " --procedural 51 --iterations 1 --frames 8 --rate 10 --hidden 8 --batch 4 --critic-steps 1 --save ";
  REQUIRE(call("train attention" + actions + "a_steady").status == 0);
  CHECK(options("a_steady", "training").find("\"critic_directions\":true") != std::string::npos);
  CHECK(options("a_steady", "options").find("\"exact_bones\":true") != std::string::npos);
  CHECK(options("a_steady", "options").find("\"continues\":true") != std::string::npos);
  CHECK(options("a_steady", "training").find("\"loss_contact\":1.0,\"loss_smooth\":1.0") !=
        std::string::npos);
  REQUIRE(call("train attention --no-root" + actions + "a_still").status == 0);
  CHECK(options("a_still", "training").find("\"loss_contact\":0.0,\"loss_smooth\":1.0") != std::string::npos);
  CHECK(call("train attention --no-root --loss-contact 1" + actions + "x")
            .has("needs the height of the feet above the ground"));
  REQUIRE(call("train attention --preset paper --exact-bones" + actions + "a_paper").status == 0);
  CHECK(options("a_paper", "training").find("\"critic_directions\":false") != std::string::npos);
  CHECK(options("a_paper", "training").find("\"loss_contact\":0.0,\"loss_smooth\":0.0") != std::string::npos);
  CHECK(options("a_paper", "options").find("\"exact_bones\":true") != std::string::npos);
  CHECK(options("a_paper", "options").find("\"continues\":false") != std::string::npos);
  CHECK(call("train attention --procedural 51 --iterations 1 --hidden 8 --model lstm --save a_lstm").status ==
        0);
}

TEST_CASE("words that the model never saw: the nearest descriptions are named, --strict refuses") {
  const TestFolder folder;
  REQUIRE(call("synth clips --clips 6 --seconds 5").status == 0);
  REQUIRE(call("train dvgan clips --save run --iterations 1" + tiny).status == 0);
  const Said said = call("generate run --text 'a walker moonwalks' --out made");
  CHECK(said.status == 0);
  CHECK(said.has("the model never saw \"walker\", \"moonwalks\""));
  CHECK(said.has("nearest of its descriptions: \"a person walks"));
  const Said refused = call("generate run --text 'a walker moonwalks' --strict --out strict");
  CHECK(refused.status == 1);
  CHECK(refused.has("nearest of its descriptions: \"a person walks"));
  CHECK(!fs::exists("strict"));
  CHECK(call("generate run --text zzz --out made").has("its descriptions are, for example: \""));
}

}  // namespace training_aids_test

// Text files of exponential maps: values, the folder layouts of Human3.6M and CMU, and errors.
#include <doctest/doctest.h>

#include <cstdlib>
#include <motiongan/formats/expmap_text.hpp>

#include "../support/expmap_files.hpp"
#include "../support/messages.hpp"

namespace expmap_text_test {

using namespace motiongan;
using namespace motiongan::motion;
using testing::ExpmapFolder;
using testing::message_of;
using testing::says;

namespace {

std::string refusal(const std::string& text) {
  return message_of([&] { parse_expmap_text(text, "a.txt"); });
}

std::vector<std::string> ids_of(const std::vector<ExpmapClip>& clips) {
  std::vector<std::string> out;
  for (const ExpmapClip& clip : clips) out.push_back(clip.id);
  return out;
}

}  // namespace

TEST_CASE("lines of numbers separated by commas or blanks") {
  const ExpmapText text = parse_expmap_text("1,-2.5e-1, +3\r\n\r\n4 5\t6,\n7,8,9", "a.txt");
  CHECK(text.columns == 3);
  CHECK(text.frames == 3);
  CHECK(text.values == std::vector<double>{1, -0.25, 3, 4, 5, 6, 7, 8, 9});
}

TEST_CASE("invalid frames are errors with their line") {
  CHECK(says(refusal("1,2,3\n\n4,x5,6\n"), "a.txt:3: found 'x5', expected a finite number"));
  CHECK(says(refusal("1,2,3\n4,5.1.2,6\n"), "a.txt:2: found '5.1.2'"));
  CHECK(says(refusal("1,nan,3\n"), "a.txt:1: found 'nan'"));
  CHECK(says(refusal("1,1e999,3\n"), "a.txt:1: found '1e999'"));
  CHECK(says(refusal("1,2,3\n4,5\n"), "a.txt:2: found 2 numbers, expected 3 as in line 1"));
  CHECK(says(refusal("\n1,2,3,4\n"), "a.txt:2: found 4 numbers, expected three per joint"));
  CHECK(says(refusal(" \n"), "a.txt: found no numbers"));
  CHECK(says(message_of([] { read_expmap_text("absent.txt"); }), "absent.txt does not exist"));
}

TEST_CASE("Human3.6M's folders: subject 5 is for testing, both of its files; missing files are skipped") {
  const ExpmapFolder folder;
  testing::write_small_h36m(folder.path());
  folder.write("S5/posing_1.txt", "1,2,3\n");  // has no second file
  const ExpmapCollection all = read_expmap_collection(folder.path());
  CHECK(all.layout == ExpmapLayout::h36m);
  CHECK(all.columns == 15);
  CHECK(all.actions == std::vector<std::string>{"eating", "walking"});
  CHECK(ids_of(all.train) == std::vector<std::string>{"S1/eating_1", "S1/eating_2", "S1/walking_1",
                                                      "S1/walking_2", "S11/walking_1"});
  CHECK(ids_of(all.test) ==
        std::vector<std::string>{"S5/eating_1", "S5/eating_2", "S5/walking_1", "S5/walking_2"});
  CHECK(all.test[2].action == "walking");
  CHECK(all.test[2].text.frames == 350);
  CHECK(all.test[2].text.values[16] == doctest::Approx(testing::swing(1, 1, 1.8)).epsilon(1e-6));

  const ExpmapCollection one = read_expmap_collection(folder.path(), {.actions = {"walking"}});
  CHECK(one.train.size() == 5);  // test actions do not change the training set
  CHECK(one.test.size() == 2);
  CHECK(one.classes == all.classes);
  const ExpmapCollection less = read_expmap_collection(folder.path(), {.train_actions = {"walking"}});
  CHECK(less.test.size() == 4);
  CHECK(ids_of(less.train) == std::vector<std::string>{"S1/walking_1", "S1/walking_2", "S11/walking_1"});

  const auto refused = [&](std::vector<std::string> actions, const std::string& why) {
    const std::string found =
        message_of([&] { read_expmap_collection(folder.path(), {.actions = actions}); });
    CHECK_MESSAGE(says(found, why), found);
  };
  refused({"posing"}, "no test file of the action 'posing'");
  refused({"posing"}, "actions that have one: eating, walking");
  refused({"walking", "walking"}, "is given twice");
  folder.write("S1/walking_2.txt", "1,2,3\n");
  refused({"walking", "eating"}, "S1/walking_2.txt has 3 numbers per line");
}

TEST_CASE("CMU's folders: the first test file of each action") {
  const ExpmapFolder folder;
  testing::write_small_cmu(folder.path());
  folder.write("test/walking_extra/walking_6.txt", "1,2,3\n");  // no walking_extra_1.txt: not an action
  const ExpmapCollection all = read_expmap_collection(folder.path());
  CHECK(all.layout == ExpmapLayout::cmu);
  CHECK(all.actions == std::vector<std::string>{"walking", "washwindow"});
  CHECK(all.classes == all.actions);
  CHECK(ids_of(all.train) == std::vector<std::string>{"train/walking/walking_1", "train/walking/walking_2"});
  CHECK(ids_of(all.test) ==
        std::vector<std::string>{"test/walking/walking_1", "test/washwindow/washwindow_1"});
  CHECK(says(message_of([&] { read_expmap_collection(folder.path(), {.train_actions = {"washwindow"}}); }),
             "no training file of the action 'washwindow'"));
  CHECK(says(message_of([&] { read_expmap_collection(folder.path(), {.layout = ExpmapLayout::h36m}); }),
             "has no folder S5, which the layout h36m requires"));
}

TEST_CASE("folders that match no layout, or both") {
  const ExpmapFolder folder;
  CHECK(says(message_of([&] { find_expmap_layout(folder.path()); }), "has neither the folder S5"));
  CHECK(says(message_of([&] { find_expmap_layout(folder.path() / "absent"); }), "is not a folder"));
  testing::write_small_cmu(folder.path());
  std::filesystem::create_directory(folder.path() / "S5");
  CHECK(says(message_of([&] { find_expmap_layout(folder.path()); }), "give the layout"));
  CHECK(read_expmap_collection(folder.path(), {.layout = ExpmapLayout::cmu}).test.size() == 2);
}

TEST_CASE("the CMU texts themselves") {
  const char* set = std::getenv("MOTIONGAN_SHARED");
  const auto shared =
      (set ? std::filesystem::path(set) : std::filesystem::path(MOTIONGAN_SOURCE_DIR) / ".." / "shared") /
      "data" / "cmu-expmap";
  if (!std::filesystem::is_directory(shared)) {
    MESSAGE("skipped: no folder " << shared.string());
    return;
  }
  const ExpmapCollection all = read_expmap_collection(shared);
  CHECK(all.layout == ExpmapLayout::cmu);
  CHECK(all.columns == 117);
  CHECK(all.actions ==
        std::vector<std::string>{"basketball", "jumping", "running", "soccer", "walking", "washwindow"});
  CHECK(all.classes.size() == 8);
  CHECK(all.train.size() == 32);
  CHECK(all.test[4].text.frames == 359);
}

}  // namespace expmap_text_test

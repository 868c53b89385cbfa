// Options described once: JSON, older files, comparison and validation from the list of fields.
#include <doctest/doctest.h>

#include <motiongan/io/fields_json.hpp>

#include "../support/messages.hpp"

namespace fields_test {

using namespace motiongan;
using motiongan::testing::message_of;
using motiongan::testing::says;

namespace {

enum class Colour { red, blue };
constexpr NameTable<Colour, 2> enum_names(Colour) { return {{{Colour::red, "red"}, {Colour::blue, "blue"}}}; }

struct Options {
  std::size_t steps = 3, taps = 3;
  double weight = 0.5;
  bool shift = true;
  std::optional<bool> cut = {};
  Colour colour = Colour::red;
  std::optional<Colour> maybe = {};
  std::string name = "x";
  std::filesystem::path file = {};
  std::vector<std::string> list = {};
  std::vector<ScheduleStage> schedule = {};
  std::size_t not_saved = 1;

  void list_fields(FieldList& f) {
    f.add(steps, {.key = "steps", .help = "", .range = Range::at_least(1)});
    f.add(taps, {.key = "taps", .help = "", .choices = {3, 5}});
    f.add(weight, {.key = "weight", .help = "", .range = Range::between(0, 1), .option = "--w"});
    f.add(shift, {.key = "shift", .help = ""});
    f.add(cut, {.key = "cut", .help = ""});
    f.add(colour, {.key = "colour", .help = ""});
    f.add(maybe, {.key = "maybe_colour", .help = ""});
    f.add(name, {.key = "name", .help = ""});
    f.add(file, {.key = "file", .help = ""});
    f.add(list, {.key = "list", .help = ""});
    f.add(schedule, {.key = "schedule", .help = ""});
    f.add(not_saved, {.key = "not_saved", .help = "", .option = "-", .saved = false});
  }
};

const Options changed{4,           5,   0.25,  false,      true,       Colour::blue,
                      Colour::red, "y", "a/b", {"p", "q"}, {{7, 0.1}}, 2};

std::string read(Options& options, const std::string& text) {
  return message_of([&] { io::fields_from_text(fields_of(options), text, "file"); });
}

}  // namespace

TEST_CASE("every kind of field goes through JSON and back; enums by name") {
  Options from = changed, to;
  const std::string text = io::fields_to_text(fields_of(from));
  CHECK(says(text, "\"colour\":\"blue\""));
  CHECK_FALSE(says(text, "not_saved"));
  REQUIRE(read(to, text) == "no error");
  CHECK(to.not_saved == 1);
  to.not_saved = 2;
  const FieldList a = fields_of(from), b = fields_of(to);
  for (auto i = a.begin(), j = b.begin(); i != a.end(); ++i, ++j) {
    CAPTURE(i->info.key);
    CHECK(i->equals(*j));
    CHECK(i->text() == j->text());
  }
  Options defaults;
  const FieldList others = fields_of(defaults);
  for (auto i = a.begin(), j = others.begin(); i != a.end(); ++i, ++j) CHECK_FALSE(i->equals(*j));
}

TEST_CASE("older files: enums as numbers, members that did not exist yet") {
  Options options;
  CHECK(read(options, R"({"colour": 1, "steps": 9})") == "no error");
  CHECK(options.colour == Colour::blue);
  CHECK(options.steps == 9);
  CHECK(options.weight == 0.5);  // younger than the file: its default
}

TEST_CASE("what does not fit is refused by the member's name") {
  Options options;
  CHECK(
      says(read(options, R"({"colour": "green"})"), "file: colour is \"green\", expected one of red, blue"));
  CHECK(says(read(options, R"({"colour": 2})"), "\"colour\" is 2"));
  CHECK(says(read(options, R"({"steps": -1})"), "\"steps\" is -1"));
  CHECK(says(read(options, R"({"steps": 1.5})"), "\"steps\" is 1.5"));
  CHECK(says(read(options, R"({"shift": 1})"), "expected true or false"));
  CHECK(says(read(options, R"({"weight": "a"})"), "expected a finite number"));
  CHECK(says(read(options, R"({"weight": 1e999})"), "expected a JSON object"));  // JSON has no infinity
  CHECK(says(read(options, R"({"steps": 18446744073709551616})"), "expected a whole number of at least 0"));
  CHECK(says(read(options, R"({"list": ["a", 1]})"), "expected a list of"));
  CHECK(says(read(options, R"({"schedule": [[1]]})"), "expected pairs"));
  CHECK(says(read(options, "[1]"), "expected a JSON object"));
}

TEST_CASE("ranges, choices and numbers that are none") {
  const auto check = [](auto change) {
    Options options;
    change(options);
    return message_of([&] { check_options(options); });
  };
  CHECK(check([](auto&) {}) == "no error");
  CHECK(check([](auto& o) { o.steps = 0; }) == "steps is 0, expected at least 1");
  CHECK(check([](auto& o) { o.taps = 4; }) == "taps is 4, expected 3 or 5");
  CHECK(check([](auto& o) { o.weight = 1.5; }) == "weight is 1.5, expected 0 to 1");
  CHECK(says(check([](auto& o) { o.weight = std::nan(""); }), "weight is nan"));
  CHECK(check([](auto& o) {
          o.schedule = {{5, std::nan("")}};
        }) == "schedule from 5 on is nan, expected a finite number");
}

TEST_CASE("options on the command line are called by their keys, unless they say otherwise") {
  Options options;
  const FieldList fields = fields_of(options);
  CHECK(fields.find("maybe_colour")->option() == "--maybe-colour");
  CHECK(fields.find("weight")->option() == "--w");
  CHECK(fields.find("not_saved")->option().empty());
  CHECK(fields.find("nothing") == nullptr);
}

}  // namespace fields_test

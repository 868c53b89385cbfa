#include <doctest/doctest.h>

#include <motiongan/data/captions.hpp>
#include <motiongan/io/fields_json.hpp>
#include <string>

#include "../support/messages.hpp"

namespace json_depth_test {

namespace io = motiongan::io;
namespace motion = motiongan::motion;
using motiongan::testing::message_of;
using motiongan::testing::says;

namespace {

std::string nested(std::size_t depth) { return std::string(depth, '[') + std::string(depth, ']'); }

}  // namespace

TEST_CASE("the depth of a JSON text is that of its brackets outside of strings") {
  CHECK_FALSE(io::nests_too_deeply(nested(io::most_nested_json)));
  CHECK(io::nests_too_deeply(nested(io::most_nested_json + 1)));
  std::string flat = "[";
  for (int i = 0; i < 300; ++i) flat += "{},[],";
  CHECK_FALSE(io::nests_too_deeply(flat));
  CHECK_FALSE(io::nests_too_deeply("[\"\\\"" + nested(300) + "\"]"));
  CHECK(io::nests_too_deeply("[\"\\\\\"," + nested(300) + "]"));
  CHECK_FALSE(io::nests_too_deeply(std::string(300, ']') + "[]"));
}

TEST_CASE("files of many nested lists are refused, and do not overflow the stack") {
  const std::string deep = "{\"a\": " + nested(200'000) + "}";
  const std::string captions = message_of([&] { motion::parse_caption_json(deep, "c.json"); });
  CHECK(says(captions, "c.json: found more than 100 lists or objects within each other"));
  const std::string object = message_of([&] { io::parse_object(deep, "m.safetensors"); });
  CHECK(says(object, "m.safetensors: cannot be read, expected a JSON object that nests at most 100 deep"));
  CHECK_FALSE(io::same_format(deep, "{}"));
  CHECK(io::parse_json(deep).is_discarded());
  CHECK(io::parse_object("{\"a\": " + nested(50) + "}", "m").contains("a"));
}

}  // namespace json_depth_test

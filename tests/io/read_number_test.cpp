// Numbers in text: what stands in for std::from_chars() gives the same.
#include <doctest/doctest.h>

#include <bit>
#include <cstdint>
#include <limits>
#include <motiongan/io/read_number.hpp>
#include <random>

namespace read_number_test {

using namespace motiongan;

#ifdef __cpp_lib_to_chars
namespace {

void check_same(const std::string& text) {
  CAPTURE(text);
  const char *first = text.data(), *last = first + text.size();
  double expected = 7, value = 7;
  const std::from_chars_result right = std::from_chars(first, last, expected),
                               found = io::detail::read_by_strtod(first, last, value);
  CHECK(found.ec == right.ec);
  CHECK(found.ptr == right.ptr);
  CHECK(std::bit_cast<std::uint64_t>(value) == std::bit_cast<std::uint64_t>(expected));
}

}  // namespace

TEST_CASE("by strtod: the same bits, end and error as std::from_chars") {
  for (const char* text : {"",
                           "-",
                           "+1",
                           " 1",
                           "\t1",
                           "--1",
                           "-+1",
                           "1",
                           "-1",
                           "1.5",
                           ".5",
                           "5.",
                           ".",
                           "-.",
                           "1e3",
                           "1e",
                           "1e+",
                           "1e-2",
                           "1E5x",
                           "1,5",
                           "0",
                           "-0",
                           "0x10",
                           "-0X1p",
                           "00012",
                           "inf",
                           "-inf",
                           "INFINITY",
                           "infx",
                           "nan",
                           "-nan",
                           "nano",
                           "1e400",
                           "-1e400",
                           "1e-400",
                           "-1e-400",
                           "4.9e-324",
                           "2e-320",
                           "1.7976931348623157e308",
                           "12 34",
                           "1.2.3",
                           "e5",
                           "0.1",
                           "123456789012345678901234567890",
                           "0e999999",
                           "9007199254740993"})
    check_same(text);
}

TEST_CASE("by strtod: the same for any double in any of its forms") {
  std::mt19937_64 random(5);
  for (int i = 0; i < 2000; ++i) {
    const double value = std::bit_cast<double>(random());
    if (!std::isfinite(value)) continue;
    char text[400];
    for (const std::chars_format form : {std::chars_format::general, std::chars_format::scientific}) {
      check_same({text, std::to_chars(text, text + sizeof text, value, form).ptr});
      check_same({text, std::to_chars(text, text + sizeof text, value, form, 1 + i % 20).ptr});
    }
  }
}
#endif

TEST_CASE("a number and what follows it") {
  const std::string_view text = "-2.5e-1,next";
  double value = 0;
  const auto [end, problem] = io::read_number(text.data(), text.data() + text.size(), value);
  CHECK(problem == std::errc());
  CHECK(value == -0.25);
  CHECK(std::string_view(end) == ",next");
}

}  // namespace read_number_test

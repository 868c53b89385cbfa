// read_short_decimal against std::from_chars, bit for bit.
#include "motiongan/formats/short_decimal.hpp"

#include <doctest/doctest.h>

#include <bit>
#include <charconv>
#include <cstdint>
#include <random>
#include <string>

namespace short_decimal_test {

namespace {

using motiongan::motion::read_short_decimal;

void same_as_from_chars(const std::string& text, bool must_read) {
  CAPTURE(text);
  const char* const end = text.data() + text.size();
  double ours = 7, theirs = 0;
  const char* const stop = read_short_decimal(text.data(), end, ours);
  CHECK((stop != nullptr) == must_read);
  if (stop == nullptr) {
    CHECK(ours == 7);
    return;
  }
  CHECK(stop == std::from_chars(text.data(), end, theirs).ptr);
  CHECK(std::bit_cast<std::uint64_t>(ours) == std::bit_cast<std::uint64_t>(theirs));
}

TEST_CASE("short decimals have the bits of from_chars") {
  for (const char* text : {"0", "-0", "-0.0", "1.", "12.5 7", "0.1", "-179.999999", "123456789012345",
                           "0.00000000000001", "999999999999.999", "3}", "00012.50"})
    same_as_from_chars(text, true);
  std::mt19937 random(1);
  for (int i = 0; i < 20000; ++i) {
    const int digits = 1 + static_cast<int>(random() % 15), point = static_cast<int>(random() % (digits + 1));
    std::string text = random() % 2 ? "-" : "";
    for (int k = 0; k < digits; ++k) {
      if (k == point && k > 0) text += '.';
      text += static_cast<char>('0' + random() % 10);
    }
    same_as_from_chars(text, true);
  }
}

TEST_CASE("other numbers are left to from_chars") {
  for (const char* text : {"", "-", ".", ".5", "-.5", "+1", "1e5", "1.5E-3", "nan", "inf", "1234567890123456",
                           "0.0000000000000001", "99999999999999999999999999", "x"})
    same_as_from_chars(text, false);
}

}  // namespace

}  // namespace short_decimal_test

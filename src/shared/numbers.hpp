// How the command line reads numbers: decimal, finite and in full. CLI11 itself reads 010 as octal 8, wraps
// -1 around, clamps integers of 2^64 and more, and lets nan through every check of a range.
#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace motiongan::command {

/// A whole number from 0 to 2^64 - 1, in decimal digits; nothing for any other text.
std::optional<unsigned long long> whole_number(std::string_view text);

/// A finite decimal number; nothing for any other text.
std::optional<double> finite_number(std::string_view text);

/// What was expected instead of a text that is no number, or no whole number: "a whole number".
std::string expected_number(std::string_view text, bool whole);

/// What was wrong with the number that the conversion of an option refused last: "expected a whole number,
/// not 2.5". Empty if none was refused.
std::string& refused_number();

}  // namespace motiongan::command

// CLI11's templates convert with lexical_cast, and prefer these to its own because they are declared first:
// this file must come before <CLI/CLI.hpp>.
namespace CLI::detail {
bool lexical_cast(const std::string& text, unsigned& value);
bool lexical_cast(const std::string& text, unsigned long& value);
bool lexical_cast(const std::string& text, unsigned long long& value);
bool lexical_cast(const std::string& text, int& value);
bool lexical_cast(const std::string& text, double& value);
}  // namespace CLI::detail

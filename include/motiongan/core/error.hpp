// The one exception type of the library, and the way its messages are put together.
#pragma once
#include <sstream>
#include <stdexcept>
#include <string>

namespace motiongan {

/// Joins its arguments as they would be printed to a stream: `concat("row ", 3, " of ", n)`.
template <class... Parts>
std::string concat(const Parts&... parts) {
  std::ostringstream out;
  (out << ... << parts);
  return out.str();
}

/// Everything the library throws. The message says what was found, what was expected and what to do.
class Error : public std::runtime_error {
 public:
  template <class... Parts>
  explicit Error(const Parts&... parts) : std::runtime_error(concat(parts...)) {}
};

/// Throws Error made of `parts` unless `condition` holds.
template <class... Parts>
void require(bool condition, const Parts&... parts) {
  if (!condition) throw Error(parts...);
}

}  // namespace motiongan

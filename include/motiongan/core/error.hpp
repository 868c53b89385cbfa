// The one exception type of the library, and the way its messages are put together.
#pragma once
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace motiongan {

namespace detail {
template <class Part>
void print(std::ostream& out, const Part& part) {
  out << part;
}
/// A shape, or any list: "[32, 64, 93]".
template <class T>
void print(std::ostream& out, const std::vector<T>& list) {
  out << '[';
  for (std::size_t i = 0; i < list.size(); ++i) out << (i ? ", " : "") << list[i];
  out << ']';
}
}  // namespace detail

/// Joins its arguments as they would be printed to a stream: `concat("row ", 3, " of ", n)`.
template <class... Parts>
std::string concat(const Parts&... parts) {
  std::ostringstream out;
  (detail::print(out, parts), ...);
  return out.str();
}

/// Everything the library throws. The message says what was found, what was expected and what to do.
class Error : public std::runtime_error {
 public:
  template <class... Parts>
  explicit Error(const Parts&... parts) : std::runtime_error(concat(parts...)) {}
};

/// Throws Error made of `parts` unless `condition` holds. The parts are put together only then: hand over
/// values (a shape too), not strings made of them, where the call is on a hot path.
template <class... Parts>
void require(bool condition, const Parts&... parts) {
  if (!condition) throw Error(parts...);
}

}  // namespace motiongan

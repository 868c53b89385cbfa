// The library's exceptions and the formatting of their messages.
#pragma once
#include <concepts>
#include <cstddef>
#include <initializer_list>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace motiongan {

// Here, because every header includes this one.
static_assert(sizeof(std::size_t) >= 8,
              "motiongan needs a 64-bit platform: the sizes of tensors and files do not fit a 32-bit size_t");

namespace detail {

/// One part of a message, type-erased, so that formatting is compiled once and not for every list of argument
/// types. Refers to its argument.
class MessagePart {
 public:
  MessagePart(const char* text) : text_(text), kind_(Kind::text) {}
  MessagePart(std::string_view text) : text_(text), kind_(Kind::text) {}
  MessagePart(const std::string& text) : text_(text), kind_(Kind::text) {}
  template <std::floating_point T>
  MessagePart(const T& number) : real_(static_cast<double>(number)), kind_(Kind::real) {}
  template <std::integral T>
  MessagePart(const T& number) {
    if constexpr (std::same_as<T, char>)
      character_ = number, kind_ = Kind::character;
    else if constexpr (std::is_signed_v<T>)
      integer_ = number, kind_ = Kind::integer;
    else
      natural_ = number, kind_ = Kind::natural;
  }
  /// A shape: "[32, 64, 93]".
  MessagePart(const std::vector<std::size_t>& list) : list_(&list), kind_(Kind::list) {}
  /// Any other type with operator<<.
  template <class T>
  requires(!std::is_arithmetic_v<T> && !std::convertible_to<T, std::string_view>) MessagePart(const T& value)
      : other_{&value, [](std::ostream& out, const void* at) { out << *static_cast<const T*>(at); }},
        kind_(Kind::other) {}

  void print(std::ostream& out) const {
    switch (kind_) {
      case Kind::text:
        out << text_;
        break;
      case Kind::character:
        out << character_;
        break;
      case Kind::real:
        out << real_;
        break;
      case Kind::integer:
        out << integer_;
        break;
      case Kind::natural:
        out << natural_;
        break;
      case Kind::list:
        out << '[';
        for (std::size_t i = 0; i < list_->size(); ++i) out << (i ? ", " : "") << (*list_)[i];
        out << ']';
        break;
      case Kind::other:
        other_.print(out, other_.value);
        break;
    }
  }

 private:
  struct Other {
    const void* value;
    void (*print)(std::ostream&, const void*);
  };
  union {
    std::string_view text_;
    char character_;
    double real_;
    long long integer_;
    unsigned long long natural_;
    const std::vector<std::size_t>* list_;
    Other other_;
  };
  enum class Kind : unsigned char { text, character, real, integer, natural, list, other } kind_;
};

inline std::string message_of(std::initializer_list<MessagePart> parts) {
  std::ostringstream out;
  for (const MessagePart& part : parts) part.print(out);
  return std::move(out).str();
}

}  // namespace detail

/// Joins its arguments as printed to a stream: `concat("row ", 3, " of ", n)`.
template <class... Parts>
std::string concat(const Parts&... parts) {
  return detail::message_of({detail::MessagePart(parts)...});
}

/// The library's exception. The message says what was found, what was expected and what to do.
class Error : public std::runtime_error {
 public:
  /// The message is the parts, one after another: text, numbers, shapes.
  template <class... Parts>
  explicit Error(const Parts&... parts) : std::runtime_error(concat(parts...)) {}
};

/// The device or its driver failed: an OpenCL call, a build, or a request for memory.
class DeviceError : public Error {
 public:
  using Error::Error;
};

/// Training diverged: a loss or a weight is no longer finite.
class DivergedError : public Error {
 public:
  using Error::Error;
};

/// Work was given up because somebody asked for it; see Interruptible.
class Interrupted : public Error {
 public:
  using Error::Error;
};

namespace detail {
[[noreturn]] inline void throw_error(std::initializer_list<MessagePart> parts) {
  throw Error(message_of(parts));
}
}  // namespace detail

/// Throws Error with the joined `parts` unless `condition` holds. The message is formatted only then: on a
/// hot path pass values (a shape too), not strings built from them.
template <class... Parts>
void require(bool condition, const Parts&... parts) {
  if (!condition) [[unlikely]]
    detail::throw_error({detail::MessagePart(parts)...});
}

}  // namespace motiongan

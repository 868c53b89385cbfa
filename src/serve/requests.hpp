// Reads what requests bring, and refuses what is not as the protocol says.
#pragma once
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "motiongan/core/error.hpp"
#include "motiongan/io/json_depth.hpp"
#include "serve/http.hpp"

namespace motiongan::command {

/// A request that is answered with this status and message.
struct Refused : std::runtime_error {
  Refused(int with, const std::string& why) : std::runtime_error(why), status(with) {}
  int status;
};

/// Throws Refused with status 400 unless `ok`; the rest is the message.
template <class... Parts>
void expect(bool ok, const Parts&... parts) {
  if (!ok) throw Refused(400, concat(parts...));
}

/// A whole number of at most `most` in decimal digits. Throws Refused for anything else; `what` names it.
inline std::uint64_t whole_number(std::string_view text, const std::string& what, std::uint64_t most) {
  std::uint64_t value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  expect(problem == std::errc() && end == text.data() + text.size() && value <= most, what, " is \"",
         text.substr(0, 40), "\", expected a whole number from 0 to ", most);
  return value;
}

/// The JSON object in the body of a request.
class RequestBody {
 public:
  /// Throws Refused for a body that is too large, of another type, no JSON object, or has a key that is not
  /// in `keys`.
  RequestBody(const HttpRequest& request, std::initializer_list<std::string_view> keys) {
    if (request.too_large) throw Refused(413, concat("the body has more than ", largest_body, " bytes"));
    expect(
        request.content_type == "application/json" || request.content_type.starts_with("application/json;"),
        "the Content-Type is \"", request.content_type.substr(0, 80), "\", expected application/json");
    expect(!io::nests_too_deeply(request.body), "the body nests too deeply");
    json_ = nlohmann::json::parse(request.body, nullptr, false);
    expect(json_.is_object(), "the body is not a JSON object");
    for (const auto& entry : json_.items())
      expect(std::find(keys.begin(), keys.end(), entry.key()) != keys.end(),
             "the body has the unknown key \"", entry.key().substr(0, 40), "\"");
  }

  /// A text of at most 1,000 bytes that must be there.
  std::string text(const char* key) const {
    const auto found = json_.find(key);
    expect(found != json_.end() && found->is_string(), "the body lacks the text \"", key, "\"");
    const auto& value = found->get_ref<const std::string&>();
    expect(value.size() <= 1000, "\"", key, "\" has ", value.size(), " bytes, expected at most 1000");
    return value;
  }

  /// A number between -most and most; 0 if it is not there.
  double number(const char* key, double most) const {
    const auto found = json_.find(key);
    if (found == json_.end()) return 0;
    expect(found->is_number(), "\"", key, "\" is not a number");
    const auto value = found->get<double>();
    expect(std::abs(value) <= most, "\"", key, "\" is ", value, ", expected at most ", most, " in size");
    return value;
  }

  /// A whole number from 0 to `most`, if it is there.
  std::optional<std::uint64_t> natural(const char* key, std::uint64_t most) const {
    const auto found = json_.find(key);
    if (found == json_.end()) return std::nullopt;
    expect(found->is_number_unsigned() && found->get<std::uint64_t>() <= most, "\"", key, "\" is ",
           found->dump().substr(0, 40), ", expected a whole number from 0 to ", most);
    return found->get<std::uint64_t>();
  }

 private:
  nlohmann::json json_;
};

/// The value of a name in the query of the address; empty: not there.
inline std::string query_value(const HttpRequest& request, const std::string& name) {
  const auto found = request.query.find(name);
  return found == request.query.end() ? std::string() : found->second;
}

}  // namespace motiongan::command

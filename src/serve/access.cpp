#include "serve/access.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include "motiongan/core/error.hpp"
#include "motiongan/core/os.hpp"

namespace motiongan::command {

bool equal_in_constant_time(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned differ = 0;
  for (std::size_t i = 0; i < a.size(); ++i) differ |= static_cast<unsigned char>(a[i] ^ b[i]);
  return differ == 0;
}

std::string random_name() {
  std::array<unsigned char, 16> bytes{};
  require(os::random_bytes(bytes), "the operating system gives no random numbers");
  constexpr std::string_view digits = "0123456789abcdef";
  std::string out;
  for (const unsigned char byte : bytes) out += digits[byte >> 4], out += digits[byte & 15u];
  return out;
}

bool is_loopback(std::string_view host) { return host == "127.0.0.1" || host == "localhost"; }

namespace {

/// An address as it is written in a URL: those of IPv6 in brackets. For all addresses, the machine's name.
std::string in_url(const std::string& host) {
  if (host == "0.0.0.0" || host == "::") {
    if (const std::string name = os::host_name(); !name.empty()) return name;
  }
  return host.find(':') != host.npos ? "[" + host + "]" : host;
}

std::string lower_case(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

}  // namespace

Access::Access(const std::string& host, int port) : shown_host_(in_url(host)), port_(port) {
  if (!is_loopback(host)) {
    token_ = random_name();
    return;
  }
  for (const std::string name : {"127.0.0.1", "localhost"}) {
    hosts_.push_back(name + ":" + std::to_string(port));
    if (port == 80) hosts_.push_back(name);  // browsers leave it out
  }
}

std::string Access::url() const {
  return "http://" + shown_host_ + ":" + std::to_string(port_) + "/" +
         (token_.empty() ? "" : "?token=" + token_);
}

std::string Access::refusal(std::string_view host, std::string_view origin, std::string_view token) const {
  if (!token_.empty() && !equal_in_constant_time(token, token_))
    return "the address lacks the token, or has another one; open the address that motiongan serve printed";
  const std::string name = lower_case(host);
  if (!hosts_.empty() && std::find(hosts_.begin(), hosts_.end(), name) == hosts_.end())
    return "the request is for the host \"" + std::string(host.substr(0, 100)) + "\", expected " +
           hosts_.front() + "; open the address that motiongan serve printed";
  if (!origin.empty() && lower_case(origin) != "http://" + name)
    return "the request comes from a page of another site, \"" + std::string(origin.substr(0, 100)) + "\"";
  return "";
}

}  // namespace motiongan::command

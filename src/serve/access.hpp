// Who may use the server of `motiongan serve`.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace motiongan::command {

/// Whether the texts are equal, in a time that depends on their lengths only.
bool equal_in_constant_time(std::string_view a, std::string_view b);

/// 128 random bits of the operating system, in hexadecimal digits. Throws Error if it has none to give.
std::string random_name();

/// Whether only programs of this machine reach the address.
bool is_loopback(std::string_view host);

/// What a request must bring. Any web site that is open in a browser of this machine can send requests to a
/// server at its loopback address: under its own Origin, or under a Host of its own that it lets point here.
/// Both are recognised by their names. From other machines a request must also know the token.
class Access {
 public:
  /// For a server that listens at `host` and `port`: with a new token, unless it is a loopback address.
  Access(const std::string& host, int port);

  const std::string& token() const { return token_; }  ///< empty: none is needed

  /// The address to open in a browser.
  std::string url() const;

  /// Why a request with these headers and this token is refused; empty: it is not.
  std::string refusal(std::string_view host, std::string_view origin, std::string_view token) const;

 private:
  std::string shown_host_;  // in the address to open
  int port_;
  std::string token_;
  std::vector<std::string> hosts_;  // what Host may be; empty: anything
};

}  // namespace motiongan::command

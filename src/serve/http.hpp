// The web server of `motiongan serve`: takes requests, hands them to a function, sends its answers.
#pragma once
#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace motiongan::command {

struct HttpRequest {
  std::string method, path;
  std::map<std::string, std::string> query;  ///< decoded; of a repeated name the first
  std::string host, origin, content_type;    ///< headers; empty: not given
  std::string body;
  bool too_large = false;  ///< the body exceeded largest_body, and what was beyond is gone
};

struct HttpAnswer {
  int status = 200;
  std::string type, body;
  std::vector<std::pair<std::string, std::string>> headers = {};
};

/// A request that changes or asks for something has at most this many bytes.
inline constexpr std::size_t largest_body = 65536;

/// Answers a request; called by several threads at once. What it throws becomes an answer of status 500.
using HttpHandler = std::function<HttpAnswer(const HttpRequest&)>;

/// Listens at `host` and `port` (0: any free one) and answers until `go_on`, called about 20 times a second,
/// returns false. `listens` is called with the port once clients can connect, and before any is answered.
/// Throws Error if the address cannot be listened at, or if the program was built without cpp-httplib.
void serve_http(const std::string& host, int port, const HttpHandler& handler,
                const std::function<void(int port)>& listens, const std::function<bool()>& go_on);

}  // namespace motiongan::command

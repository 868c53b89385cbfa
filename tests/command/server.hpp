// Runs `motiongan serve` and talks to it over a socket of its own, so that tests need no HTTP library.
#pragma once
#include <doctest/doctest.h>

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/socket.h>

#include <cstdint>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "command.hpp"

using Json = nlohmann::json;

struct Reply {
  int status = 0;  ///< 0: no answer
  std::string head, body;
  Json json() const { return Json::parse(body, nullptr, false); }
};

/// Sends `request` to a port of `address` and returns all that comes back; empty: nobody listens.
inline std::string send_raw(int port, const std::string& request, const char* address = "127.0.0.1") {
  const int s = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(port));
  ::inet_pton(AF_INET, address, &to.sin_addr);
  std::string out;
  if (::connect(s, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0) {
    // The server may refuse, and close, before it has read a large body.
    for (std::size_t at = 0; at < request.size();) {
      const ssize_t n = ::send(s, request.data() + at, request.size() - at, MSG_NOSIGNAL);
      if (n <= 0) break;
      at += static_cast<std::size_t>(n);
    }
    char part[65536];
    for (ssize_t n; (n = ::recv(s, part, sizeof part, 0)) > 0;) out.append(part, static_cast<std::size_t>(n));
  }
  ::close(s);
  return out;
}

/// A running `motiongan serve`, ended by this object.
class Server {
 public:
  explicit Server(const std::string& arguments) {
    int ends[2];
    REQUIRE(::pipe2(ends, O_CLOEXEC) == 0);
    const std::string line = std::string("exec env --default-signal=INT '") + MOTIONGAN_COMMAND +
                             "' serve --port 0 " + arguments + " 2>serve.err";
    pid_ = ::fork();
    if (pid_ == 0) {
      ::dup2(ends[1], 1);
      ::execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
      ::_exit(127);
    }
    ::close(ends[1]);
    for (char c; ::read(ends[0], &c, 1) == 1 && c != '\n';) url += c;
    ::close(ends[0]);
    const std::size_t port_at = url.rfind(':');
    if (url.starts_with("http://") && port_at > 5) port = std::stoi(url.substr(port_at + 1));
    if (const std::size_t at = url.find("?token="); at != url.npos) token = url.substr(at + 7);
  }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  ~Server() {
    if (pid_ > 0) end(SIGKILL);
  }

  std::string url, token;
  int port = 0;

  /// Whether it runs. If it was built without a web server, says so, and the test is over.
  bool runs() const {
    if (port != 0) return true;
    const std::string why = bytes_of("serve.err");
    const bool left_out = why.find("built without its web server") != why.npos;
    CHECK_MESSAGE(left_out, why);
    if (left_out) MESSAGE("skipped: the command was built without cpp-httplib");
    return false;
  }

  /// Sends the signal and returns the exit status; 128 + signal where that ended the process.
  int end(int signal) {
    ::kill(pid_, signal);
    int status = 0;
    REQUIRE(::waitpid(pid_, &status, 0) == pid_);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

  using Headers = std::map<std::string, std::string>;

  /// Sends a request with the usual headers, except for those in `headers`; one without value is left out.
  Reply request(const std::string& method, const std::string& path, const std::string& body = "",
                const Headers& headers = {}) const {
    Headers all{{"Host", "127.0.0.1:" + std::to_string(port)}};
    if (!body.empty())
      all["Content-Type"] = "application/json", all["Content-Length"] = std::to_string(body.size());
    for (const auto& [name, value] : headers) all[name] = value;
    std::string text = method + " " + path + " HTTP/1.1\r\n";
    for (const auto& [name, value] : all)
      if (!value.empty()) text += name + ": " + value + "\r\n";
    const std::string answer = send_raw(port, text + "\r\n" + body);
    Reply out;
    const std::size_t end_of_head = answer.find("\r\n\r\n");
    if (!answer.starts_with("HTTP/1.1 ") || end_of_head == answer.npos) return out;
    out.status = std::stoi(answer.substr(9, 3));
    out.head = answer.substr(0, end_of_head);
    out.body = answer.substr(end_of_head + 4);
    return out;
  }

 private:
  pid_t pid_ = -1;
};

/// A session of a server: the characters of one page.
class Page {
 public:
  explicit Page(const Server& server) : server_(server) {
    const Reply opened = server.request("POST", "/sessions" + with_token("?"));
    REQUIRE_MESSAGE(opened.status == 201, opened.body);
    session = opened.json().at("session");
    model = opened.json().at("model");
  }

  std::string session;
  Json model;

  std::string path(const std::string& path) const {
    return path + (path.find('?') == path.npos ? "?" : "&") + "session=" + session + with_token("&");
  }
  Reply request(const std::string& method, const std::string& at, const std::string& body = "",
                const Server::Headers& headers = {}) const {
    return server_.request(method, path(at), body, headers);
  }
  /// The list of characters.
  Json characters() const { return request("GET", "/characters").json().at("characters"); }

  using Points = std::vector<float>;            // [nodes, 3]
  using Frame = std::map<std::size_t, Points>;  // by character
  struct Frames {
    std::size_t first = 0;
    std::vector<Frame> all;
  };
  /// GET /frames with this query, decoded.
  Frames frames(const std::string& query) const {
    const Reply reply = request("GET", "/frames?" + query);
    REQUIRE_MESSAGE(reply.status == 200, reply.body);
    std::size_t at = 0;
    const auto number = [&] {
      std::uint32_t value = 0;
      REQUIRE(at + 4 <= reply.body.size());
      std::memcpy(&value, &reply.body[at], 4);
      at += 4;
      return std::size_t{value};
    };
    Frames out{number(), {}};
    out.all.resize(number());
    for (Frame& frame : out.all)
      for (std::size_t left = number(); left > 0; --left) {
        const std::size_t id = number();
        Points& points = frame[id];
        points.resize(3 * number());
        REQUIRE(at + 4 * points.size() <= reply.body.size());
        std::memcpy(points.data(), &reply.body[at], 4 * points.size());
        at += 4 * points.size();
      }
    CHECK(at == reply.body.size());
    return out;
  }

 private:
  std::string with_token(const std::string& before) const {
    return server_.token.empty() ? "" : before + "token=" + server_.token;
  }
  const Server& server_;
};

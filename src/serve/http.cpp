#include "serve/http.hpp"

#include "motiongan/core/error.hpp"
#include "motiongan/core/os.hpp"

#ifdef MOTIONGAN_HTTPLIB
#include <httplib.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <thread>
#endif

namespace motiongan::command {

#ifdef MOTIONGAN_HTTPLIB

namespace {

// A connection has a thread until it is answered, or was silent for the time below: browsers open some ahead.
constexpr std::size_t threads = 32;
constexpr time_t silent_seconds = 2;
// A connection is closed after its answer. What is left of the body of a refused request would otherwise be
// taken for the next request, with a Host and an Origin as its sender likes.
constexpr std::size_t requests_per_connection = 1;

HttpRequest request_of(const httplib::Request& from) {
  HttpRequest out;
  out.method = from.method, out.path = from.path;
  for (const auto& [name, value] : from.params) out.query.emplace(name, value);
  out.host = from.get_header_value("Host");
  out.origin = from.get_header_value("Origin");
  out.content_type = from.get_header_value("Content-Type");
  return out;
}

void send(const HttpHandler& handler, const HttpRequest& request, httplib::Response& to) {
  HttpAnswer answer;
  try {
    answer = handler(request);
  } catch (const std::exception& error) {
    answer = {500, "text/plain; charset=utf-8", error.what()};
  }
  to.status = answer.status;
  for (const auto& [name, value] : answer.headers) to.set_header(name, value);
  if (!answer.type.empty()) to.set_content(answer.body, answer.type);
}

/// Whether the library should look for a body. It waits for one that DELETE, POST and others do not announce;
/// parts of forms, which nothing here takes, would need receivers of their own.
bool reads_body(const httplib::Request& request) {
  const std::string& method = request.method;
  return method != "GET" && method != "HEAD" && method != "OPTIONS" && !request.is_multipart_form_data() &&
         (request.has_header("Content-Length") || request.has_header("Transfer-Encoding"));
}

void route_all(httplib::Server& server, const HttpHandler& handler) {
  const httplib::Server::HandlerWithContentReader with_body =
      [&handler](const httplib::Request& from, httplib::Response& to, const httplib::ContentReader& read) {
        HttpRequest request = request_of(from);
        // The library's own limit does not hold for chunked bodies.
        read([&](const char* data, std::size_t size) {
          request.too_large = size > largest_body - request.body.size();
          if (!request.too_large) request.body.append(data, size);
          return !request.too_large;
        });
        send(handler, request, to);
      };
  const char* const any = "[\\s\\S]*";
  server.Post(any, with_body).Put(any, with_body).Patch(any, with_body).Delete(any, with_body);
  server.set_pre_routing_handler([&handler](const httplib::Request& from, httplib::Response& to) {
    using enum httplib::Server::HandlerResponse;
    if (reads_body(from)) return Unhandled;
    send(handler, request_of(from), to);
    return Handled;
  });
}

}  // namespace

void serve_http(const std::string& host, int port, const HttpHandler& handler,
                const std::function<void(int port)>& listens, const std::function<bool()>& go_on) {
  // A client that is gone is no reason to stop: writing to it then fails, without a signal.
  os::block_broken_pipe_signal();

  httplib::Server server;
  server.new_task_queue = [] { return new httplib::ThreadPool(threads); };
  server.set_keep_alive_max_count(requests_per_connection);
  server.set_keep_alive_timeout(silent_seconds);
  server.set_tcp_nodelay(true);
  // The library would share the port with another server of the same user, and each would get some requests.
  server.set_socket_options([](socket_t socket) {
    const int on = 1;
    ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  });
  route_all(server, handler);
  const int bound = port == 0 ? server.bind_to_any_port(host) : server.bind_to_port(host, port) ? port : -1;
  require(bound > 0, "cannot listen at port ", port, " of ", host,
          ": it is in use, not permitted, or no address of this machine; --port 0 takes any free port");
  listens(bound);  // connections already wait for an answer
  std::atomic<bool> failed = false;
  std::thread listener([&] { failed = !server.listen_after_bind(); });
  try {
    // Before it runs it cannot be stopped.
    while (!failed && !server.is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    while (!failed && go_on()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  } catch (...) {
    server.stop();
    listener.join();
    throw;
  }
  const bool broke = failed;
  server.stop();
  listener.join();
  require(!broke, "the server at port ", bound, " of ", host, " stopped listening");
}

#else

void serve_http(const std::string&, int, const HttpHandler&, const std::function<void(int port)>&,
                const std::function<bool()>&) {
  throw Error(
      "this motiongan was built without its web server, cpp-httplib; on Debian: apt-get install "
      "libcpp-httplib-dev, then build again");
}

#endif

}  // namespace motiongan::command

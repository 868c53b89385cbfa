// A page in headless Chromium, asked through its debugging pipe.
#pragma once
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

class Browser {
 public:
  using Json = nlohmann::json;

  /// Starts the browser, with its profile in the current folder, and opens the address; see runs().
  explicit Browser(const std::string& url) {
    int to[2], from[2];
    if (::pipe2(to, O_CLOEXEC) != 0 || ::pipe2(from, O_CLOEXEC) != 0) return;
    pid_ = ::fork();
    if (pid_ == 0) {
      ::setpgid(0, 0);
      // Duplicates above the two that the browser reads and writes, so that none takes the other's place.
      const int in = ::fcntl(to[0], F_DUPFD, 10), out = ::fcntl(from[1], F_DUPFD, 10);
      ::dup2(in, 3), ::dup2(out, 4);
      ::execl("/bin/sh", "sh", "-c",
              "exec chromium --headless=new --no-sandbox --disable-gpu --user-data-dir=\"$PWD/profile\" "
              "--window-size=1000,700 --remote-debugging-pipe about:blank >browser.log 2>&1",
              nullptr);
      ::_exit(127);
    }
    ::close(to[0]), ::close(from[1]);
    in_ = to[1], out_ = from[0];
    const Json made = call("Target.createTarget", {{"url", url}});
    if (!made.contains("targetId")) return;
    session_ = call("Target.attachToTarget", {{"targetId", made["targetId"]}, {"flatten", true}})
                   .value("sessionId", "");
  }
  Browser(const Browser&) = delete;
  Browser& operator=(const Browser&) = delete;
  ~Browser() {
    if (pid_ <= 0) return;
    ::close(in_), ::close(out_);
    ::kill(-pid_, SIGKILL);  // and the processes that it started
    ::waitpid(pid_, nullptr, 0);
  }

  bool runs() const { return !session_.empty(); }

  /// The value of a JavaScript expression on the page; null if it has none.
  Json value(const std::string& expression) {
    const Json answer = call("Runtime.evaluate",
                             {{"expression", expression}, {"returnByValue", true}, {"awaitPromise", true}});
    return answer.value("result", Json::object()).value("value", Json());
  }

  /// Whether the expression becomes true within a minute.
  bool becomes_true(const std::string& expression) {
    for (int i = 0; i < 600; ++i) {
      if (value(expression) == true) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return false;
  }

  /// Presses and releases the left button of the mouse.
  void click(double x, double y) {
    for (const char* type : {"mousePressed", "mouseReleased"})
      call("Input.dispatchMouseEvent",
           {{"type", type}, {"x", x}, {"y", y}, {"button", "left"}, {"clickCount", 1}});
  }

 private:
  /// Sends a command and waits for its answer, at most a minute; empty if none comes.
  Json call(const std::string& method, const Json& parameters) {
    Json message{{"id", ++number_}, {"method", method}, {"params", parameters}};
    if (!session_.empty()) message["sessionId"] = session_;
    const std::string text = message.dump() + '\0';
    if (::write(in_, text.data(), text.size()) != static_cast<ssize_t>(text.size())) return Json::object();
    for (;;) {
      const std::size_t end = buffer_.find('\0');
      if (end == buffer_.npos) {
        pollfd ready{out_, POLLIN, 0};
        char part[65536];
        const ssize_t n = ::poll(&ready, 1, 60000) > 0 ? ::read(out_, part, sizeof part) : 0;
        if (n <= 0) return Json::object();
        buffer_.append(part, static_cast<std::size_t>(n));
        continue;
      }
      const Json answer = Json::parse(buffer_.substr(0, end), nullptr, false);
      buffer_.erase(0, end + 1);
      if (answer.value("id", 0) == number_) return answer.value("result", Json::object());
    }
  }

  pid_t pid_ = -1;
  int in_ = -1, out_ = -1, number_ = 0;
  std::string session_, buffer_;
};

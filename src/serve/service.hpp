// The protocol of `motiongan serve`: answers requests with what the model makes. docs/serve.md describes it.
#pragma once
#include <chrono>
#include <map>
#include <mutex>
#include <string>

#include "serve/access.hpp"
#include "serve/http.hpp"
#include "serve/served_model.hpp"
#include "serve/world.hpp"

namespace motiongan::command {

struct ServiceLimits {
  std::size_t characters = 100;  ///< of all pages together
  std::size_t sessions = 16;     ///< a session is an open page
};

class Service {
 public:
  Service(const ServedModel& model, Access access, ServiceLimits limits);

  /// Answers a request; may be called by several threads at once.
  HttpAnswer answer(const HttpRequest& request);

  /// Drops the sessions that sent no request for a minute, unless a request is being answered.
  void drop_idle();

 private:
  using Clock = std::chrono::steady_clock;
  using Lock = std::unique_lock<std::mutex>;
  struct Session {
    World world;
    Clock::time_point last;     // request
    std::uint32_t samples = 0;  // of characters that named none
  };

  HttpAnswer route(const HttpRequest& request);
  HttpAnswer open_session();
  HttpAnswer characters(const HttpRequest& request, Session& session);
  HttpAnswer add(const HttpRequest& request, Session& session);
  HttpAnswer character(const HttpRequest& request, Session& session, const std::string& name, Lock& lock);
  HttpAnswer frames(const HttpRequest& request, Session& session);
  HttpAnswer download(const HttpRequest& request, const Session& session, World::Id id,
                      const std::string& kind, Lock& lock);
  Session& session_of(const HttpRequest& request);
  void drop_idle(Clock::time_point now);
  nlohmann::json with_notes(World::Id id, const std::string& prompt) const;

  const ServedModel& model_;
  const Access access_;
  const ServiceLimits limits_;
  const std::string page_;
  std::mutex mutex_;  // of the model and of the sessions
  std::map<std::string, Session> sessions_;
};

/// The page, with the drawing of figures from the player's.
std::string serve_page();

}  // namespace motiongan::command

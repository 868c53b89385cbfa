#include "serve/service.hpp"

#include <utility>

#include "command/serve_page.hpp"
#include "motiongan/core/error.hpp"
#include "motiongan/formats/bvh.hpp"
#include "motiongan/formats/glb.hpp"
#include "motiongan/generated/view.hpp"
#include "serve/requests.hpp"

namespace motiongan::command {
namespace {

using Json = nlohmann::json;

constexpr std::chrono::seconds idle{60};
constexpr double furthest = 1e6;  // from the origin at which a character may be put, in the model's unit
// Numbers that a page can hold exactly.
constexpr std::uint64_t largest_seed = (std::uint64_t{1} << 53) - 1, largest_sample = 0xFFFFFFFF;

HttpAnswer json_answer(int status, const Json& json) {
  return {status, "application/json", json.dump(-1, ' ', false, Json::error_handler_t::replace)};
}

/// Calls `change`, whose errors are those of the request.
template <class Change>
auto as_asked(const Change& change) {
  try {
    return change();
  } catch (const Error& error) {
    throw Refused(400, error.what());
  }
}

[[noreturn]] void refuse_method(const HttpRequest& request, const char* expected) {
  throw Refused(405, concat(request.method, " ", request.path, " is not possible, expected ", expected));
}

}  // namespace

std::string serve_page() {
  const std::string_view player = view_files::player, mark = "// [figures]";
  const std::size_t begin = player.find(mark), end = player.find(mark, begin + 1);
  require(end != player.npos, "view/player.html must contain \"", mark, "\" twice");
  std::string page = pages::serve;
  const auto put = [&](std::string_view marker, const std::string& text) {
    const std::size_t at = page.find(marker);
    require(at != page.npos, "view/serve/serve.html must contain ", marker);
    page.replace(at, marker.size(), text);
  };
  put("/*FIGURES*/", std::string(player.substr(begin, end - begin)));
  put("/*PAGE*/", concat(pages::people, "\n", pages::scene, "\n", pages::controls));
  return page;
}

Service::Service(const ServedModel& model, Access access, ServiceLimits limits)
    : model_(model), access_(std::move(access)), limits_(limits), page_(serve_page()) {}

HttpAnswer Service::answer(const HttpRequest& request) {
  HttpAnswer out;
  try {
    const std::string refusal = access_.refusal(request.host, request.origin, query_value(request, "token"));
    if (!refusal.empty()) throw Refused(403, refusal);
    out = route(request);
  } catch (const Refused& refused) {
    out = json_answer(refused.status, {{"error", refused.what()}});
  } catch (const std::exception& error) {
    out = json_answer(500, {{"error", error.what()}});
  }
  // The page holds all that it uses, and no other page may hold it; its address, which may contain the token,
  // is told to nobody.
  out.headers.insert(out.headers.end(),
                     {{"Content-Security-Policy",
                       "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
                       "connect-src 'self'; img-src data:; base-uri 'none'; form-action 'none'; "
                       "frame-ancestors 'none'"},
                      {"X-Content-Type-Options", "nosniff"},
                      {"Referrer-Policy", "no-referrer"},
                      {"Cache-Control", "no-store"}});
  return out;
}

HttpAnswer Service::route(const HttpRequest& request) {
  const std::string& path = request.path;
  if (path == "/") {
    if (request.method != "GET" && request.method != "HEAD") refuse_method(request, "GET");
    return {200, "text/html; charset=utf-8", page_};
  }
  Lock lock(mutex_);
  drop_idle(Clock::now());
  if (path == "/sessions") {
    if (request.method != "POST") refuse_method(request, "POST");
    return open_session();
  }
  const std::string below = "/characters/";
  const bool of_one = path.starts_with(below);
  if (!of_one && path != "/characters" && path != "/frames" && path != "/session")
    throw Refused(404, "there is nothing at " + path.substr(0, 100));
  Session& session = session_of(request);
  if (of_one) return character(request, session, path.substr(below.size()), lock);
  if (path == "/characters") return characters(request, session);
  if (path == "/frames") return frames(request, session);
  if (request.method != "DELETE") refuse_method(request, "DELETE");
  sessions_.erase(query_value(request, "session"));
  return {204, "", ""};
}

HttpAnswer Service::open_session() {
  if (sessions_.size() >= limits_.sessions)
    throw Refused(503, concat("there are ", sessions_.size(),
                              " open pages, the most that are possible; close "
                              "one, or wait a minute"));
  const std::string name = random_name();
  sessions_.emplace(name, Session{World(model_.new_crowd(), model_.rate()), Clock::now()});
  Json model = model_.describe();
  model["characters"] = limits_.characters;
  model["kept_seconds"] = kept_seconds;
  model["idle_seconds"] = idle.count();
  return json_answer(201, {{"session", name}, {"model", model}});
}

Service::Session& Service::session_of(const HttpRequest& request) {
  const std::string name = query_value(request, "session");
  expect(!name.empty(), "the address lacks ?session=NAME; POST /sessions gives one");
  const auto found = sessions_.find(name);
  if (found == sessions_.end())
    throw Refused(404, concat("there is no such session; those without a request for ", idle.count(),
                              " seconds are dropped. POST /sessions opens one"));
  found->second.last = Clock::now();
  return found->second;
}

HttpAnswer Service::characters(const HttpRequest& request, Session& session) {
  if (request.method == "POST") return add(request, session);
  if (request.method != "GET") refuse_method(request, "GET or POST");
  return json_answer(200, {{"characters", session.world.list()}});
}

Json Service::with_notes(World::Id id, const std::string& prompt) const {
  const PromptNotes notes = model_.notes_on(prompt);
  return {{"id", id}, {"unknown", notes.unknown}, {"nearest", notes.nearest}, {"remark", notes.remark}};
}

HttpAnswer Service::add(const HttpRequest& request, Session& session) {
  const RequestBody body(request, {"prompt", "x", "z", "yaw", "seed", "sample"});
  CrowdStart start;
  start.prompt = body.text("prompt");
  start.at.x = body.number("x", furthest);
  start.at.z = body.number("z", furthest);
  start.at.yaw = body.number("yaw", 1000);
  start.seed = body.natural("seed", largest_seed).value_or(1);
  const std::optional<std::uint64_t> sample = body.natural("sample", largest_sample);
  start.sample = sample ? static_cast<std::uint32_t>(*sample) : session.samples;
  std::size_t all = 0;
  for (const auto& entry : sessions_) all += entry.second.world.size();
  if (all >= limits_.characters)
    throw Refused(409, concat("there are ", all,
                              " characters, the most that are possible; remove one, or start "
                              "motiongan serve with a larger --characters"));
  const World::Id id = as_asked([&] { return session.world.add(start); });
  if (!sample) ++session.samples;
  Json out = with_notes(id, start.prompt);
  out["sample"] = start.sample;
  return json_answer(201, out);
}

HttpAnswer Service::character(const HttpRequest& request, Session& session, const std::string& name,
                              Lock& lock) {
  const std::size_t dot = name.find('.');
  const std::string kind = dot == name.npos ? "" : name.substr(dot + 1);
  const std::uint64_t number = whole_number(name.substr(0, dot), "the character's id", largest_seed);
  const auto id = static_cast<World::Id>(number);
  if (!session.world.has(id)) throw Refused(404, concat("there is no character ", id));
  if (dot != name.npos) return download(request, session, id, kind, lock);
  if (request.method == "DELETE") {
    session.world.remove(id);
    return {204, "", ""};
  }
  if (request.method != "PATCH" && request.method != "POST") refuse_method(request, "PATCH, POST or DELETE");
  const std::string prompt = RequestBody(request, {"prompt"}).text("prompt");
  as_asked([&] { session.world.set_prompt(id, prompt); });
  return json_answer(200, with_notes(id, prompt));
}

HttpAnswer Service::frames(const HttpRequest& request, Session& session) {
  if (request.method != "GET") refuse_method(request, "GET");
  std::optional<std::uint64_t> from;
  if (const std::string text = query_value(request, "from"); !text.empty())
    from = whole_number(text, "from", largest_seed);
  const std::string text = query_value(request, "count");
  const std::size_t most = session.world.most_frames();
  const std::size_t count = text.empty() ? 1 : whole_number(text, "count", most);
  expect(count > 0, "count is 0, expected 1 to ", most);
  const std::uint64_t next = session.world.next();
  expect(from.value_or(next) <= next, "from is ", from.value_or(0), ", expected at most ", next,
         ", the number of the next frame");
  return {200, "application/octet-stream", session.world.frames(from, count)};
}

HttpAnswer Service::download(const HttpRequest& request, const Session& session, World::Id id,
                             const std::string& kind, Lock& lock) {
  if (request.method != "GET") refuse_method(request, "GET");
  if (kind != "bvh" && kind != "glb")
    throw Refused(404,
                  concat("there is no file of the kind \"", kind.substr(0, 20), "\", expected bvh or glb"));
  motion::Motion seen = as_asked([&] { return session.world.seen(id); });
  lock.unlock();  // others need not wait until the file is made; the session may be gone from here on
  const std::string name = concat("character-", id);
  HttpAnswer out;
  if (kind == "bvh") {
    out = {200, "text/plain; charset=utf-8", motion::format_bvh(seen, name)};
  } else {
    const motion::NamedMotion named{name, std::move(seen)};
    out = {200, "model/gltf-binary", motion::glb_file({&named, 1}, {.unit_metres = model_.unit_metres()})};
  }
  out.headers.emplace_back("Content-Disposition", concat("attachment; filename=\"", name, ".", kind, "\""));
  return out;
}

void Service::drop_idle(Clock::time_point now) {
  std::erase_if(sessions_, [&](const auto& entry) { return now - entry.second.last > idle; });
}

void Service::drop_idle() {
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (lock) drop_idle(Clock::now());
}

}  // namespace motiongan::command

// motiongan serve: a page on which characters move while the model makes their motion.
#include <cstdio>
#include <memory>

#include "serve/service.hpp"
#include "shared/options.hpp"
#include "shared/signals.hpp"

namespace motiongan::command {
namespace {

struct ServeArgs {
  ServedModelArgs model;
  std::string host = "127.0.0.1";
  int port = 8080;
  ServiceLimits limits;
};

int serve(const ServeArgs& args, const CLI::App& verb) {
  require(!args.host.empty(), "--host is empty, expected an address of this machine, such as 127.0.0.1");
  const Context context;
  const ServedModel model(context, args.model, verb);
  model.warm_up();
  // The port is known once the server listens; no request comes before.
  std::unique_ptr<Service> service;
  catch_signals();
  serve_http(
      args.host, args.port, [&](const HttpRequest& request) { return service->answer(request); },
      [&](int port) {
        Access access(args.host, port);
        fmt::print("{}\n", access.url());
        service = std::make_unique<Service>(model, std::move(access), args.limits);
        fmt::print(stderr, "motiongan: open this address in a browser; Ctrl-C ends the server\n");
        flush_output();
      },
      [&] {
        service->drop_idle();
        return !stop_requested();
      });
  return 128 + caught_signal();
}

const Verb serve_verb{
    "serve", [](CLI::App& app, Job& job) {
      CLI::App* verb = app.add_subcommand(
          "serve",
          "Serve a page on which characters move while the model makes their motion: for a text or a class "
          "each,\nwhich may change. The first line of the output is its address, for a browser on this "
          "machine. "
          "Ctrl-C\nends the server.");
      const auto args = std::make_shared<ServeArgs>();
      verb->add_option("MODEL", args->model.model, model_help)->required()->type_name("");
      verb->add_option("--port", args->port, "port to listen at; 0: any free one")
          ->check(CLI::Range(0, 65535))
          ->capture_default_str();
      verb->add_option(
              "--host", args->host,
              "address to listen at; another one than that of this machine alone is only for those who "
              "know the token in the address that is printed")
          ->capture_default_str()
          ->type_name("ADDRESS");
      verb->add_option("--characters", args->limits.characters,
                       "the most characters, of all open pages together")
          ->check(CLI::Range(1, 10000))
          ->capture_default_str();
      add_weights_option(*verb, args->model.weights);
      const char* const group = "Class-conditioned models";
      verb->add_option("--clip", args->model.clips,
                       "clip whose first second characters continue; may be repeated [those that the model's "
                       "file keeps, else drawn from the run's test clips]")
          ->type_name("CLIP")
          ->expected(1)
          ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
          ->group(group);
      verb->add_option("--data", args->model.data, "folder of the clips to draw from [that of the run]")
          ->type_name("FOLDER")
          ->group(group);
      add_options(*verb, fields_of(args->model.reading), group, {.only = {"up", "scale", "fps", "bones"}});
      verb->callback([&job, args, verb] { job = [args, verb] { return serve(*args, *verb); }; });
    }};

}  // namespace
}  // namespace motiongan::command

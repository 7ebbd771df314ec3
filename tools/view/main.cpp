// palpate-view: shows a running or a recorded palpate in a browser. See --help.

#include <CLI/CLI.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <thread>

#include "rt/config/bus_keys.hpp"
#include "tools/common/program.hpp"
#include "tools/view/foxglove_content.hpp"
#include "tools/view/viewer.hpp"

namespace {

namespace bus = palpate::bus;
namespace client = palpate::client;
namespace serve = palpate::serve;
namespace view = palpate::view;

constexpr const char* kFoxglove = "https://app.foxglove.dev";

struct Options {
  std::string control_url = "udpm://239.255.76.67:7667?ttl=0";
  std::string housekeeping_url = "udpm://239.255.76.68:7668?ttl=0";
  std::string configuration, urdf, flange, three = PALPATE_THREE_FOLDER;
  std::vector<std::string> overrides, logs;
  std::vector<std::filesystem::path> types;
  std::string key_file, token_file;
  bool control = false;
  bool foxglove = false;
  double max_force = 5;
  double log_rate = 1;
  serve::Server::Options server;
};

constexpr const char* kExamples = R"(
Examples:
  palpate-view --config rt/config/examples/bar_long_soft.yaml --robot sim/robot/lwr_hand.urdf
      what the daemon and the simulator publish; open the address that is printed
  palpate-view --config my.yaml --control
      the same, and the page may start, stop, push, set targets and replace components: open the
      address with its token
  palpate-view --config my.yaml --log control.log housekeeping.log
      a recording, with a timeline
  palpate-view --config my.yaml --foxglove
      for Foxglove too: open connection, Foxglove WebSocket, ws://localhost:8765
From another machine: ssh -L 8765:127.0.0.1:8765 HOST, and open the address here. To push, the
daemon needs a sensor model `manual` and a contact that serves it (tools/view/README.md).)";

void add_options(CLI::App& app, Options& o) {
  palpate::config::add_url_option(
      app, {{"control", &o.control_url}, {"housekeeping", &o.housekeeping_url}});
  CLI::Option* config = app.add_option("--config", o.configuration,
                                       "the daemon's configuration: where arm and object are, and "
                                       "which components it began with");
  app.add_option("--set", o.overrides, "override a key of it: path.to.key=value (repeatable)")
      ->allow_extra_args(false)
      ->needs(config);
  app.add_option("--robot", o.urdf,
                 "expanded URDF of the arm with primitive shapes; without it that of the "
                 "configuration's section robot")
      ->needs(config);
  app.add_option("--flange", o.flange, "its link that is the flange (default: flange)");
  CLI::Option* log =
      app.add_option("--log", o.logs, "play these logs, one of each URL, in place of what is live");
  palpate::types::add_types_option(app, o.types);
  app.add_option("--rate", o.log_rate, "of a log, times real time, 0.01 to 100")
      ->check(CLI::Range(0.01, 100.0))
      ->capture_default_str()
      ->needs(log);
  app.add_option("--listen", o.server.address,
                 "address to listen on; only 127.0.0.1 and ::1 keep other machines out")
      ->capture_default_str();
  app.add_option("--port", o.server.port, "port to listen on; 0: any that is free")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  app.add_option(
         "--name", o.server.names,
         "a further host name or address by which browsers may call the server (repeatable)")
      ->allow_extra_args(false);
  app.add_option("--fps", o.server.rate, "frames a second at most, 1 to 120")
      ->check(CLI::Range(1.0, 120.0))
      ->capture_default_str();
  CLI::Option* foxglove =
      app.add_flag("--foxglove", o.foxglove,
                   "send all messages to clients of Foxglove's WebSocket protocol as well")
          ->excludes(log);
  app.add_option("--foxglove-origin", o.server.guest_origins,
                 "a web page that may read them, in addition to " + std::string(kFoxglove) +
                     " (repeatable)")
      ->allow_extra_args(false)
      ->needs(foxglove);
  CLI::Option* control =
      app.add_flag("--control", o.control, "let a page that has the token give commands")
          ->excludes(log);
  app.add_option(
         "--token-file", o.token_file,
         "take the token from this file, which palpate-command --make-key makes; without it "
         "a new one is drawn at each start")
      ->needs(control);
  app.add_option("--key", o.key_file, "file of the key that the daemon has")->needs(control);
  app.add_option("--max-force", o.max_force, "N, the longest push, 0 to 1000")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  app.add_option("--three", o.three, "folder of three.min.js (Debian: libjs-three)")
      ->capture_default_str();
}

void warn_of_damage(const std::vector<std::string>& complaints) {
  for (const std::string& line : complaints) std::fprintf(stderr, "warning: %s\n", line.c_str());
}

std::unique_ptr<view::LogSource> open_log(const Options& options,
                                          const palpate::types::TypeSet& types,
                                          const bus::ChannelNames& names) {
  auto printed = std::chrono::steady_clock::now();
  const auto progress = [&printed](const std::string& file, double share) {
    const auto now = std::chrono::steady_clock::now();
    if (now - printed < std::chrono::seconds(1)) return;
    printed = now;
    std::fprintf(stderr, "%s: %.0f %%\n", file.c_str(), 100 * share);
  };
  std::vector<std::string> complaints;
  auto log = std::make_unique<view::LogSource>(options.logs, progress, complaints, types, names);
  warn_of_damage(complaints);
  std::printf("%.1f s of recording\n", log->duration());
  return log;
}

void print_address(const Options& options, int port, const serve::Token& token) {
  const bool v6 = options.server.address.find(':') != std::string::npos;
  const std::string host = options.server.address == "0.0.0.0" ? "127.0.0.1"
                           : options.server.address == "::"    ? "[::1]"
                           : v6                                ? "[" + options.server.address + "]"
                                                               : options.server.address;
  std::printf("http://%s:%d/%s\n", host.c_str(), port,
              options.control ? ("#token=" + token.text()).c_str() : "");
  if (options.control) std::printf("Anyone with this address can command the daemon.\n");
  if (options.server.address != "127.0.0.1" && options.server.address != "::1" &&
      options.server.address != "localhost")
    std::fprintf(
        stderr, "warning: listening on %s without encryption: others on the network can watch%s\n",
        options.server.address.c_str(), options.control ? ", and read the token in transit" : "");
  std::fflush(stdout);
}

void print_counters(const serve::ServerCounters& c) {
  std::printf(
      "%lld requests (%lld refused), %lld frames (%lld left out for slow pages), %.1f MB, "
      "%.2f s of processor time\n",
      static_cast<long long>(c.requests), static_cast<long long>(c.refused),
      static_cast<long long>(c.frames), static_cast<long long>(c.frames_skipped),
      static_cast<double>(c.bytes) * 1e-6, c.work);
}

int run(Options& options) {
  // Before any thread is created, so that all of them leave the signals to this one.
  boost::asio::io_context signals;
  boost::asio::signal_set ending(signals, SIGINT, SIGTERM);

  const serve::Assets assets(view::page_files(), options.three);
  view::Viewer::Options viewer_options;
  viewer_options.control = options.control;
  viewer_options.max_force = options.max_force;
  viewer_options.rate = options.log_rate;
  bus::ChannelNames names;
  if (!options.configuration.empty()) {
    viewer_options.cell =
        view::Cell::read(options.configuration, options.overrides, options.urdf, options.flange);
    names = palpate::config::read_channel_names(
        palpate::config::Node::load_file(options.configuration, options.overrides)
            .child_or_empty("bus"));
  }
  const serve::Token token =
      options.token_file.empty() ? serve::Token() : serve::Token(options.token_file);
  view::Viewer viewer(viewer_options, token);
  const palpate::types::TypeSet types(options.types);
  viewer.describe(types);
  view::FoxgloveTopics topics(types, viewer_options.cell.X_WO);
  view::FoxgloveContent foxglove(topics, viewer.scene());

  std::unique_ptr<bus::MessageBus> control, housekeeping;
  if (!options.logs.empty()) {
    viewer.show_log(open_log(options, types, names));
  } else {
    auto source = std::make_unique<view::LiveSource>(
        std::vector<std::string>{options.control_url, options.housekeeping_url}, names);
    if (options.foxglove)
      source->listen_by(
          [&topics](std::string_view channel, const void* data, int size, std::int64_t time_us) {
            topics.take(channel, data, size, time_us);
          });
    viewer.show_live(std::move(source));
  }
  if (options.control) {
    bus::Access access;
    access.start_us = bus::wall_clock_us();
    if (!options.key_file.empty()) access.key = bus::read_key_file(options.key_file);
    control = bus::make_lcm_bus(options.control_url);
    housekeeping = bus::make_lcm_bus(options.housekeeping_url);
    control->set_channel_names(names);
    housekeeping->set_channel_names(names);
    viewer.command_by(std::make_unique<client::Client>(*control, *housekeeping, access));
    housekeeping->start_without_thread();
  }
  options.server.guest_origins.emplace_back(kFoxglove);
  serve::Server server(options.server, assets, viewer, options.foxglove ? &foxglove : nullptr);
  print_address(options, server.port(), token);
  std::thread serving([&] { server.run(); });
  ending.async_wait([](const boost::system::error_code&, int) {});
  signals.run();
  server.stop();
  serving.join();
  print_counters(server.counters());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "palpate-view shows in a browser the state of palpated: robot, shape coloured by "
      "displacement,\n"
      "strain, stress or uncertainty, forces, target, health and events; live or from logs.\n"
      "It only reads, except with --control.");
  app.footer(kExamples);
  Options options;
  add_options(app, options);
  app.set_version_flag("--version", PALPATE_VERSION);
  if (const auto code = palpate::config::parse(app, argc, argv,
                                               {{{0, "ended by a signal"},
                                                 {1, "something is missing or cannot be opened"},
                                                 {78, "wrong configuration"}},
                                                {{"--housekeeping", "--url", "housekeeping="}}}))
    return *code;
  return palpate::common::run_program("error", [&] { return run(options); });
}

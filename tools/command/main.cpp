#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>
#include <vector>

#include "rt/client/client.hpp"
#include "rt/config/bus_keys.hpp"
#include "rt/config/command_line.hpp"
#include "rt/config/key_file.hpp"
#include "tools/command/touch.hpp"
#include "tools/common/program.hpp"

// palpate-command: sends commands to a running palpated. See --help.

namespace {

namespace bus = palpate::bus;
namespace client = palpate::client;

constexpr const char* kControl = "udpm://239.255.76.67:7667?ttl=0";
constexpr const char* kHousekeeping = "udpm://239.255.76.68:7668?ttl=0";

struct Options {
  std::string configuration;
  std::string control, housekeeping;  // URLs; empty where --url gives none
  std::string key_file, new_key_file;
  double timeout = 10;  // s
  double reach = 0;     // m, rad, 1/m; 0: do not wait for it

  client::Request request;
  std::vector<std::string> parameters;  // key=value
  std::string kind;
  std::vector<double> points, values;
  palpate::command::Touch touch;
};

void add_events(CLI::App& app, Options& options) {
  const std::pair<const char*, const char*> events[] = {
      {"start", "activate: sense, and follow a target"},
      {"stop", "zero command, inactive"},
      {"reset", "leave a fault; start afterwards"},
      {"zero", "tare the sensors; nothing may be held"},
      {"calibrate", "the same, by its other name"}};
  for (const auto& [name, what] : events) app.add_subcommand(name, what);

  CLI::App* replace = app.add_subcommand("replace", "another component, or other parameters");
  replace
      ->add_option("slot", options.request.slot,
                   "object, sensing, contact, estimation, deformation, feature, control; all")
      ->required();
  replace->add_option("--instance", options.request.instance,
                      "which one, in a slot that holds several: number or name");
  replace->add_option("--component", options.request.component,
                      "the new one; without it the present one gets other parameters");
  CLI::Option* yaml = replace->add_option("--parameters", options.request.parameters,
                                          "YAML mapping, e.g. '{order: linear}'");
  replace->add_option("--set", options.parameters, "key=value (repeatable)")
      ->allow_extra_args(false)
      ->excludes(yaml);

  CLI::App* target = app.add_subcommand("target", "desired value of the feature of the shape");
  target->add_option("kind", options.kind, "name of the feature, as configured")->required();
  target
      ->add_option("values", options.values,
                   "m, rad, 1/m; a pose as position and quaternion w x y z")
      ->required();
  target->add_option("--points", options.points,
                     "x y z of rest points in O, m, where not as configured");
  target
      ->add_option("--reach", options.reach,
                   "wait until the feature's error is this small (m, rad, 1/m); code 1 where it is "
                   "not within --timeout")
      ->check(CLI::PositiveNumber);
  options.touch.add_to(app);
  for (CLI::App* sub : app.get_subcommands({})) sub->fallthrough();
}

/// How to reach the daemon: as the command line says, else as its configuration does.
struct Reach {
  std::string control = kControl, housekeeping = kHousekeeping;
  bus::ChannelNames channels;
  bus::Access access;

  explicit Reach(const Options& options) {
    access.start_us = bus::wall_clock_us();
    if (!options.configuration.empty()) {
      const auto root = palpate::config::Node::load_file(options.configuration);
      const auto bus = root.child_or_empty("bus");
      control = bus.text({"control", "", "URL"}, kControl);
      housekeeping = bus.text({"housekeeping", "", "URL"}, kHousekeeping);
      channels = palpate::config::read_channel_names(bus);
      if (options.key_file.empty()) access.key = palpate::config::read_key(root);
    }
    if (!options.control.empty()) control = options.control;
    if (!options.housekeeping.empty()) housekeeping = options.housekeeping;
    if (!options.key_file.empty()) access.key = bus::read_key_file(options.key_file);
  }

  std::unique_ptr<bus::MessageBus> open(const std::string& url) const {
    auto opened = bus::make_lcm_bus(url);
    opened->set_channel_names(channels);
    return opened;
  }
};

/// Waits until the feature reaches its target, and prints the remaining error.
int follow(client::Client& daemon, const Options& options) {
  const bool reached = daemon.wait(options.timeout, [&] {
    const auto error = daemon.target_error();
    return error && *error <= options.reach;
  });
  const auto error = daemon.target_error();
  if (!error) {
    std::fprintf(stderr, "no FEATURE of this target in %g s\n", options.timeout);
    return 1;
  }
  std::printf("%s: error %.4g\n", reached ? "reached" : "not reached", *error);
  return reached ? 0 : 1;
}

int run(const CLI::App& app, Options& options) {
  if (!options.new_key_file.empty()) {
    bus::make_key_file(options.new_key_file);
    std::printf("%s: a new key; name it under access.key_file\n", options.new_key_file.c_str());
    return 0;
  }
  const Reach reach(options);
  const std::string name = app.get_subcommands().at(0)->get_name();
  const auto control = reach.open(reach.control);
  if (name == "touch") return options.touch.run(*control, reach.access, options.timeout);
  const auto housekeeping = reach.open(reach.housekeeping);
  client::Client daemon(*control, *housekeeping, reach.access);

  client::Answer answer;
  if (name == "target") {
    answer = daemon.ask_and_wait(client::make_target(options.kind, options.points, options.values),
                                 options.timeout);
  } else {
    client::Request& request = options.request;
    request.event = name;
    if (!options.parameters.empty())
      request.parameters = client::make_parameters(options.parameters);
    answer = daemon.ask_and_wait(client::make_command(request), options.timeout);
  }
  if (answer.event.empty()) {
    std::fprintf(stderr, "%s (%g s, %s)\n", answer.reason.c_str(), options.timeout,
                 reach.control.c_str());
    return 1;
  }
  std::printf("%s%s%s\n", answer.event.c_str(), answer.reason.empty() ? "" : ": ",
              answer.reason.c_str());
  if (answer.done() && options.reach > 0) return follow(daemon, options);
  return answer.done() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("palpate-command sends a command to a running palpated, and prints the answer.");
  Options options;
  options.control = kControl, options.housekeeping = kHousekeeping;  // as --help names them
  palpate::config::add_url_option(
      app, {{"control", &options.control}, {"housekeeping", &options.housekeeping}});
  options.control.clear(), options.housekeeping.clear();
  app.add_option("--config", options.configuration,
                 "the daemon's configuration: URLs, names of channels and key, as far as --url and "
                 "--key do not give them")
      ->check(CLI::ExistingFile);
  app.add_option("--key", options.key_file, "file of the key that the daemon has");
  app.add_option("--timeout", options.timeout, "s, to wait for an answer")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  CLI::Option* make_key =
      app.add_option("--make-key", options.new_key_file, "write a new key to this file, and end");
  app.footer(
      "Examples:\n"
      "  palpate-command zero\n"
      "  palpate-command --config my.yaml start\n"
      "  palpate-command --key robot.key start\n"
      "  palpate-command target point 0.25 0.03 0.08 --reach 2e-3\n"
      "  palpate-command replace control --set provider=kinematic\n"
      "  palpate-command touch --direction 0 0 -1 --force 0.2");
  add_events(app, options);
  if (const auto code = palpate::config::parse(
          app, argc, argv,
          {{{1, "refused, no answer, no contact, or an error"}, {78, "wrong configuration"}},
           {{"--housekeeping", "--url", "housekeeping="}}}))
    return *code;
  if (make_key->empty() && app.get_subcommands().empty())
    return palpate::config::usage_error(app, "a command is required");
  return palpate::common::run_program("error", [&] { return run(app, options); });
}

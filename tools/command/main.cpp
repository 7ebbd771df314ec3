#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <optional>
#include <palpate/channels.hpp>
#include <palpate/component_command_t.hpp>
#include <palpate/component_event_t.hpp>
#include <palpate/feature_t.hpp>
#include <palpate/shape_target_t.hpp>
#include <string>
#include <vector>

#include "rt/bus/authentication.hpp"
#include "rt/bus/message_bus.hpp"
#include "rt/bus/session.hpp"
#include "rt/bus/text.hpp"
#include "rt/config/command_line.hpp"
#include "tools/command/request.hpp"
#include "tools/common/program.hpp"

// palpate-command: sends commands to a running palpated. See --help.

namespace palpate::command {
namespace {

/// The daemon's answer to a command.
struct Answer {
  std::string event;   // empty: no answer
  std::string reason;  // as far as known, also without an answer
  bool done() const { return !event.empty() && event != "refused"; }
};

/// Sends commands to a daemon and repeats each until it is answered; the daemon executes it once.
class Conversation {
 public:
  /// Subscribes to both buses and starts `housekeeping`; neither must have been started.
  Conversation(bus::MessageBus& control, bus::MessageBus& housekeeping, const bus::Access& access);

  /// Waits for the final answer, at most `timeout` s: for a replacement, its result.
  Answer ask(component_command_t command, double timeout);
  /// The chunks of one target.
  Answer ask(std::vector<shape_target_t> target, double timeout);

  /// After an accepted target, once: waits until the norm of the feature error is at most `within`
  /// (m, rad or 1/m, as the feature's), at most `timeout` s. Returns the last received error; empty
  /// if there was none.
  std::optional<double> follow(double within, double timeout);

 private:
  template <class Send, class Renew>
  Answer wait(Send send, Renew renew, double timeout);

  bus::MessageBus& control_;
  bus::MessageBus& housekeeping_;
  bus::TypedSubscription<feature_t> features_;
  bus::TypedSubscription<component_event_t> events_;
  bus::TypedPublisher<component_command_t> commands_;
  bus::TypedPublisher<shape_target_t> targets_;
  bus::MessageSigner command_sealer_, target_sealer_;
  bus::HeaderStamper command_stamp_, target_stamp_;
  int revision_ = -1;  // of the last target
};

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kRepeat{200};
constexpr std::int64_t kPatience = 20'000'000;  // ns, polling interval of the bus

Conversation::Conversation(bus::MessageBus& control, bus::MessageBus& housekeeping,
                           const bus::Access& access)
    : control_(control),
      housekeeping_(housekeeping),
      features_(control, channel::kFeature, 64),
      events_(housekeeping, channel::kComponentEvent, 64),
      commands_(control, channel::kComponentCommand),
      targets_(control, channel::kShapeTarget),
      command_sealer_(channel::kComponentCommand, access),
      target_sealer_(channel::kShapeTarget, access),
      command_stamp_(bus::random_session()),
      target_stamp_(bus::random_session()) {
  housekeeping_.start_without_thread();
}

/// `send`: sends, and returns the counter of the message; counters do not decrease. `renew` is
/// called if it was signed before the daemon started, which would never accept it.
template <class Send, class Renew>
Answer Conversation::wait(Send send, Renew renew, double timeout) {
  const auto end = Clock::now() + std::chrono::duration<double>(timeout);
  const std::int64_t first = send();
  std::int64_t last = first;
  auto again = Clock::now() + kRepeat;
  Answer answer;
  while (Clock::now() < end) {
    housekeeping_.receive(kPatience);
    component_event_t event;
    std::int64_t arrival_ns = 0;
    while (events_.take(event, arrival_ns)) {
      const std::string name = bus::get_text(event.event);
      if (name == "no_access") answer.reason = name + ": " + bus::get_text(event.reason);
      if (event.command_counter < first || event.command_counter > last) continue;
      if (name == "no_access") {
        if (event.command_counter == last) renew();
        continue;
      }
      if (name == "replacing") {
        answer.reason = "the replacement has begun, but its end was not heard of";
        continue;
      }
      return {name, bus::get_text(event.reason)};
    }
    if (Clock::now() < again) continue;
    last = send();
    again = Clock::now() + kRepeat;
  }
  return answer;
}

Answer Conversation::ask(component_command_t command, double timeout) {
  const auto seal = [&] {
    const std::int64_t now = bus::wall_clock_us();
    command_stamp_.put(command, now);
    command_sealer_.put(command, now);
  };
  seal();
  // Identical in each repetition, so that the daemon recognises it.
  const auto send = [&] {
    commands_.publish(command);
    return command.counter;
  };
  return wait(send, seal, timeout);
}

Answer Conversation::ask(std::vector<shape_target_t> target, double timeout) {
  // The daemon does not answer a repeated target: a new revision of it is answered, with the
  // counter of the chunk that completed it.
  int revision = target.at(0).revision - 1;
  const auto send = [&] {
    ++revision;
    for (shape_target_t& chunk : target) {
      const std::int64_t now = bus::wall_clock_us();
      chunk.revision = revision;
      target_stamp_.put(chunk, now);
      target_sealer_.put(chunk, now);
      targets_.publish(chunk);
    }
    return target.back().counter;
  };
  const Answer answer = wait(
      send, [] {}, timeout);
  revision_ = revision;
  return answer;
}

std::optional<double> Conversation::follow(double within, double timeout) {
  const auto end = Clock::now() + std::chrono::duration<double>(timeout);
  control_.start_without_thread();
  std::optional<double> error;
  while (Clock::now() < end && !(error && *error <= within)) {
    control_.receive(kPatience);
    feature_t feature;
    std::int64_t arrival_ns = 0;
    while (features_.take(feature, arrival_ns)) {
      if (feature.revision != revision_) continue;
      const int count = std::clamp(feature.error_count, 0, 32);
      error =
          std::sqrt(std::inner_product(feature.error, feature.error + count, feature.error, 0.));
    }
  }
  return error;
}

}  // namespace
}  // namespace palpate::command

namespace {

namespace bus = palpate::bus;
namespace command = palpate::command;

struct Options {
  std::string control = "udpm://239.255.76.67:7667?ttl=0";
  std::string housekeeping = "udpm://239.255.76.68:7668?ttl=0";
  std::string key_file, new_key_file;
  double timeout = 10;  // s
  double reach = 0;     // m, rad, 1/m; 0: do not wait for it

  command::Request request;
  std::vector<std::string> parameters;  // key=value
  std::string kind;
  std::vector<double> points, values;
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
  for (CLI::App* sub : app.get_subcommands({})) sub->fallthrough();
}

/// Waits until the feature reaches its target, and prints the remaining error.
int follow(command::Conversation& conversation, const Options& options) {
  const std::optional<double> error = conversation.follow(options.reach, options.timeout);
  if (!error) {
    std::fprintf(stderr, "no FEATURE of this target in %g s\n", options.timeout);
    return 1;
  }
  const bool reached = *error <= options.reach;
  std::printf("%s: error %.4g\n", reached ? "reached" : "not reached", *error);
  return reached ? 0 : 1;
}

int run(const CLI::App& app, Options& options) {
  if (!options.new_key_file.empty()) {
    bus::make_key_file(options.new_key_file);
    std::printf("%s: a new key; name it under access.key_file\n", options.new_key_file.c_str());
    return 0;
  }
  bus::Access access;
  access.start_us = bus::wall_clock_us();
  if (!options.key_file.empty()) access.key = bus::read_key_file(options.key_file);
  const std::string name = app.get_subcommands().at(0)->get_name();
  const auto control = bus::make_lcm_bus(options.control);
  const auto housekeeping = bus::make_lcm_bus(options.housekeeping);
  command::Conversation conversation(*control, *housekeeping, access);

  command::Answer answer;
  if (name == "target") {
    answer = conversation.ask(command::make_target(options.kind, options.points, options.values),
                              options.timeout);
  } else {
    command::Request& request = options.request;
    request.event = name;
    if (!options.parameters.empty())
      request.parameters = command::make_parameters(options.parameters);
    answer = conversation.ask(command::make_command(request), options.timeout);
  }
  if (answer.event.empty()) {
    std::fprintf(stderr, "no answer in %g s%s%s\n", options.timeout,
                 answer.reason.empty() ? ": is palpated running on " : "; ",
                 answer.reason.empty() ? (options.control + "?").c_str() : answer.reason.c_str());
    return 1;
  }
  std::printf("%s%s%s\n", answer.event.c_str(), answer.reason.empty() ? "" : ": ",
              answer.reason.c_str());
  if (answer.done() && options.reach > 0) return follow(conversation, options);
  return answer.done() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("palpate-command sends a command to a running palpated, and prints the answer.");
  Options options;
  palpate::config::add_url_option(
      app, {{"control", &options.control}, {"housekeeping", &options.housekeeping}});
  app.add_option("--key", options.key_file, "file of the key that the daemon has");
  app.add_option("--timeout", options.timeout, "s, to wait for an answer")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  CLI::Option* make_key =
      app.add_option("--make-key", options.new_key_file, "write a new key to this file, and end");
  app.set_version_flag("--version", PALPATE_VERSION);
  app.footer(
      "Examples:\n"
      "  palpate-command zero\n"
      "  palpate-command --key robot.key start\n"
      "  palpate-command target point 0.25 0.03 0.08 --reach 2e-3\n"
      "  palpate-command replace control --set provider=kinematic");
  add_events(app, options);
  if (const auto code = palpate::config::parse(app, argc, argv,
                                               {{{1, "refused, no answer, or an error"}},
                                                {{"--housekeeping", "--url", "housekeeping="}}}))
    return *code;
  if (make_key->empty() && app.get_subcommands().empty())
    return palpate::config::usage_error(app, "a command is required");
  return palpate::common::run_program("error", [&] { return run(app, options); });
}

#include "program.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <thread>

#include "tools/common/program.hpp"

namespace palpate::bridge {
namespace {

volatile std::sig_atomic_t ended = 0;

std::int64_t monotonic_ns() {
  return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
}

}  // namespace

int bridge_main(const std::string& about, const std::string& example, int argc,
                const char* const* argv,
                const std::function<void(const config::Node&, const std::string& file)>& body) {
  CLI::App app(about);
  std::string configuration;
  std::vector<std::string> overrides;
  app.add_option("--config", configuration, "configuration, YAML; required");
  app.add_option("--set", overrides, "override a key: path.to.key=value (repeatable)")
      ->allow_extra_args(false);
  app.footer("Example:\n  " + example);
  if (const auto code =
          config::parse(app, argc, argv, {{{0, "ended by a signal"}, {78, "wrong configuration"}}}))
    return *code;
  if (configuration.empty()) return config::usage_error(app, "--config is required");
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { ended = 1; });
  return common::run_program("error", [&] {
    body(config::Node::load_file(configuration, overrides), configuration);
    return 0;
  });
}

BridgedArm::Options machine_options(double stale) {
  BridgedArm::Options options;
  options.stale = stale;
  options.now_ns = monotonic_ns;
  options.wall_clock = bus::wall_clock_us;
  options.say = [](const std::string& text) { std::fprintf(stderr, "%s\n", text.c_str()); };
  return options;
}

void run(driver::Driver& cell, bus::MessageBus& control, const BridgedArm& arm,
         const std::function<void(std::int64_t utime)>& also,
         const std::function<void(std::int64_t until_ns)>& wait) {
  driver::run(cell, control, ended, also, wait);
  const BridgedArm::Counts& counts = arm.counts();
  std::printf("%lld states, %lld rejected, %lld absences of the arm's driver, %lld commands\n",
              static_cast<long long>(counts.statuses), static_cast<long long>(counts.rejected),
              static_cast<long long>(counts.absences), static_cast<long long>(counts.commands));
}

void run(bus::MessageBus& control, const std::function<void(std::int64_t utime)>& each) {
  control.start_without_thread();
  auto next = std::chrono::steady_clock::now();
  while (ended == 0) {
    control.receive(0);
    each(bus::wall_clock_us());
    next = std::max(next + std::chrono::milliseconds(1), std::chrono::steady_clock::now());
    std::this_thread::sleep_until(next);
  }
}

}  // namespace palpate::bridge

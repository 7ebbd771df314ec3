// palpate-drake: palpated's robot behind Drake's LCM drivers. See --help.

#include <CLI/CLI.hpp>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <lcm/lcm-cpp.hpp>

#include "drake_arm.hpp"
#include "settings.hpp"
#include "tools/common/program.hpp"
#include "tools/driver/driver.hpp"
#include "tools/record/listener.hpp"

namespace {

namespace bus = palpate::bus;
namespace driver = palpate::driver;
namespace bridge = palpate::drake_bridge;

struct Options {
  std::string configuration;
  std::vector<std::string> overrides;
};

volatile std::sig_atomic_t ended = 0;

std::int64_t monotonic_ns() {
  return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
}

/// Shapes from palpated's housekeeping URL to meldis, in a thread of its own. By liblcm, which
/// publishes messages of any size.
class ShapeRelay {
 public:
  ShapeRelay(const bridge::ShapeView::Options& options, const std::string& from,
             const std::string& to)
      : view_(options),
        to_(to),
        listener_(sources(from), [this](const palpate::record::Heard& heard) {
          if (view_.take(heard.channel, heard.data, heard.size, heard.utime))
            to_.publish(bridge::ShapeView::kChannel, &view_.message());
        }) {
    if (!to_.good())
      throw std::runtime_error("liblcm cannot open " + to + "; its message is above");
    listener_.start();
  }

 private:
  static std::vector<palpate::record::Source> sources(const std::string& url) {
    return {{"housekeeping", bus::parse_udpm_url(url)}};
  }

  bridge::ShapeView view_;
  lcm::LCM to_;
  palpate::record::Listener listener_;  // last: its thread uses the others
};

int run(const Options& options) {
  const bridge::Settings settings = bridge::read_settings(
      palpate::config::Node::load_file(options.configuration, options.overrides));
  const bus::Access access{settings.key, bus::wall_clock_us()};
  const auto control = bus::make_lcm_bus(settings.control);
  const auto drake = bus::make_lcm_bus(settings.drake);

  bridge::DrakeArm::Options arm_options;
  arm_options.stale = settings.stale;
  arm_options.wrench = settings.wrench;
  arm_options.now_ns = monotonic_ns;
  arm_options.wall_clock = bus::wall_clock_us;
  arm_options.say = [](const std::string& text) { std::fprintf(stderr, "%s\n", text.c_str()); };
  bridge::DrakeArm arm(*drake, settings.chain.joint_count(), settings.make_protocol(*drake),
                       arm_options);
  driver::Driver cell(*control, settings.chain, settings.guard, access, arm);
  std::optional<bridge::Gripper> gripper;
  if (settings.gripper) gripper.emplace(*control, *drake, access, *settings.gripper);
  std::optional<ShapeRelay> relay;
  if (settings.shape) relay.emplace(*settings.shape, settings.housekeeping, settings.drake);

  drake->start_without_thread();
  std::printf("%s: %d joints, waits for %s\n", options.configuration.c_str(),
              settings.chain.joint_count(), settings.status.c_str());
  std::fflush(stdout);
  driver::run(cell, *control, ended, [&gripper](std::int64_t utime) {
    if (gripper) gripper->cycle(utime);
  });
  const bridge::DrakeArm::Counts& counts = arm.counts();
  std::printf("%lld states, %lld rejected, %lld absences of the arm's driver, %lld commands\n",
              static_cast<long long>(counts.statuses), static_cast<long long>(counts.rejected),
              static_cast<long long>(counts.absences), static_cast<long long>(counts.commands));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "palpate-drake connects palpated with an arm behind Drake's LCM drivers or simulations:\n"
      "IIWA_STATUS and IIWA_COMMAND, or PANDA_STATUS and PANDA_COMMAND in velocity mode; a Schunk\n"
      "WSG as the hand; lcmt_force_torque; and palpated's shape for meldis. See "
      "docs/robots/drake.md.");
  Options options;
  app.add_option("--config", options.configuration, "configuration, YAML; required");
  app.add_option("--set", options.overrides, "override a key: path.to.key=value (repeatable)")
      ->allow_extra_args(false);
  app.footer("Example:\n  palpate-drake --config iiwa.yaml --set guard.linear_speed=0.05");
  if (const auto code = palpate::config::parse(
          app, argc, argv, {{{0, "ended by a signal"}, {78, "wrong configuration"}}}))
    return *code;
  if (options.configuration.empty())
    return palpate::config::usage_error(app, "--config is required");
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { ended = 1; });
  return palpate::common::run_program("error", [&] { return run(options); });
}

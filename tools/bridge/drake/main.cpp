// palpate-drake: palpated's robot behind Drake's LCM drivers. See --help.

#include <cstdio>
#include <lcm/lcm-cpp.hpp>

#include "messages.hpp"
#include "rt/bus/lcm_bus.hpp"
#include "settings.hpp"
#include "tools/bridge/common/program.hpp"
#include "tools/record/listener.hpp"

namespace {

namespace bridge = palpate::bridge;
namespace bus = palpate::bus;
namespace drake_bridge = palpate::drake_bridge;

/// Shapes from palpated's housekeeping URL to meldis, in a thread of its own. By liblcm, which
/// publishes messages of any size.
class ShapeRelay {
 public:
  ShapeRelay(const drake_bridge::ShapeView::Options& options, const std::string& from,
             const std::string& to)
      : view_(options),
        to_(to),
        listener_(sources(from), [this](const palpate::record::Heard& heard) {
          if (view_.take(heard.channel, heard.data, heard.size, heard.utime))
            to_.publish(drake_bridge::ShapeView::kChannel, &view_.message());
        }) {
    if (!to_.good())
      throw std::runtime_error("liblcm cannot open " + to + "; its message is above");
    listener_.start();
  }

 private:
  static std::vector<palpate::record::Source> sources(const std::string& url) {
    return {{"housekeeping", bus::parse_udpm_url(url)}};
  }

  drake_bridge::ShapeView view_;
  lcm::LCM to_;
  palpate::record::Listener listener_;  // last: its thread uses the others
};

void run(const palpate::config::Node& configuration, const std::string& file) {
  const drake_bridge::Settings settings = drake_bridge::read_settings(configuration);
  const bus::Access access{settings.key, bus::wall_clock_us()};
  const auto control = bus::make_lcm_bus(settings.control);
  control->set_channel_names(settings.channels);
  const auto drake = bus::make_lcm_bus(settings.drake, settings.largest_message);

  std::optional<drake_bridge::ForceTorqueInput> wrenches;
  if (!settings.wrench.empty()) wrenches.emplace(*drake, settings.wrench);
  bridge::BridgedArm arm(settings.chain.joint_count(), settings.make_protocol(*drake),
                         bridge::machine_options(settings.stale), wrenches ? &*wrenches : nullptr);
  palpate::driver::Driver cell(*control, settings.chain, settings.guard, access, arm);
  std::optional<drake_bridge::Gripper> gripper;
  if (settings.gripper) gripper.emplace(*control, *drake, access, *settings.gripper);
  std::optional<ShapeRelay> relay;
  if (settings.shape) relay.emplace(*settings.shape, settings.housekeeping, settings.drake);

  drake->start_without_thread();
  std::printf("%s: %d joints, waits for %s\n", file.c_str(), settings.chain.joint_count(),
              settings.status.c_str());
  std::fflush(stdout);
  bridge::run(cell, *control, arm, [&gripper](std::int64_t utime) {
    if (gripper) gripper->cycle(utime);
  });
}

}  // namespace

int main(int argc, char** argv) {
  return bridge::bridge_main(
      "palpate-drake connects palpated with an arm behind Drake's LCM drivers or simulations:\n"
      "IIWA_STATUS and IIWA_COMMAND, or PANDA_STATUS and PANDA_COMMAND in velocity mode; a Schunk\n"
      "WSG as the hand; lcmt_force_torque; and palpated's shape for meldis. See "
      "docs/robots/drake.md.",
      "palpate-drake --config iiwa.yaml --set guard.linear_speed=0.05", argc, argv, run);
}

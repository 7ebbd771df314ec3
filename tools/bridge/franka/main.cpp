// palpate-franka: palpated's robot is a Franka arm. See --help.

#include <cstdio>

#include "rt/loop/real_time.hpp"
#include "settings.hpp"
#include "tools/bridge/common/program.hpp"

namespace {

namespace bridge = palpate::bridge;
namespace bus = palpate::bus;
namespace franka = palpate::franka_bridge;

/// Every state has to be answered within 1 ms.
void take_real_time(int priority, const bridge::BridgedArm::Options& options) {
  if (priority == 0) return;
  for (const std::string& refusal :
       {palpate::loop::lock_and_prefault_memory(), palpate::loop::take_fifo(priority)})
    if (!refusal.empty()) options.say(refusal);
}

void run(const palpate::config::Node& configuration, const std::string& file) {
  franka::Settings settings = franka::read_settings(configuration);
  const bus::Access access{settings.key, bus::wall_clock_us()};
  const auto control = bus::make_lcm_bus(settings.control);
  control->set_channel_names(settings.channels);
  const bridge::BridgedArm::Options options = bridge::machine_options(settings.stale);

  settings.arm.now_ns = options.now_ns;
  auto protocol =
      std::make_unique<franka::Franka>(bridge::make_tcp_stream(settings.host, settings.port),
                                       franka::make_udp_datagrams(settings.host), settings.arm);
  franka::Franka& arm_protocol = *protocol;
  bridge::BridgedArm arm(franka::kJoints, std::move(protocol), options,
                         settings.arm.wrench ? &arm_protocol : nullptr);
  palpate::driver::Driver cell(*control, settings.chain, settings.guard, access, arm);

  take_real_time(settings.fifo_priority, options);
  std::printf("%s: waits for the arm %s\n", file.c_str(), settings.host.c_str());
  std::fflush(stdout);
  bridge::run(cell, *control, arm, {},
              [&arm_protocol](std::int64_t until_ns) { arm_protocol.wait(until_ns); });
  arm_protocol.finish();
  const franka::FciClient::Counts& counts = arm_protocol.counts();
  std::printf("%lld states lost, %lld overtaken, %lld late, %lld malformed; %lld motions\n",
              static_cast<long long>(counts.lost), static_cast<long long>(counts.overtaken),
              static_cast<long long>(arm_protocol.late()), static_cast<long long>(counts.malformed),
              static_cast<long long>(arm_protocol.motions()));
}

}  // namespace

int main(int argc, char** argv) {
  return bridge::bridge_main(
      "palpate-franka connects palpated with a Franka arm by the Franka Control Interface (FCI),\n"
      "version 10: states at 1 kHz, each answered with joint velocities while the arm moves; the\n"
      "arm's external wrench or torques. See docs/robots/franka.md.",
      "palpate-franka --config fr3.yaml --set robot.host=172.16.0.2", argc, argv, run);
}

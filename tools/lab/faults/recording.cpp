#include "tools/lab/faults/recording.hpp"

#include "rt/config/installation.hpp"
#include "rt/daemon/daemon.hpp"
#include "sim/scenes/simulation.hpp"

namespace palpate::faults {
namespace {

std::string source(const char* path) { return (config::data_folder() / path).string(); }

}  // namespace

config::Node configuration(const std::vector<std::string>& overrides) {
  std::vector<std::string> all = {
      "object.order=linear",
      "object.mesh={box: {size: [0.5, 0.06, 0.06], cells: [6, 1, 1]}}",
      "loop.degraded_after_ms=6",
      "loop.overrun_window_ms=20",
      "loop.safe_stop_after_ms=20",
      "loop.replace_delay=20",
      // The simulator's encoders have noise, so identical consecutive states are a fault.
      "inputs={frozen_after_ms: {robot: 500}}",
  };
  all.insert(all.end(), overrides.begin(), overrides.end());
  return config::Node::load_file(source("rt/config/examples/bar_long_soft.yaml"), all);
}

Eigen::Vector3d target_of(const Eigen::Vector3d& rest_point) {
  return rest_point + Eigen::Vector3d(0, 0, 0.04);
}

std::vector<shape_target_t> message_of(const Eigen::Vector3d& target) {
  return client::make_target("point", {}, {target.x(), target.y(), target.z()});
}

Recording record_loop(int ticks) {
  const auto hub = bus::make_memory_hub();
  const auto sim_bus = bus::make_memory_bus(hub), daemon_bus = bus::make_memory_bus(hub),
             user_bus = bus::make_memory_bus(hub);
  // A plant with fewer elements is sufficient: only consistency of the sensors' messages matters.
  scenes::Simulation simulation(
      config::Node::load_file(source("sim/scenes/bar_long_soft_control.yaml"),
                              {"object.elements=[8, 1, 1]"}),
      *sim_bus, *sim_bus);
  daemon::Daemon daemon(configuration(), *daemon_bus, *daemon_bus, daemon::Mode::kDeterministic, 1);
  client::Client user(*user_bus, *user_bus, {}, 1);

  Recording recording;
  recording.target = target_of(daemon.pipeline().feature().rest_points()[0]);
  Stream all;
  bus::record(*hub, &all);
  const Eigen::Matrix3Xd rest = daemon.pipeline().object().corners.nodes;
  for (int tick = 1; tick <= ticks; ++tick) {
    const std::int64_t now_ns = 1'000'000LL * tick;
    bus::set_time(*hub, now_ns);
    if (tick == kStartTick) user.send({"start"}, 0);
    if (tick == kTargetTick) user.set_target(message_of(recording.target), 0);
    simulation.step();
    daemon.tick({now_ns, now_ns / 1000, 0});
    for (bus::Published& message : all)
      if (is_sensor(message.channel)) recording.stream.push_back(std::move(message));
    all.clear();
    if (tick % kTruthEvery != 0) continue;
    recording.truth.emplace_back(3, rest.cols());
    for (int i = 0; i < rest.cols(); ++i)
      recording.truth.back().col(i) = simulation.plant().position_at(rest.col(i));
  }
  return recording;
}

}  // namespace palpate::faults

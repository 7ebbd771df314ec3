#include "tools/lab/fit_check/simulated.hpp"

#include <algorithm>
#include <palpate/channels.hpp>
#include <palpate/ft_wrench_t.hpp>
#include <palpate/robot_state_t.hpp>
#include <palpate/shape_observation_t.hpp>
#include <stdexcept>

#include "core/math/random.hpp"
#include "rt/bus/checked_decode.hpp"
#include "sim/scenes/simulation.hpp"
#include "tools/log/event_log.hpp"

namespace palpate::fit_check {
namespace {

constexpr int kMarkerTicks = 10;

/// Markers by message.
struct Seen {
  std::vector<std::int64_t> times;         // us
  std::vector<Eigen::Matrix3Xd> points_W;  // m
};

/// Maximum over all messages, per coordinate.
double greatest_way(const std::vector<Eigen::Matrix3Xd>& points) {
  Eigen::Matrix3Xd least = points.front(), most = least;
  for (const Eigen::Matrix3Xd& p : points) {
    least = least.cwiseMin(p);
    most = most.cwiseMax(p);
  }
  return (most - least).maxCoeff();
}

void write_markers(const Seen& seen, double noise, math::Random random, log::EventLog& log) {
  if (seen.times.empty() || seen.points_W[0].cols() == 0) return;
  const double deviation = noise * greatest_way(seen.points_W);
  for (std::size_t i = 0; i < seen.times.size(); ++i) {
    shape_observation_t message{};
    message.utime = seen.times[i];
    message.seq = static_cast<int>(i);
    message.count = static_cast<int>(seen.points_W[i].cols());
    message.deviation = deviation;
    for (int k = 0; k < message.count; ++k)
      for (int axis = 0; axis < 3; ++axis)
        message.points[k][axis] =
            static_cast<float>(seen.points_W[i](axis, k) + deviation * random.normal());
    log.write(channel::kShapeObservation, message.utime, message);
  }
}

/// Standard deviations of noise on the wrench, N and N m.
struct WrenchNoise {
  double force = 0, torque = 0;
};

void write_messages(const std::vector<bus::Published>& published, const WrenchNoise& deviation,
                    math::Random random, log::EventLog& log) {
  std::vector<ft_wrench_t> wrenches;
  for (const bus::Published& p : published) {
    const int size = static_cast<int>(p.data.size());
    robot_state_t state;
    if (p.channel == channel::kRobotState && bus::checked_decode(state, p.data.data(), size))
      log.write(p.channel, state.utime, state);
    ft_wrench_t wrench;
    if (p.channel == channel::kFtWrench && bus::checked_decode(wrench, p.data.data(), size))
      wrenches.push_back(wrench);
  }
  for (ft_wrench_t& wrench : wrenches) {
    for (int k = 0; k < 6; ++k)
      wrench.wrench[k] += (k < 3 ? deviation.force : deviation.torque) * random.normal();
    log.write(channel::kFtWrench, wrench.utime, wrench);
  }
}

}  // namespace

void record(const SimulatedRecording& recording, const std::string& log,
            const std::function<void(double)>& progress) {
  const auto hub = bus::make_memory_hub();
  const auto control = bus::make_memory_bus(hub), housekeeping = bus::make_memory_bus(hub);
  scenes::Simulation simulation(config::Node::load_file(recording.scene, recording.overrides),
                                *control, *housekeeping);
  if (!simulation.scene().motion)
    throw std::runtime_error(recording.scene + ": has no motion of its own");
  std::vector<object::MaterialPoint> markers;
  for (const Eigen::Vector3d& marker : recording.markers)
    markers.push_back(simulation.plant().locate(marker));
  std::vector<bus::Published> published;
  bus::record(*hub, &published);
  const auto ticks = static_cast<std::int64_t>(simulation.scene().motion->duration() /
                                               scenes::Simulation::kPeriod);
  Seen seen;
  WrenchNoise noise;
  while (simulation.tick() < ticks) {
    simulation.obey();
    simulation.advance();
    simulation.publish();
    const math::Wrench held = simulation.object().hand_wrench(0);
    noise.force = std::max(noise.force, recording.noise * held.force.norm());
    noise.torque = std::max(noise.torque, recording.noise * held.torque.norm());
    if (simulation.tick() % kMarkerTicks != 0) continue;
    Eigen::Matrix3Xd points(3, markers.size());
    for (std::size_t k = 0; k < markers.size(); ++k)
      points.col(static_cast<Eigen::Index>(k)) =
          simulation.scene().X_WO * markers[k].interpolate(simulation.plant().positions());
    seen.times.push_back(simulation.utime());
    seen.points_W.push_back(points);
    if (progress) progress(static_cast<double>(simulation.tick()) / static_cast<double>(ticks));
  }
  bus::record(*hub, nullptr);
  log::EventLog file(log);
  const math::Random random(static_cast<std::uint64_t>(recording.seed), "recording");
  write_messages(published, noise, random.split("wrench"), file);
  write_markers(seen, recording.noise, random.split("markers"), file);
}

}  // namespace palpate::fit_check

#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <palpate/component_command_t.hpp>
#include <palpate/component_event_t.hpp>
#include <palpate/shape_target_t.hpp>
#include <palpate/twist_command_t.hpp>
#include <string_view>

#include "rt/bus/text.hpp"
#include "rt/daemon/daemon.hpp"
#include "sim/scenes/simulation.hpp"
#include "tests/support/recordings.hpp"

namespace palpate {

/// Forwards everything, except messages on channels whose name ends in `muted`.
class MutableBus : public bus::MessageBus {
 public:
  explicit MutableBus(std::unique_ptr<bus::MessageBus> bus) : bus_(std::move(bus)) {}
  bus::Subscription& subscribe(const std::string& channel, int encoded_size,
                               std::int64_t fingerprint, int depth) override {
    return bus_->subscribe(channel, encoded_size, fingerprint, depth);
  }
  void start() override { bus_->start(); }
  void start_without_thread() override { bus_->start_without_thread(); }
  bool receive(std::int64_t timeout_ns) noexcept override { return bus_->receive(timeout_ns); }
  void stop() noexcept override { bus_->stop(); }
  bool publish(const char* channel, const void* data, int size) noexcept override {
    const std::string_view name = channel;
    const bool is_muted = !muted.empty() && name.size() >= muted.size() &&
                          name.substr(name.size() - muted.size()) == muted;
    return is_muted || bus_->publish(channel, data, size);
  }
  std::string_view muted;

 private:
  std::unique_ptr<bus::MessageBus> bus_;
};

/// Simulator and daemon in one process over the in-memory bus, in virtual time: the same classes as
/// in palpate-sim and palpated.
class ClosedLoop {
 public:
  ClosedLoop(const std::string& scene, const std::string& configuration,
             const std::vector<std::string>& scene_overrides = {},
             const std::vector<std::string>& daemon_overrides = {})
      : hub_(bus::make_memory_hub()),
        sim_bus_(std::make_unique<MutableBus>(bus::make_memory_bus(hub_))),
        daemon_bus_(bus::make_memory_bus(hub_)),
        user_bus_(bus::make_memory_bus(hub_)),
        simulation_(config::Node::load_file(source(scene), scene_overrides), *sim_bus_, *sim_bus_),
        daemon_(config::Node::load_file(source(configuration), daemon_overrides), *daemon_bus_,
                *daemon_bus_, daemon::Mode::kDeterministic, 1),
        commands_(*user_bus_, "COMPONENT_COMMAND"),
        targets_(*user_bus_, "SHAPE_TARGET"),
        twists_(*user_bus_, "TWIST_COMMAND", 16),
        events_(*user_bus_, "COMPONENT_EVENT", 64) {}

  /// Advances both; `each` is called after every millisecond.
  template <class F>
  void run(double seconds, F&& each) {
    for (int i = 0; i < static_cast<int>(seconds * 1000); ++i) {
      const std::int64_t now_ns = simulation_.tick() * 1'000'000;
      bus::set_time(*hub_, now_ns);
      simulation_.step();
      daemon_.tick({now_ns, now_ns / 1000, 0});
      each();
    }
  }
  void run(double seconds) {
    run(seconds, [] {});
  }

  /// From now on messages of the simulator on channels whose name ends so are dropped.
  void mute(std::string_view ending) { sim_bus_->muted = ending; }

  void send_event(const char* event) {
    component_command_t message{};
    message.session = 1;
    message.counter = ++counter_;
    bus::put_text(message.slot, "all");
    bus::put_text(message.event, event);
    commands_.publish(message);
  }

  /// Requests a replacement; parameters are YAML.
  void send_replace(const char* slot, const char* component, const std::string& parameters,
                    const char* instance = "") {
    component_command_t message{};
    message.session = 1;
    message.counter = ++counter_;
    bus::put_text(message.slot, slot);
    bus::put_text(message.instance, instance);
    bus::put_text(message.event, "replace");
    bus::put_text(message.component, component);
    bus::put_text(message.parameters, parameters);
    commands_.publish(message);
  }
  /// Events published by the daemon since the last call, as "event: reason".
  std::vector<std::string> take_events() {
    std::vector<std::string> texts;
    component_event_t event;
    std::int64_t arrival_ns = 0;
    while (events_.take(event, arrival_ns))
      texts.push_back(std::string(bus::get_text(event.event)) + ": " + bus::get_text(event.reason));
    return texts;
  }

  void send_target(const char* kind, const Eigen::VectorXd& value) {
    shape_target_t message{};
    message.session = 1;
    message.revision = ++revision_;
    message.chunks = 1;
    bus::put_text(message.kind, kind);
    message.value_count = static_cast<int>(value.size());
    std::copy_n(value.data(), value.size(), message.values);
    targets_.publish(message);
  }

  /// True positions of the estimator's corner nodes: 3 x n in O.
  Eigen::Matrix3Xd truth() {
    const Eigen::Matrix3Xd& rest = daemon_.pipeline().object().corners.nodes;
    Eigen::Matrix3Xd positions(3, rest.cols());
    for (int i = 0; i < rest.cols(); ++i) {
      positions.col(i) = simulation_.plant().position_at(rest.col(i));
    }
    return positions;
  }
  /// Distance of estimate and truth at every corner node, m.
  Eigen::VectorXd shape_error() {
    const Eigen::Matrix3Xd x = truth();
    return (daemon_.pipeline().model().positions().leftCols(x.cols()) - x).colwise().norm();
  }

  /// Messages between simulator, daemon and user.
  bus::MessageBus& user_bus() { return *user_bus_; }

  scenes::Simulation& simulation() { return simulation_; }
  daemon::Daemon& daemon() { return daemon_; }
  bus::TypedSubscription<twist_command_t>& twists() { return twists_; }

 private:
  static std::string source(const std::string& path) {
    return std::string(PALPATE_SOURCE_DIR) + "/" + path;
  }

  std::shared_ptr<bus::MemoryHub> hub_;
  std::unique_ptr<MutableBus> sim_bus_;
  std::unique_ptr<bus::MessageBus> daemon_bus_, user_bus_;
  scenes::Simulation simulation_;
  daemon::Daemon daemon_;
  bus::TypedPublisher<component_command_t> commands_;
  bus::TypedPublisher<shape_target_t> targets_;
  bus::TypedSubscription<twist_command_t> twists_;
  bus::TypedSubscription<component_event_t> events_;
  std::int64_t counter_ = 0;
  std::int32_t revision_ = 0;
};

}  // namespace palpate

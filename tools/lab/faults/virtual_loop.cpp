#include "tools/lab/faults/virtual_loop.hpp"

#include <palpate/channels.hpp>
#include <utility>

#include "rt/config/installation.hpp"

namespace palpate::faults {

VirtualLoop::VirtualLoop(const config::Node& root)
    : daemon_(std::make_unique<daemon::Daemon>(root, *daemon_bus_, *daemon_bus_,
                                               daemon::Mode::kDeterministic, 1)) {
  start_simulation();
}

void VirtualLoop::start_simulation() {
  simulation_.reset();
  robot_bus_ = bus::make_memory_bus(robot_hub_);
  truth_bus_ = bus::make_memory_bus(truth_hub_);
  const std::string scene =
      (config::data_folder() / "sim/scenes/bar_long_soft_control.yaml").string();
  // A plant with fewer elements is sufficient, as in record_loop().
  simulation_ = std::make_unique<scenes::Simulation>(
      config::Node::load_file(scene, {"object.elements=[8, 1, 1]"}), *robot_bus_, *truth_bus_,
      scenes::Origin{++session_, static_cast<std::int64_t>(1e6 * time())});
}

void VirtualLoop::advance() {
  const std::int64_t now_ns = 1'000'000 * ++tick_;
  bus::set_time(*daemon_hub_, now_ns);
  bus::set_time(*robot_hub_, now_ns);
}

bool VirtualLoop::step() {
  const std::int64_t now_ns = 1'000'000 * tick_;
  if (simulation_) {
    bus::record(*robot_hub_, &sent_);
    simulation_->step();
    bus::record(*robot_hub_, nullptr);
  }
  for (const bus::Published& message : wire_.pass(std::exchange(sent_, {}), now_ns))
    to_daemon_->publish(message.channel.c_str(), message.data.data(),
                        static_cast<int>(message.data.size()));
  if (tick_ < wakes_at_) {
    ++missed_;
    return false;
  }
  daemon::Now now;
  now.monotonic_ns = now_ns;
  now.utime = now_ns / 1000 + clock_offset_us_;
  now.lateness_ns = 1'000'000 * std::exchange(missed_, 0);
  published_.clear();
  bus::record(*daemon_hub_, &published_);
  daemon_->tick(now);
  bus::record(*daemon_hub_, nullptr);
  for (const bus::Published& message : published_) {
    if (message.channel != channel::kTwistCommand || tick_ < silent_until_) continue;
    to_robot_->publish(message.channel.c_str(), message.data.data(),
                       static_cast<int>(message.data.size()));
  }
  return true;
}

}  // namespace palpate::faults

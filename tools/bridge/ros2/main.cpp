// palpate-ros2: palpated in a graph of ROS 2, without ROS 2. See --help.

#include <cstdio>
#include <list>
#include <optional>
#include <vector>

#include "diagnostics.hpp"
#include "rt/bus/udpm_url.hpp"
#include "settings.hpp"
#include "tools/bridge/common/program.hpp"
#include "tools/record/listener.hpp"

namespace {

namespace bridge = palpate::bridge;
namespace bus = palpate::bus;
namespace ros2 = palpate::ros2_bridge;

/// Shapes from palpated's housekeeping URL, in a thread of its own.
class ShapeRelay {
 public:
  ShapeRelay(const ros2::Participant& participant, const ros2::ShapeMarker::Options& options,
             const std::string& from)
      : marker_(participant, options),
        listener_({{"housekeeping", bus::parse_udpm_url(from)}},
                  [this](const palpate::record::Heard& heard) {
                    marker_.take(heard.channel, heard.data, heard.size, heard.utime);
                  }) {
    listener_.start();
  }

 private:
  ros2::ShapeMarker marker_;
  palpate::record::Listener listener_;  // last: its thread uses the other
};

/// Everything but the arm, a cycle of 1 ms at a time.
class Relays {
 public:
  Relays(const ros2::Participant& participant, const ros2::Settings& settings,
         bus::MessageBus& control, bus::MessageBus& housekeeping, const bus::Access& access,
         const ros2::Intake* arm)
      : housekeeping_(housekeeping),
        palpated_(control, housekeeping, access),
        telemetry_(participant, settings.telemetry, control) {
    if (arm != nullptr) intakes_.push_back(arm);
    if (settings.wrench)
      listen(wrench_, participant, settings.wrench->topic, settings.wrench->polarity,
             settings.clock, control);
    if (!settings.imu.empty()) listen(imu_, participant, settings.imu, settings.clock, control);
    if (!settings.commands.empty()) listen(commands_, participant, settings.commands, palpated_);
    if (settings.target) listen(target_, participant, *settings.target, palpated_);
    if (settings.cloud) intakes_.push_back(&cloud_.emplace(participant, *settings.cloud).intake());
    if (!settings.services.empty())
      for (const char* const event : {"start", "stop", "reset", "zero"})
        services_.emplace_back(participant, settings.services + "/" + event, event, palpated_);
    if (!settings.diagnostics.empty())
      diagnostics_.emplace(participant, settings.diagnostics, housekeeping,
                           [this] { return counters(); });
    if (settings.shape) shape_.emplace(participant, *settings.shape, settings.housekeeping);
  }

  void cycle(std::int64_t utime) {
    if (wrench_) wrench_->cycle(utime);
    if (imu_) imu_->cycle(utime);
    telemetry_.cycle();
    housekeeping_.receive(0);
    if (commands_) commands_->cycle(utime);
    if (target_) target_->cycle(utime);
    for (ros2::TriggerService& service : services_) service.cycle(utime);
    palpated_.service(utime);
    if (diagnostics_) diagnostics_->cycle(utime);
    for (ros2::Intake* const intake : printed_)
      if (const std::string text = intake->complaint(); !text.empty())
        std::fprintf(stderr, "%s\n", text.c_str());
  }

  /// By topic.
  std::vector<std::pair<std::string, std::string>> counters() const {
    std::vector<std::pair<std::string, std::string>> all;
    for (const ros2::Intake* const intake : intakes_)
      all.emplace_back(intake->topic(), intake->summary());
    return all;
  }

 private:
  template <class Relay, class... Arguments>
  void listen(std::optional<Relay>& relay, Arguments&... arguments) {
    printed_.push_back(&relay.emplace(arguments...).intake());
    intakes_.push_back(printed_.back());
  }

  bus::MessageBus& housekeeping_;
  palpate::client::Client palpated_;
  ros2::Telemetry telemetry_;
  std::optional<ros2::WrenchRelay> wrench_;
  std::optional<ros2::ImuRelay> imu_;
  std::optional<ros2::CommandTopic> commands_;
  std::optional<ros2::TargetTopic> target_;
  std::optional<ros2::CloudRelay> cloud_;
  std::list<ros2::TriggerService> services_;
  std::optional<ros2::Diagnostics> diagnostics_;
  std::optional<ShapeRelay> shape_;
  std::vector<ros2::Intake*> printed_;  // whose complaints this prints
  std::vector<const ros2::Intake*> intakes_;
};

/// The arm behind joint states, with all that is between it and palpated.
class Cell {
 public:
  Cell(const ros2::Participant& participant, const ros2::Settings::Robot& robot,
       bus::MessageBus& control, const bus::Access& access)
      : Cell(robot, control, access, make_protocol(participant, robot)) {}

  const ros2::Intake& intake() const { return protocol_.intake(); }
  void run(bus::MessageBus& control, const std::function<void(std::int64_t)>& also) {
    bridge::run(driver_, control, arm_, also);
  }

 private:
  Cell(const ros2::Settings::Robot& robot, bus::MessageBus& control, const bus::Access& access,
       std::unique_ptr<ros2::JointStateArm> protocol)
      : protocol_(*protocol),
        arm_(robot.chain.joint_count(), std::move(protocol), bridge::machine_options(robot.stale)),
        driver_(control, robot.chain, robot.guard, access, arm_) {}

  static std::unique_ptr<ros2::JointStateArm> make_protocol(const ros2::Participant& participant,
                                                            const ros2::Settings::Robot& robot) {
    const bridge::BridgedArm::Options machine = bridge::machine_options(robot.stale);
    ros2::JointStateArm::Options options = robot.arm;
    options.now_ns = machine.now_ns;
    options.wall_clock = machine.wall_clock;
    return std::make_unique<ros2::JointStateArm>(participant, robot.chain, options);
  }

  const ros2::JointStateArm& protocol_;
  bridge::BridgedArm arm_;
  palpate::driver::Driver driver_;
};

void run(const palpate::config::Node& configuration, const std::string& file) {
  const ros2::Settings settings = ros2::read_settings(configuration);
  const bus::Access access{settings.key, bus::wall_clock_us()};
  const auto control = bus::make_lcm_bus(settings.control);
  control->set_channel_names(settings.channels);
  const auto housekeeping = bus::make_lcm_bus(settings.housekeeping);
  const ros2::Participant participant(settings.participant);

  std::optional<Cell> cell;
  if (settings.robot) cell.emplace(participant, *settings.robot, *control, access);
  Relays relays(participant, settings, *control, *housekeeping, access,
                cell ? &cell->intake() : nullptr);
  housekeeping->start_without_thread();
  std::printf("%s: in domain %d, waits for %s\n", file.c_str(), settings.participant.domain,
              cell ? settings.robot->arm.states.c_str() : "messages");
  std::fflush(stdout);
  const auto cycle = [&relays](std::int64_t utime) { relays.cycle(utime); };
  if (cell)
    cell->run(*control, cycle);
  else
    bridge::run(*control, cycle);
  for (const auto& [topic, counts] : relays.counters())
    std::printf("%s: %s\n", topic.c_str(), counts.c_str());
}

}  // namespace

int main(int argc, char** argv) {
  return bridge::bridge_main(
      "palpate-ros2 connects palpated with nodes of ROS 2 by DDS; ROS 2 need not be installed: an\n"
      "arm by its joint states, commanded by joint velocities or a twist; wrench, IMU and clouds\n"
      "in; wrench, poses, shape and diagnostics out; services. See docs/robots/ros2.md.",
      "palpate-ros2 --config ros2.yaml --set ros.domain=7", argc, argv, run);
}

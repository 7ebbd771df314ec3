#include "tools/lab/faults/long_run.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <palpate/channels.hpp>
#include <utility>

#include "rt/config/installation.hpp"
#include "tools/lab/faults/recording.hpp"
#include "tools/lab/faults/replay.hpp"
#include "tools/lab/faults/wishes.hpp"

namespace palpate::faults {
namespace {

using pipeline::LifeCycle;

constexpr double kShortestRest = 4, kLongestRest = 7;  // s, in which the target is reached
constexpr double kRecoverWithin = 5;                   // s
constexpr int kUserLooksEvery = 50;                    // ticks
constexpr std::int64_t kZeroWithinTicks = 100;
constexpr std::size_t kComplaints = 20;

}  // namespace

LongRun::LongRun(std::uint64_t seed) : random_(seed, "long run") {
  const config::Node root =
      configuration({"object.order=quadratic", "estimation.component=pose_wrench_filter"});
  daemon_ = std::make_unique<daemon::Daemon>(root, *daemon_bus_, *daemon_bus_,
                                             daemon::Mode::kDeterministic, 1);
  user_ = std::make_unique<User>(*to_daemon_);
  monitor_ =
      std::make_unique<Monitor>(registry::read_gate_limits(root), daemon_->settings().loop.period);
  rest_point_ = target_ = daemon_->pipeline().feature().rest_points()[0];
  start_simulation();
}

LongRun::~LongRun() = default;

void LongRun::start_simulation() {
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

void LongRun::run(double seconds) {
  const auto ticks = std::llround(1e3 * seconds);
  for (std::int64_t i = 0; i < ticks; ++i) tick();
  report_.time = time();
}

void LongRun::tick() {
  const std::int64_t now_ns = 1'000'000 * ++tick_;
  bus::set_time(*daemon_hub_, now_ns);
  bus::set_time(*robot_hub_, now_ns);
  live();
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
    return;
  }
  daemon::Now now;
  now.monotonic_ns = now_ns;
  now.utime = now_ns / 1000 + clock_offset_us_;
  now.lateness_ns = 1'000'000 * std::exchange(missed_, 0);
  bus::record(*daemon_hub_, &said_);
  daemon_->tick(now);
  bus::record(*daemon_hub_, nullptr);
  listen();
}

/// The monitor checks all messages, and the robot receives its command.
void LongRun::listen() {
  look_at(said_, *daemon_, *monitor_);
  for (const bus::Published& message : said_) {
    if (message.channel != channel::kTwistCommand || tick_ < silent_until_) continue;
    to_robot_->publish(message.channel.c_str(), message.data.data(),
                       static_cast<int>(message.data.size()));
  }
  said_.clear();
  for (const EventNote& event : monitor_->events()) {
    report_.replaced += event.event == "replaced" ? 1 : 0;
    report_.refused += event.event == "refused" ? 1 : 0;
  }
  if (!monitor_->complaint().empty()) fail(monitor_->complaint());
  monitor_->forget();
  report_.messages = monitor_->messages();
  const LifeCycle state = daemon_->pipeline().condition().state;
  const bool runs = state == LifeCycle::kActive || state == LifeCycle::kDegraded;
  stopped_ticks_ = runs ? 0 : stopped_ticks_ + 1;
  if (stopped_ticks_ >= kZeroWithinTicks && monitor_->speed() > 0)
    fail("it does not run, and still commands");
}

void LongRun::fail(const std::string& why) {
  ++report_.failures;
  if (report_.complaints.size() < kComplaints)
    report_.complaints.push_back("at " + std::to_string(time()) + " s, after \"" + fault_ +
                                 "\": " + why);
}

void LongRun::live() {
  if (phase_ == Phase::kRecovery) return recover();
  if (phase_ == Phase::kRest) {
    const LifeCycle state = daemon_->pipeline().condition().state;
    if (state != LifeCycle::kActive && state != LifeCycle::kDegraded) {
      fail("stops while nothing is wrong");
      phase_ = Phase::kRecovery;
      next_ = time();
      return;
    }
  }
  if (time() < next_) return;
  if (phase_ == Phase::kRest) {
    report_.errors.push_back((simulation_->plant().position_at(rest_point_) - target_).norm());
    begin_fault();
  } else {
    end_fault();
  }
}

void LongRun::begin_fault() {
  phase_ = Phase::kFault;
  next_ = 0;
  fault_ = put_fault();
  ++report_.faults[fault_];
  if (random_.uniform() < 0.3) {
    const std::string more = wire_.put_any(time(), random_);
    ++report_.faults[more];
    fault_ += " and " + more;
  }
  next_ = std::max(next_, wire_.end());
}

std::string LongRun::put_fault() {
  const double length = random_.uniform(0.001, 0.6);
  const auto ticks = static_cast<std::int64_t>(1e3 * length);
  next_ = time() + length;
  switch (random_.below(18)) {
    case 0:
    case 1: {
      pipeline::Pipeline& pipeline = daemon_->pipeline();
      auto faulty = std::make_unique<FaultySensor>(pipeline.exchange_sensor_model(0, nullptr));
      sensor_ = faulty.get();
      sensor_->number = static_cast<int>(random_.below(6));
      sensor_->value = bad_number(random_);
      const bool errs = random_.below(2) == 0;
      sensor_->trouble = errs ? FaultySensor::Trouble::kError : FaultySensor::Trouble::kBadNumbers;
      pipeline.exchange_sensor_model(0, std::move(faulty));
      return errs ? "a component errs" : "a component gives bad numbers";
    }
    case 2:
      wakes_at_ = tick_ + 1 + static_cast<std::int64_t>(random_.below(60));
      return "cycles are missed";
    case 3:
      clock_offset_us_ += std::llround(random_.uniform(-3.6e9, 3.6e9));
      return "the daemon's clock jumps";
    case 4:
      simulation_.reset();
      return "simulator starts again";
    case 5:
      silent_until_ = tick_ + ticks;
      return "commands are lost";
    case 6:
      user_->send("stop");
      return "stopped by its user";
    case 7: {
      Eigen::Vector3d target = target_;
      target[static_cast<int>(random_.below(3))] = bad_number(random_);
      user_->send_target("point", target);
      return "a mad target";
    }
    case 8:
    case 9: {
      const Wish& wish = kWishes[random_.below(std::size(kWishes))];
      user_->send("replace", wish.slot, wish.component, wish.parameters);
      due_answer_ = report_.replaced + report_.refused + 1;
      next_ = time() + 0.2;
      return "something else is asked for";
    }
    default:
      return wire_.put_any(time(), random_);
  }
}

void LongRun::end_fault() {
  if (report_.replaced + report_.refused < due_answer_) fail("a request was not answered");
  if (!simulation_) start_simulation();
  if (sensor_ != nullptr) {
    pipeline::Pipeline& pipeline = daemon_->pipeline();
    const auto faulty = pipeline.exchange_sensor_model(0, nullptr);
    pipeline.exchange_sensor_model(0, std::exchange(sensor_, nullptr)->release());
  }
  phase_ = Phase::kRecovery;
  had_to_act_ = false;
  next_ = time();
}

/// Like a user who reads HEALTH from time to time.
void LongRun::recover() {
  const double since = time() - next_;
  if (std::llround(1e3 * since) % kUserLooksEvery != 0) return;
  switch (daemon_->pipeline().condition().state) {
    case LifeCycle::kActive:
      report_.stops += had_to_act_ ? 1 : 0;
      report_.slowest_recovery = std::max(report_.slowest_recovery, since);
      put_target();
      phase_ = Phase::kRest;
      next_ = time() + random_.uniform(kShortestRest, kLongestRest);
      return;
    case LifeCycle::kFaulted:
      user_->send("reset");
      had_to_act_ = true;
      break;
    case LifeCycle::kInactive:
      user_->send("start");
      had_to_act_ = true;
      break;
    default:
      break;
  }
  if (since >= kRecoverWithin) {
    fail(std::string("is not active again, but ") +
         pipeline::name(daemon_->pipeline().condition().state));
    next_ = time();
  }
}

void LongRun::put_target() {
  target_ = rest_point_ + Eigen::Vector3d(random_.uniform(-0.01, 0.01),
                                          random_.uniform(-0.02, 0.02), random_.uniform(0, 0.04));
  user_->send_target("point", target_);
}

}  // namespace palpate::faults

#include "tools/lab/faults/long_run.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

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

LongRun::LongRun(std::uint64_t seed)
    : LongRun(seed, configuration(
                        {"object.order=quadratic", "estimation.component=pose_wrench_filter"})) {}

LongRun::LongRun(std::uint64_t seed, const config::Node& root)
    : random_(seed, "long run"),
      loop_(root),
      monitor_(registry::read_gate_limits(root), loop_.daemon().settings().loop.period),
      rest_point_(loop_.daemon().pipeline().feature().rest_points()[0]) {}

void LongRun::run(double seconds) {
  const auto ticks = std::llround(1e3 * seconds);
  for (std::int64_t i = 0; i < ticks; ++i) tick();
  report_.time = time();
}

void LongRun::tick() {
  loop_.advance();
  live();
  if (loop_.step()) inspect();
}

/// The monitor checks all messages of a cycle.
void LongRun::inspect() {
  look_at(loop_.published(), loop_.daemon(), monitor_);
  for (const EventNote& event : monitor_.events()) {
    report_.replaced += event.event == "replaced" ? 1 : 0;
    report_.refused += event.event == "refused" ? 1 : 0;
  }
  if (!monitor_.complaint().empty()) fail(monitor_.complaint());
  monitor_.forget();
  report_.messages = monitor_.messages();
  const LifeCycle state = loop_.daemon().pipeline().condition().state;
  const bool runs = state == LifeCycle::kActive || state == LifeCycle::kDegraded;
  stopped_ticks_ = runs ? 0 : stopped_ticks_ + 1;
  if (stopped_ticks_ >= kZeroWithinTicks && monitor_.speed() > 0)
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
    const LifeCycle state = loop_.daemon().pipeline().condition().state;
    if (state != LifeCycle::kActive && state != LifeCycle::kDegraded) {
      fail("stops while nothing is wrong");
      phase_ = Phase::kRecovery;
      next_ = time();
      return;
    }
  }
  if (time() < next_) return;
  if (phase_ == Phase::kRest) {
    report_.errors.push_back(
        (loop_.simulation()->plant().position_at(rest_point_) - target_).norm());
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
    const std::string more = loop_.wire().put_any(time(), random_);
    ++report_.faults[more];
    fault_ += " and " + more;
  }
  next_ = std::max(next_, loop_.wire().end());
}

std::string LongRun::put_fault() {
  const double length = random_.uniform(0.001, 0.6);
  const auto ticks = static_cast<std::int64_t>(1e3 * length);
  next_ = time() + length;
  switch (random_.below(18)) {
    case 0:
    case 1: {
      pipeline::Pipeline& pipeline = loop_.daemon().pipeline();
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
      loop_.suspend_daemon(1 + static_cast<std::int64_t>(random_.below(60)));
      return "cycles are missed";
    case 3:
      loop_.shift_daemon_clock(std::llround(random_.uniform(-3.6e9, 3.6e9)));
      return "the daemon's clock jumps";
    case 4:
      loop_.end_simulation();
      return "simulator starts again";
    case 5:
      loop_.lose_commands(ticks);
      return "commands are lost";
    case 6:
      loop_.user().send({"stop"}, 0);
      return "stopped by its user";
    case 7: {
      Eigen::Vector3d target = target_;
      target[static_cast<int>(random_.below(3))] = bad_number(random_);
      loop_.user().set_target(message_of(target), 0);
      return "a mad target";
    }
    case 8:
    case 9: {
      const Wish& wish = kWishes[random_.below(std::size(kWishes))];
      loop_.user().send({"replace", wish.slot, "", wish.component, wish.parameters}, 0);
      due_answer_ = report_.replaced + report_.refused + 1;
      next_ = time() + 0.2;
      return "something else is asked for";
    }
    default:
      return loop_.wire().put_any(time(), random_);
  }
}

void LongRun::end_fault() {
  if (report_.replaced + report_.refused < due_answer_) fail("a request was not answered");
  if (loop_.simulation() == nullptr) loop_.start_simulation();
  if (sensor_ != nullptr) {
    pipeline::Pipeline& pipeline = loop_.daemon().pipeline();
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
  switch (loop_.daemon().pipeline().condition().state) {
    case LifeCycle::kActive:
      report_.stops += had_to_act_ ? 1 : 0;
      report_.slowest_recovery = std::max(report_.slowest_recovery, since);
      put_target();
      phase_ = Phase::kRest;
      next_ = time() + random_.uniform(kShortestRest, kLongestRest);
      return;
    case LifeCycle::kFaulted:
      loop_.user().send({"reset"}, 0);
      had_to_act_ = true;
      break;
    case LifeCycle::kInactive:
      loop_.user().send({"start"}, 0);
      had_to_act_ = true;
      break;
    default:
      break;
  }
  if (since >= kRecoverWithin) {
    const pipeline::Condition condition = loop_.daemon().pipeline().condition();
    fail(std::string("is not active again, but ") + pipeline::name(condition.state) + ": " +
         condition.reason);
    next_ = time();
  }
}

void LongRun::put_target() {
  target_ = rest_point_ + Eigen::Vector3d(random_.uniform(-0.01, 0.01),
                                          random_.uniform(-0.02, 0.02), random_.uniform(0, 0.04));
  loop_.user().set_target(message_of(target_), 0);
}

}  // namespace palpate::faults

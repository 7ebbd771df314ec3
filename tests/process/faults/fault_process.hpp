#pragma once

#include <cmath>
#include <cstdlib>
#include <palpate/component_event_t.hpp>
#include <palpate/feature_t.hpp>
#include <palpate/shape_target_t.hpp>

#include "tests/process/daemon/daemon_process.hpp"
#include "tests/process/daemon/robot.hpp"

namespace palpate {

using std::chrono::milliseconds;
using support::ChildProcess;
using Clock = std::chrono::steady_clock;

inline const std::string kInjector = std::string(PALPATE_BIN_DIR) + "/palpate-inject";

/// A count: from the environment if set, otherwise `usual`.
inline int amount(const char* variable, int usual) {
  const char* text = std::getenv(variable);
  return text != nullptr ? std::max(1, std::atoi(text)) : usual;
}

inline double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// Messages of a daemon during an interval.
struct Seen {
  double seconds = 0;
  int commands = 0;
  int not_finite = 0;
  int valid = 0;
  int moving = 0;             // commands that are not zero
  double largest_speed = 0;   // m/s
  double rms_error = 0;       // m, of the feature's estimate to its target
  double worst_error = 0;     // m
  std::int64_t overruns = 0;  // of the daemon
  std::int64_t lost = 0;      // of FT_WRENCH
  std::int64_t heard = 0;
  std::int64_t datagrams = 0;  // that the daemon's control socket was given
  double loss() const {
    return heard + lost == 0 ? 0 : static_cast<double>(lost) / static_cast<double>(heard + lost);
  }
};

inline void print(const char* name, const Seen& seen) {
  std::printf(
      "%-12s %6.1f s: %5lld overruns (%.2f/s), %d commands, largest %.4f m/s, error rms %.3f mm, "
      "worst %.3f mm, FT_WRENCH lost %lld of %lld (%.2f %%)\n",
      name, seen.seconds, static_cast<long long>(seen.overruns),
      static_cast<double>(seen.overruns) / seen.seconds, seen.commands, seen.largest_speed,
      1e3 * seen.rms_error, 1e3 * seen.worst_error, static_cast<long long>(seen.lost),
      static_cast<long long>(seen.heard + seen.lost), 100 * seen.loss());
}

/// An active daemon, a robot that follows it, and a listener.
class FaultProcess : public DaemonProcess {
 protected:
  void SetUp() override {
    DaemonProcess::SetUp();
    if (IsSkipped()) return;
    listener_ = bus::make_lcm_bus(control_url_);
    feature_ = std::make_unique<bus::TypedSubscription<feature_t>>(*listener_, "FEATURE", 4096);
    command_ = std::make_unique<bus::TypedSubscription<twist_command_t>>(*listener_,
                                                                         "TWIST_COMMAND", 4096);
    listener_->start();
    event_listener_ = bus::make_lcm_bus(housekeeping_url_);
    events_ = std::make_unique<bus::TypedSubscription<component_event_t>>(*event_listener_,
                                                                          "COMPONENT_EVENT", 256);
    event_listener_->start();
  }
  void TearDown() override {
    if (listener_) listener_->stop();
    if (event_listener_) event_listener_->stop();
    DaemonProcess::TearDown();
  }

  /// A shared machine may withdraw a core for long: the fault is under test, not the machine.
  std::vector<std::string> patient_command(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words =
        command({"--set", "loop.safe_stop_after_ms=5000", "--set", "loop.degraded_after_ms=5000"});
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  ::testing::AssertionResult activate() {
    health_t health{};
    // Messages before a restart of the daemon are ignored.
    const auto end = Clock::now() + std::chrono::seconds(20);
    while (Clock::now() < end) {
      send_event("start", ++counter_);
      const auto next = Clock::now() + milliseconds(300);
      std::int64_t arrival_ns = 0;
      while (Clock::now() < next) {
        while (health_->take(health, arrival_ns))
          if (health.state == 2 || health.state == 3) return ::testing::AssertionSuccess();
        std::this_thread::sleep_for(milliseconds(2));
      }
    }
    return ::testing::AssertionFailure()
           << "state " << health.state << ": " << bus::get_text(health.reason);
  }

  void send_target(double z = 0.08) {
    shape_target_t target{};
    target.session = 42;
    target.revision = ++revision_;
    target.chunks = 1;
    bus::put_text(target.kind, "point");
    target.value_count = 3;
    target.values[0] = 0.25, target.values[1] = 0.03, target.values[2] = z;
    bus::TypedPublisher<shape_target_t>(*control_, "SHAPE_TARGET").publish(target);
  }

  /// Current health of the daemon: the newest message, awaited.
  health_t health_now() {
    health_t health{};
    std::int64_t arrival_ns = 0;
    while (health_->take(health, arrival_ns)) {
    }
    wait_health([](const health_t&) { return true; }, health);
    return health;
  }

  /// Listens until `until` is true.
  template <class Until>
  Seen watch(Until until) {
    feature_t feature{};
    twist_command_t twist{};
    std::int64_t arrival_ns = 0;
    while (feature_->take(feature, arrival_ns)) {
    }
    while (command_->take(twist, arrival_ns)) {
    }
    const health_t before = health_now();
    Seen seen;
    double squares = 0;
    int features = 0;
    const auto begin = Clock::now();
    while (!until()) {
      std::this_thread::sleep_for(milliseconds(5));
      while (command_->take(twist, arrival_ns)) count(twist, seen);
      while (feature_->take(feature, arrival_ns)) {
        double square = 0;
        for (int i = 0; i < std::min(3, static_cast<int>(feature.error_count)); ++i)
          square += feature.error[i] * feature.error[i];
        squares += square;
        ++features;
        seen.worst_error = std::max(seen.worst_error, std::sqrt(square));
      }
    }
    seen.seconds = seconds_since(begin);
    const health_t after = health_now();
    seen.overruns = after.overruns - before.overruns;
    seen.datagrams = after.datagrams + after.overflowed - before.datagrams - before.overflowed;
    seen.lost = after.lost[0] - before.lost[0];
    seen.heard = after.received[0] - before.received[0];
    seen.rms_error = features > 0 ? std::sqrt(squares / features) : 0;
    return seen;
  }
  Seen watch_for(double seconds) {
    const auto begin = Clock::now();
    return watch([&] { return seconds_since(begin) >= seconds; });
  }

  static void count(const twist_command_t& twist, Seen& seen) {
    ++seen.commands;
    if (twist.valid != 0) ++seen.valid;
    double square = 0;
    bool zero = true;
    for (int i = 0; i < 6; ++i) {
      if (!std::isfinite(twist.twist[i])) ++seen.not_finite;
      if (i < 3) square += twist.twist[i] * twist.twist[i];
      zero = zero && twist.twist[i] == 0;
    }
    if (!zero) ++seen.moving;
    seen.largest_speed = std::max(seen.largest_speed, std::sqrt(square));
  }

  /// The last event of that name within `seconds`; false if there was none.
  bool wait_event(const std::string& name, double seconds, component_event_t& event) {
    const auto begin = Clock::now();
    std::int64_t arrival_ns = 0;
    while (seconds_since(begin) < seconds) {
      while (events_->take(event, arrival_ns))
        if (bus::get_text(event.event) == name) return true;
      std::this_thread::sleep_for(milliseconds(1));
    }
    return false;
  }

  static constexpr double kSpeedLimit = 0.08;  // m/s, of the example's gate

  std::unique_ptr<bus::MessageBus> listener_, event_listener_;
  std::unique_ptr<bus::TypedSubscription<feature_t>> feature_;
  std::unique_ptr<bus::TypedSubscription<twist_command_t>> command_;
  std::unique_ptr<bus::TypedSubscription<component_event_t>> events_;
  // A daemon's participants: every test process is a different one.
  std::int64_t counter_ = 0;
  std::int32_t revision_ = 0;
};

}  // namespace palpate

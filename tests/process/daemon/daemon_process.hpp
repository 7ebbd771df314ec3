#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <palpate/component_command_t.hpp>
#include <palpate/health_t.hpp>
#include <palpate/twist_command_t.hpp>

#include "rt/bus/message_bus.hpp"
#include "rt/bus/text.hpp"
#include "rt/loop/sanitizer.hpp"
#include "tests/support/child_process.hpp"

namespace palpate {

inline const std::string kDaemon = std::string(PALPATE_BIN_DIR) + "/palpated";
inline const std::string kExample =
    std::string(PALPATE_SOURCE_DIR) + "/rt/config/examples/bar_long_soft.yaml";

/// Resident memory of a process; 0 in builds with a sanitizer, which delays the release of freed
/// memory and detects leaks itself.
inline double resident_megabytes(int pid) {
  if (loop::kSanitized) return 0;
  std::ifstream file("/proc/" + std::to_string(pid) + "/statm");
  double pages = 0;
  file >> pages >> pages;
  return pages * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1048576;
}

/// A daemon on private URLs and both ends of them.
class DaemonProcess : public ::testing::Test {
 protected:
  std::vector<std::string> command(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {kDaemon,
                                      "--config",
                                      kExample,
                                      "--set",
                                      "bus.control=" + control_url_,
                                      "--set",
                                      "bus.housekeeping=" + housekeeping_url_};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  void SetUp() override {
    try {
      control_ = bus::make_lcm_bus(control_url_);
      housekeeping_ = bus::make_lcm_bus(housekeeping_url_);
    } catch (const std::runtime_error& error) {
      GTEST_SKIP() << error.what();
    }
    health_ = std::make_unique<bus::TypedSubscription<health_t>>(*housekeeping_, "HEALTH", 8);
    twist_ =
        std::make_unique<bus::TypedSubscription<twist_command_t>>(*control_, "TWIST_COMMAND", 64);
    control_->start();
    housekeeping_->start();
  }

  void TearDown() override {
    if (control_) control_->stop();
    if (housekeeping_) housekeeping_->stop();
  }

  /// The newest HEALTH that satisfies `condition`, waiting at most 20 s.
  template <class Condition>
  bool wait_health(Condition condition, health_t& health) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    std::int64_t arrival_ns = 0;
    while (std::chrono::steady_clock::now() < end) {
      while (health_->take(health, arrival_ns)) {
        if (condition(health)) return true;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
  }

  /// The next HEALTH published from now on.
  bool next_health(health_t& health) {
    std::int64_t arrival_ns = 0;
    while (health_->take(health, arrival_ns)) {
    }
    return wait_health([](const health_t&) { return true; }, health);
  }

  void send_event(const char* event, std::int64_t counter) {
    component_command_t message{};
    message.session = 42;
    message.counter = counter;
    bus::put_text(message.slot, "all");
    bus::put_text(message.event, event);
    bus::TypedPublisher<component_command_t>(*control_, "COMPONENT_COMMAND").publish(message);
  }

  std::string control_url_ = support::private_url(0);
  std::string housekeeping_url_ = support::private_url(1);
  std::unique_ptr<bus::MessageBus> control_;
  std::unique_ptr<bus::MessageBus> housekeeping_;
  std::unique_ptr<bus::TypedSubscription<health_t>> health_;
  std::unique_ptr<bus::TypedSubscription<twist_command_t>> twist_;
};

}  // namespace palpate

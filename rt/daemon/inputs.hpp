#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/sensing/signals.hpp"
#include "rt/bus/authentication.hpp"
#include "rt/bus/message_bus.hpp"

namespace palpate::daemon {

/// State of one input channel for HEALTH.
struct InputReport {
  const char* name = "";
  std::int64_t received = 0;
  std::int64_t lost = 0;      // gaps in the sequence numbers, and messages dropped by a full queue
  std::int64_t rejected = 0;  // invalid size, type, publisher, order or values
  std::int64_t frozen = 0;    // unchanged values for too long, although in sequence
  double age = -1;            // s since the last valid message; negative: none received yet
};

/// s for which a sensor may repeat bitwise identical values before its messages are rejected: a
/// working sensor has noise. 0: unlimited.
struct FrozenAfter {
  double force_torque = 0.5;
  double inertial = 0.5;
  double biotac = 0.5;
  double fingertip = 0;  // processed contacts may repeat while nothing is touched
  double robot = 0;      // encoders of a robot at rest may repeat their values
};

/// Converts sensor channels of the control bus to Signals; validates every message before use
/// (values finite and plausible, unit quaternions, counts in range, sequence, changing values). A
/// second arm has separate channels, whose names end in _1, except for fingertips, manual forces,
/// observations of the shape and obstacles; its channels are optional.
class Inputs {
 public:
  /// `access`: access control of manual forces and of obstacles that messages move.
  explicit Inputs(bus::MessageBus& control, int arms = 1, const FrozenAfter& frozen_after = {},
                  const bus::Access& access = {});
  ~Inputs();
  Inputs(const Inputs&) = delete;
  Inputs& operator=(const Inputs&) = delete;

  /// Drains all queues into the streams, with ages as of `now_ns` (CLOCK_MONOTONIC or virtual).
  /// `stepped`: messages count as arrived at `now_ns`, because they were timed by another clock.
  void read(std::int64_t now_ns, double dt, bool stepped = false) noexcept;
  /// Names of the obstacles that messages may move; messages for others are rejected. Must remain
  /// valid.
  void set_moved_obstacles(const std::vector<std::string>& names) noexcept { moved_ = &names; }

  /// Signals of arm 0 and of everything not assigned to an arm, or of arm 1.
  const sensing::Signals& signals(int arm = 0) const noexcept { return signals_[arm]; }
  int channel_count() const noexcept { return static_cast<int>(reported_.size()); }
  /// Access control of the signed channels: manual forces, obstacles.
  using Admissions = std::array<const bus::ReplayGuard*, 2>;
  Admissions admissions() const noexcept { return {&manual_admission_, &world_admission_}; }
  /// The second arm's channels come last. Of a finger with two channels, BIOTAC_n and FINGERTIP_n,
  /// the one with the latest message, since HEALTH holds 16 inputs.
  InputReport report(int channel) const noexcept;

  /// True if a sensor, hand or robot of an arm has restarted by the last read(): stored information
  /// (offsets, poses) may be invalid.
  bool any_session_restarted() const noexcept;

 private:
  class Channel;
  template <class Message, class Stream>
  class ChannelOf;
  bool is_moved(const char* obstacle) const noexcept;
  template <class Message, class Stream>
  Channel& add(bus::MessageBus& bus, const char* name, int depth, Stream& stream,
               double frozen_after = 0);
  void add_arm(bus::MessageBus& bus, int arm, const FrozenAfter& frozen_after);

  std::array<sensing::Signals, 2> signals_;
  bus::ReplayGuard manual_admission_, world_admission_;
  const std::vector<std::string>* moved_ = nullptr;
  std::vector<std::unique_ptr<Channel>> channels_;
  /// In the order of report(): a channel, and for a finger that of another kind of sensor.
  std::vector<std::array<const Channel*, 2>> reported_;
};

/// Detects messages of a different type, or a different version of it, on the channels of a bus.
/// Each channel is reported at once and then at most once per second.
class TypeWatch {
 public:
  explicit TypeWatch(const bus::MessageBus& bus) : bus_(bus) {}

  /// Next channel to report; nullptr if there is none. `now_ns`: clock of the arrival times.
  const bus::Subscription* look(std::int64_t now_ns) noexcept {
    const auto& channels = bus_.subscriptions();
    for (std::size_t i = 0; i < channels.size() && i < reported_.size(); ++i) {
      const std::int64_t count = channels[i]->counters().wrong_type.load(std::memory_order_relaxed);
      Reported& reported = reported_[i];
      if (count == reported.count || (reported.count > 0 && now_ns - reported.at_ns < kInterval))
        continue;
      reported = {count, now_ns};
      return channels[i];
    }
    return nullptr;
  }

 private:
  static constexpr std::int64_t kInterval = 1'000'000'000;
  struct Reported {
    std::int64_t count = 0;
    std::int64_t at_ns = 0;
  };
  const bus::MessageBus& bus_;
  std::array<Reported, 32> reported_{};
};

}  // namespace palpate::daemon

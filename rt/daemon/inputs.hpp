#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <palpate/biotac_t.hpp>
#include <palpate/ft_wrench_t.hpp>
#include <palpate/hand_state_t.hpp>
#include <palpate/imu_t.hpp>
#include <palpate/manual_force_t.hpp>
#include <palpate/robot_state_t.hpp>
#include <palpate/shape_observation_t.hpp>
#include <string>
#include <vector>

#include "core/sensing/signals.hpp"
#include "rt/bus/authentication.hpp"
#include "rt/bus/message_bus.hpp"
#include "rt/bus/session.hpp"

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
  double robot = 0;  // encoders of a robot at rest may repeat their values
};

/// Converts sensor channels of the control bus to Signals; validates every message before use
/// (values finite and plausible, unit quaternions, counts in range, sequence, changing values). A
/// second arm has separate channels, whose names end in _1, except for fingertips, manual forces
/// and observations of the shape; its channels are optional.
class Inputs {
 public:
  /// `access`: access control of manual forces.
  explicit Inputs(bus::MessageBus& control, int arms = 1, const FrozenAfter& frozen_after = {},
                  const bus::Access& access = {});

  /// Drains all queues into the streams, with ages as of `now_ns` (CLOCK_MONOTONIC or virtual).
  /// `stepped`: messages count as arrived at `now_ns`, because they were timed by another clock.
  void read(std::int64_t now_ns, double dt, bool stepped = false) noexcept;

  /// Signals of arm 0 and of everything not assigned to an arm, or of arm 1.
  const sensing::Signals& signals(int arm = 0) const noexcept { return signals_[arm]; }
  int arm_count() const noexcept { return second_ ? 2 : 1; }
  int channel_count() const noexcept { return second_ ? 15 : 11; }
  const bus::ReplayGuard& manual_admission() const noexcept { return manual_admission_; }
  InputReport report(int channel) const noexcept;  // the second arm's channels come last

  /// True if a sensor, hand or robot of an arm has restarted by the last read(): stored information
  /// (offsets, poses) may be invalid.
  bool any_session_restarted() const noexcept;

 private:
  template <class Message>
  struct Channel {
    Channel(bus::MessageBus& bus, const char* channel, int depth, double frozen_after = 0)
        : name(channel),
          queue(bus, channel, depth),
          frozen_after_ns(static_cast<std::int64_t>(frozen_after * 1e9)) {}
    void lock_to_first_publisher() noexcept { queue.lock_to_first_publisher(kSilence); }
    /// ns of silence before another publisher of the same channel is accepted: much longer than the
    /// timeout of a silent sensor, so that a stray publisher does not take over when a machine
    /// stalls.
    static constexpr std::int64_t kSilence = 200'000'000;
    const char* name;
    bus::TypedSubscription<Message> queue;
    bus::SequenceTracker sequence;
    std::int64_t invalid = 0;
    std::int64_t arrival_ns = 0;
    std::int64_t frozen_after_ns;  // 0: unlimited
    std::int64_t changed_ns = 0;   // time of the last change of the values
    int repeats = 0;               // number of messages with the same values since
    std::int64_t frozen = 0;
    std::int64_t sessions = 0;       // sessions of the sender so far
    bool session_restarted = false;  // restarted by the last read()
    double age = -1;
    Message message;
  };

  template <class Message, class Stream, class Convert>
  void drain(Channel<Message>& channel, Stream& stream, std::int64_t now_ns, bool stepped,
             Convert convert) noexcept;
  /// Whether the sender is authorised; checked for manual forces only.
  template <class Message>
  bool admitted(const Message& message) noexcept;
  /// Counts repetitions of the values; true if the sensor is frozen.
  template <class Message, class Sample>
  static bool is_frozen(Channel<Message>& channel, const Sample& before, const Sample& now,
                        std::int64_t arrival_ns) noexcept;
  template <class Message>
  static InputReport report_of(const Channel<Message>& channel) noexcept;

  /// Channels of an arm and its hand; `names` in the order of the members.
  struct ArmChannels {
    ArmChannels(bus::MessageBus& bus, const std::array<const char*, 4>& names,
                const FrozenAfter& frozen_after);
    Channel<ft_wrench_t> force_torque;
    Channel<imu_t> inertial;
    Channel<robot_state_t> robot;
    Channel<hand_state_t> hand;
  };
  void drain(ArmChannels& arm, sensing::Signals& signals, std::int64_t now_ns,
             bool stepped) noexcept;
  static InputReport report_of(const ArmChannels& arm, int channel) noexcept;

  std::array<sensing::Signals, 2> signals_;
  ArmChannels first_;
  std::unique_ptr<ArmChannels> second_;
  Channel<manual_force_t> manual_;
  bus::ReplayGuard manual_admission_;
  std::array<std::unique_ptr<Channel<biotac_t>>, 5> biotac_;
  Channel<shape_observation_t> observation_;
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

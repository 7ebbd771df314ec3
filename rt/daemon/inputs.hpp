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

/// What HEALTH says of one input channel.
struct InputReport {
  const char* name = "";
  std::int64_t received = 0;
  std::int64_t lost = 0;      // gaps in the sequence, and what a full queue dropped
  std::int64_t rejected = 0;  // wrong size, type, sender or order, or numbers not valid
  std::int64_t frozen = 0;    // the same numbers for too long, though new in order
  double age = -1;            // s since the last good one; below zero: nothing was ever received
};

/// s that a sensor may repeat the same numbers, bit for bit, until its messages no longer count: it
/// has noise, unless it has stopped. 0: for ever.
struct FrozenAfter {
  double force_torque = 0.5;
  double inertial = 0.5;
  double biotac = 0.5;
  double robot = 0;  // encoders at rest may well stand still
};

/// Sensor channels of the control bus as Signals: checks every message (numbers finite and within
/// what can be, unit quaternions, counts in range, sequence, whether the sensor still moves) before
/// anybody sees it. A second arm has channels of its own, whose names end in _1, for all but
/// fingertips, manual forces and observations of the shape, which need not come at all.
class Inputs {
 public:
  /// `access`: of manual forces.
  explicit Inputs(bus::MessageBus& control, int arms = 1, const FrozenAfter& frozen_after = {},
                  const bus::Access& access = {});

  /// Drains all queues into the streams, as seen at `now_ns` (CLOCK_MONOTONIC or virtual).
  /// `stepped`: messages count as arrived at `now_ns`, since they came by another clock.
  void read(std::int64_t now_ns, double dt, bool stepped = false) noexcept;

  /// What arm 0 and everything that belongs to no arm say, or arm 1.
  const sensing::Signals& signals(int arm = 0) const noexcept { return signals_[arm]; }
  int arm_count() const noexcept { return second_ ? 2 : 1; }
  int channel_count() const noexcept { return second_ ? 15 : 11; }
  const bus::Admission& manual_admission() const noexcept { return manual_admission_; }
  InputReport report(int channel) const noexcept;  // the second arm's come last

  /// Whether by the last read() an arm's sensor, hand or robot has started anew: what was known of
  /// it (offsets, where it stood) need not hold any more.
  bool any_began_anew() const noexcept;

 private:
  template <class Message>
  struct Channel {
    Channel(bus::MessageBus& bus, const char* channel, int depth, double frozen_after = 0)
        : name(channel),
          queue(bus, channel, depth),
          frozen_after_ns(static_cast<std::int64_t>(frozen_after * 1e9)) {}
    void hear_one_sender() noexcept { queue.hear_one_sender(kSilence); }
    /// ns until another sensor of the same name is heard: long after this one counts as silent, so
    /// that a stray one does not take its place when a machine stalls.
    static constexpr std::int64_t kSilence = 200'000'000;
    const char* name;
    bus::TypedSubscription<Message> queue;
    bus::SequenceTracker sequence;
    std::int64_t invalid = 0;
    std::int64_t arrival_ns = 0;
    std::int64_t frozen_after_ns;  // 0: never
    std::int64_t changed_ns = 0;   // when the numbers last changed
    int repeats = 0;               // messages with the same numbers since
    std::int64_t frozen = 0;
    std::int64_t sessions = 0;  // of the sender, so far
    bool began_anew = false;    // by the last read
    double age = -1;
    Message message;
  };

  template <class Message, class Stream, class Convert>
  void drain(Channel<Message>& channel, Stream& stream, std::int64_t now_ns, bool stepped,
             Convert convert) noexcept;
  /// Whether the sender may say so; asked of manual forces alone.
  template <class Message>
  bool admitted(const Message& message) noexcept;
  /// Counts the numbers' repeats; true where the sensor has stopped.
  template <class Message, class Sample>
  static bool is_frozen(Channel<Message>& channel, const Sample& before, const Sample& now,
                        std::int64_t arrival_ns) noexcept;
  template <class Message>
  static InputReport report_of(const Channel<Message>& channel) noexcept;

  /// What an arm and its hand tell of themselves; `names` in the order of the members.
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
  bus::Admission manual_admission_;
  std::array<std::unique_ptr<Channel<biotac_t>>, 5> biotac_;
  Channel<shape_observation_t> observation_;
};

}  // namespace palpate::daemon

#include "rt/daemon/inputs.hpp"

#include <algorithm>
#include <cmath>
#include <palpate/channels.hpp>

#include "rt/bus/session.hpp"
#include "rt/daemon/sample_conversion.hpp"

namespace palpate::daemon {
namespace {

// Per channel; bounds the work per cycle under a message flood.
constexpr int kMostPerCycle = 64;

constexpr std::array<const char*, 5> kBiotacChannels = {
    channel::kBiotac0, channel::kBiotac1, channel::kBiotac2, channel::kBiotac3, channel::kBiotac4};

constexpr std::array<const char*, 5> kFingertipChannels = {
    channel::kFingertip0, channel::kFingertip1, channel::kFingertip2, channel::kFingertip3,
    channel::kFingertip4};

/// By arm: force-torque, IMU, robot, hand.
constexpr std::array<std::array<const char*, 4>, 2> kArmChannels = {
    {{channel::kFtWrench, channel::kImu, channel::kRobotState, channel::kHandState},
     {channel::kFtWrench1, channel::kImu1, channel::kRobotState1, channel::kHandState1}}};

/// True if two samples have the same values, whatever their times.
bool same(const sensing::ForceTorque& a, const sensing::ForceTorque& b) noexcept {
  return a.F_S.force == b.F_S.force && a.F_S.torque == b.F_S.torque;
}
bool same(const sensing::Inertial& a, const sensing::Inertial& b) noexcept {
  return a.acceleration_I == b.acceleration_I && a.angular_velocity_I == b.angular_velocity_I;
}
bool same(const sensing::RobotState& a, const sensing::RobotState& b) noexcept {
  return a.q == b.q && a.dq == b.dq && a.tau == b.tau && a.X_WE.matrix() == b.X_WE.matrix() &&
         a.V_W_E.linear == b.V_W_E.linear && a.V_W_E.angular == b.V_W_E.angular;
}
bool same(const sensing::BioTac& a, const sensing::BioTac& b) noexcept {
  return a.electrodes == b.electrodes && a.pac == b.pac && a.pdc == b.pdc && a.tac == b.tac &&
         a.tdc == b.tdc;
}
bool same(const sensing::FingertipContact& a, const sensing::FingertipContact& b) noexcept {
  return a.touches == b.touches && a.place_T == b.place_T && a.force_T == b.force_T;
}
template <class Sample>
bool same(const Sample&, const Sample&) noexcept {
  return false;
}

}  // namespace

/// An input of HEALTH.
class Inputs::Channel {
 public:
  virtual ~Channel() = default;
  virtual void drain(std::int64_t now_ns, bool stepped) noexcept = 0;
  virtual InputReport report() const noexcept = 0;
  /// Restarted by the last drain().
  bool session_restarted() const noexcept { return session_restarted_; }
  void set_of_arm() noexcept { is_of_arm_ = true; }
  bool is_of_arm() const noexcept { return is_of_arm_; }

 protected:
  bool session_restarted_ = false;

 private:
  bool is_of_arm_ = false;
};

/// Messages of one type, and the stream that they become.
template <class Message, class Stream>
class Inputs::ChannelOf final : public Channel {
 public:
  ChannelOf(bus::MessageBus& bus, const char* name, int depth, Stream& stream, double frozen_after,
            Inputs& inputs)
      : name_(name),
        queue_(bus, name, depth),
        stream_(stream),
        frozen_after_ns_(static_cast<std::int64_t>(frozen_after * 1e9)),
        inputs_(inputs) {
    if constexpr (!kIsManual) queue_.lock_to_first_publisher(kSilence);
  }

  void drain(std::int64_t now_ns, bool stepped) noexcept override {
    stream_.fresh_count = 0;
    session_restarted_ = false;
    std::int64_t arrival_ns = 0;
    for (int i = 0; i < kMostPerCycle && queue_.take(message_, arrival_ns); ++i) {
      if (!is_admitted()) {
        ++invalid_;
        continue;
      }
      if (!sequence_.accept(message_.session, message_.seq)) continue;
      if (sequence_.sessions() > sessions_) {
        session_restarted_ = sessions_ > 0;
        sessions_ = sequence_.sessions();
      }
      Sample& sample = is_full() ? surplus_ : stream_.fresh[stream_.fresh_count];
      if (!convert(message_, sample)) {
        ++invalid_;
        continue;
      }
      if (stepped) arrival_ns = now_ns;
      if (is_frozen(sample, arrival_ns)) {
        ++frozen_;
        continue;
      }
      accept(sample);
      arrival_ns_ = arrival_ns;
    }
    if (stream_.freshness == Freshness::kNoData) return;
    if (stream_.fresh_count == 0) stream_.freshness = Freshness::kOld;
    stream_.age = static_cast<double>(now_ns - arrival_ns_) * 1e-9;
    age_ = stream_.age;
  }

  InputReport report() const noexcept override {
    const bus::SubscriptionCounters& queue = queue_.counters();
    return {
        name_,
        queue.received,
        sequence_.lost() + queue.dropped,
        queue.wrong_size + queue.wrong_type + queue.other_sender + sequence_.rejected() + invalid_,
        frozen_,
        age_};
  }

 private:
  using Sample = decltype(Stream::latest);
  static constexpr bool kIsManual = std::is_same_v<Message, manual_force_t>;
  static constexpr bool kIsWorld = std::is_same_v<Message, world_state_t>;
  /// ns of silence before another publisher of the same channel is accepted: much longer than the
  /// timeout of a silent sensor, so that a stray publisher does not take over when a machine
  /// stalls.
  static constexpr std::int64_t kSilence = 200'000'000;

  /// Whether the sender is authorised, for signed messages, and the obstacle is one that messages
  /// move.
  bool is_admitted() noexcept {
    if constexpr (kIsManual)
      return inputs_.manual_admission_.judge(message_) == bus::Admitted::kFresh;
    if constexpr (kIsWorld)
      return inputs_.world_admission_.judge(message_) == bus::Admitted::kFresh &&
             inputs_.is_moved(bus::get_text(message_.name));
    return true;
  }

  /// Counts repetitions of the values; true if the sensor is frozen.
  bool is_frozen(const Sample& now, std::int64_t arrival_ns) noexcept {
    constexpr int kRepeats = 10;  // minimum, so that a gap between two messages does not count
    if (frozen_after_ns_ == 0 || !same(stream_.latest, now)) {
      changed_ns_ = arrival_ns;
      repeats_ = 0;
      return false;
    }
    ++repeats_;
    return repeats_ >= kRepeats && arrival_ns - changed_ns_ > frozen_after_ns_;
  }

  bool is_full() const noexcept {
    return stream_.fresh_count == static_cast<int>(stream_.fresh.size());
  }

  /// `sample` is the stream's next, or the surplus of a full stream, which keeps the newest.
  void accept(const Sample& sample) noexcept {
    if (is_full()) {
      std::move(stream_.fresh.begin() + 1, stream_.fresh.end(), stream_.fresh.begin());
      stream_.fresh.back() = sample;
    } else {
      ++stream_.fresh_count;
    }
    stream_.latest = sample;
    stream_.freshness = Freshness::kNew;
  }

  const char* name_;
  bus::TypedSubscription<Message> queue_;
  Stream& stream_;
  std::int64_t frozen_after_ns_;  // 0: unlimited
  Inputs& inputs_;
  bus::SequenceTracker sequence_;
  std::int64_t invalid_ = 0;
  std::int64_t arrival_ns_ = 0;
  std::int64_t changed_ns_ = 0;  // time of the last change of the values
  int repeats_ = 0;              // number of messages with the same values since
  std::int64_t frozen_ = 0;
  std::int64_t sessions_ = 0;  // of the sender so far
  double age_ = -1;
  Message message_;
  Sample surplus_;
};

template <class Message, class Stream>
Inputs::Channel& Inputs::add(bus::MessageBus& bus, const char* name, int depth, Stream& stream,
                             double frozen_after) {
  channels_.push_back(
      std::make_unique<ChannelOf<Message, Stream>>(bus, name, depth, stream, frozen_after, *this));
  reported_.push_back({channels_.back().get(), nullptr});
  return *channels_.back();
}

void Inputs::add_arm(bus::MessageBus& bus, int arm, const FrozenAfter& frozen_after) {
  const std::array<const char*, 4>& names = kArmChannels[arm];
  sensing::Signals& to = signals_[arm];
  add<ft_wrench_t>(bus, names[0], 64, to.force_torque, frozen_after.force_torque).set_of_arm();
  add<imu_t>(bus, names[1], 32, to.inertial, frozen_after.inertial).set_of_arm();
  add<robot_state_t>(bus, names[2], 32, to.robot, frozen_after.robot).set_of_arm();
  add<hand_state_t>(bus, names[3], 8, to.hand).set_of_arm();
}

Inputs::Inputs(bus::MessageBus& control, int arms, const FrozenAfter& frozen_after,
               const bus::Access& access)
    : manual_admission_(channel::kManualForce, access),
      world_admission_(channel::kWorldState, access) {
  add_arm(control, 0, frozen_after);
  add<manual_force_t>(control, channel::kManualForce, 8, signals_[0].manual);
  for (std::size_t i = 0; i < kBiotacChannels.size(); ++i)
    add<biotac_t>(control, kBiotacChannels[i], 8, signals_[0].biotac[i], frozen_after.biotac);
  const std::size_t first_finger = reported_.size() - kBiotacChannels.size();
  for (std::size_t i = 0; i < kFingertipChannels.size(); ++i) {
    const Channel& other = add<fingertip_t>(control, kFingertipChannels[i], 8,
                                            signals_[0].fingertip[i], frozen_after.fingertip);
    reported_.pop_back();
    reported_[first_finger + i][1] = &other;
  }
  add<shape_observation_t>(control, channel::kShapeObservation, 4, signals_[0].observation);
  add<world_state_t>(control, channel::kWorldState, 16, signals_[0].world);
  if (arms > 1) add_arm(control, 1, frozen_after);
}

bool Inputs::is_moved(const char* obstacle) const noexcept {
  return moved_ != nullptr && std::any_of(moved_->begin(), moved_->end(),
                                          [&](const auto& name) { return name == obstacle; });
}

Inputs::~Inputs() = default;

void Inputs::read(std::int64_t now_ns, double dt, bool stepped) noexcept {
  for (sensing::Signals& signals : signals_) signals.dt = dt;
  for (const auto& channel : channels_) channel->drain(now_ns, stepped);
}

bool Inputs::any_session_restarted() const noexcept {
  return std::any_of(channels_.begin(), channels_.end(), [](const auto& channel) {
    return channel->is_of_arm() && channel->session_restarted();
  });
}

InputReport Inputs::report(int channel) const noexcept {
  const auto& [first, other] = reported_[static_cast<std::size_t>(channel)];
  const InputReport report = first->report();
  if (other == nullptr) return report;
  const InputReport others = other->report();
  const auto is_heard = [](const InputReport& one) { return one.received + one.rejected > 0; };
  if (others.age >= 0 && (report.age < 0 || others.age < report.age)) return others;
  return is_heard(others) && !is_heard(report) ? others : report;
}

}  // namespace palpate::daemon

#pragma once

#include <functional>
#include <optional>

#include "fci_client.hpp"
#include "follower.hpp"
#include "tools/bridge/common/protocol.hpp"

namespace palpate::franka_bridge {

using bridge::Joints;

/// A Franka arm by its FCI: states at 1 kHz, each answered with joint velocities while the arm
/// moves. A motion is begun when motion is wanted, ends after 2 s at rest, and after any other end
/// begins again only when palpated has rested.
class Franka final : public bridge::Protocol, public bridge::WrenchInput {
 public:
  enum class Torque { kNone, kMeasured, kExternal };
  /// K_F_ext_hat_K, which is without the arm's own end effector and load.
  struct ExternalWrench {
    double polarity = -1;  // 1: of the sensor on the hand; -1: of the surroundings on the hand
    double payload = 0;    // kg that the arm has to subtract
  };
  struct Options {
    Torque torque = Torque::kMeasured;
    std::optional<ExternalWrench> wrench;
    bool recovers = false;  // asks the arm to leave a reflex, after 1 s
    Limits limits = fr3_limits();
    std::function<std::int64_t()> now_ns;  // CLOCK_MONOTONIC
  };

  Franka(std::unique_ptr<bridge::Stream> stream, std::unique_ptr<Datagrams> datagrams,
         Options options);

  void receive() override;
  bool take(bridge::Reading& reading) override;
  std::string complaint() override;
  bool foreign_command() override;
  void begin(const Joints& /*q*/) override { may_start_ = true; }
  void advance(const Joints& /*dq*/, double /*dt*/) override {}
  void send(const Joints& dq, std::int64_t utime) override;
  bool follows(const Joints& /*q*/) const override { return true; }
  /// An arm that has lost its commands stops by itself.
  bool is_stopped_by_command() const override { return false; }

  /// In the axes of the flange, about the flange, which is S.
  bool take(math::Wrench& wrench_S) override;

  /// Until a state has arrived, at most until 1 ms after `until_ns`, CLOCK_MONOTONIC.
  void wait(std::int64_t until_ns);
  /// Slows down and ends the motion, if there is one: up to 0.5 s. Otherwise the arm would end it
  /// by a reflex.
  void finish();

  const FciClient::Counts& counts() const { return client_.counts(); }
  std::int64_t late() const { return late_; }        // states that came with later ones: unanswered
  std::int64_t motions() const { return motions_; }  // begun
  bool is_moving() const { return motion_ == Motion::kRunning; }

 private:
  enum class Motion { kNone, kStarting, kRunning, kEnding };

  void follow_motion(std::int64_t now_ns);
  void follow_answers(std::int64_t now_ns);
  void follow_reflex(std::int64_t now_ns);
  /// `why`: constant, reported as a stop; nullptr: nothing to report.
  void end_motion(const char* why, std::int64_t now_ns);
  void answer(const Joints& dq, std::int64_t now_ns);
  void read_wrench();

  Options options_;
  FciClient client_;
  Follower follower_;
  RobotState state_;  // the last one
  Motion motion_ = Motion::kNone;
  std::int64_t motion_ns_ = 0;   // when motion_ began
  std::uint32_t move_ = 0;       // number of its request
  const char* ended_ = nullptr;  // why the motion has ended, if it has lately
  bool may_start_ = false;
  bool foreign_ = false;
  std::int64_t wanted_ns_ = 0;               // when motion was last wanted
  std::optional<std::int64_t> recovery_ns_;  // when a reflex may be left; none: no reflex
  int taken_ = 0;                            // states, since receive()
  math::Wrench wrench_S_;
  bool has_wrench_ = false, has_other_payload_ = false;
  std::string remark_;
  std::int64_t late_ = 0, motions_ = 0;
};

}  // namespace palpate::franka_bridge

#pragma once

#include <functional>
#include <memory>
#include <string>

#include "protocol.hpp"

namespace palpate::bridge {

/// An arm behind another program or controller, its driver. Commands are sent in answer to
/// statuses, and only after palpated has moved the arm: an arm whose driver falls silent receives
/// none. The arm counts as stopped, which latches, when its driver has started again, it reports a
/// stop, it does not follow, or another program commands it.
class BridgedArm final : public driver::Arm {
 public:
  static constexpr std::int64_t kGuard = 250'000'000;  // ns without commands after a first status
  static constexpr std::int64_t kOthers = 1'000'000'000;  // ns that another master's command counts

  struct Options {
    double stale = 0.05;                       // s without a status until the arm counts as absent
    std::function<std::int64_t()> now_ns;      // CLOCK_MONOTONIC, that of arrivals
    std::function<std::int64_t()> wall_clock;  // us
    std::function<void(const std::string&)> say;  // events for the user
  };
  struct Counts {
    std::int64_t statuses = 0;  // accepted
    std::int64_t rejected = 0;  // not finite, or older than one before
    std::int64_t absences = 0;  // of the driver after it had been there
    std::int64_t commands = 0;  // sent
  };

  /// `wrenches`, if any, outlives this object.
  BridgedArm(int joints, std::unique_ptr<Protocol> protocol, const Options& options,
             WrenchInput* wrenches = nullptr);

  int joint_count() const override { return static_cast<int>(reading_.q.size()); }
  bool read(driver::ArmState& state) override;
  void command(const Joints& dq) override;
  const Counts& counts() const { return counts_; }

 private:
  void accept(std::int64_t now_ns);
  void connect(std::int64_t arrival_ns);
  void lose(std::int64_t now_ns, const char* why);
  const char* stop_reason(std::int64_t now_ns);
  void read_wrench(driver::ArmState& state);

  std::unique_ptr<Protocol> protocol_;
  Options options_;
  WrenchInput* wrenches_;
  Reading incoming_, reading_;  // reading_: the last good one
  bool is_new_ = false;         // reading_, since the last read() or command
  bool unanswered_ = false;
  bool is_connected_ = false;
  bool is_restarted_ = false;
  bool is_early_ = false;       // palpated has moved the arm before its driver was ready
  bool is_commanding_ = false;  // palpated has moved the arm since it connected
  std::int64_t newest_utime_ = 0;
  std::int64_t connected_ns_ = 0, status_ns_ = 0, commanded_ns_ = 0;
  std::int64_t foreign_until_ns_ = 0, unfollowed_until_ns_ = 0, stopping_until_ns_ = 0;
  Counts counts_;
};

}  // namespace palpate::bridge

#include "bridged_arm.hpp"

#include <algorithm>

namespace palpate::bridge {
namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;
// us: a status that is older by more is of a driver that has started again, not late.
constexpr std::int64_t kRestart = 1'000'000;
// ns: of a cycle that is late the arm makes up for as much; the rest of the motion is left out.
constexpr std::int64_t kLongestStep = 10'000'000;
constexpr std::int64_t kUnfollowed = kNsPerSecond / 2;  // ns that a lag counts as a stop
constexpr std::int64_t kStopping = kNsPerSecond / 10;   // ns that an absent arm is sent zero

}  // namespace

BridgedArm::BridgedArm(int joints, std::unique_ptr<Protocol> protocol, const Options& options,
                       WrenchInput* wrenches)
    : protocol_(std::move(protocol)), options_(options), wrenches_(wrenches) {
  for (Joints* numbers : {&reading_.q, &reading_.dq, &reading_.tau}) numbers->setZero(joints);
  incoming_ = reading_;
}

void BridgedArm::connect(std::int64_t arrival_ns) {
  is_connected_ = true;
  is_restarted_ = counts_.absences > 0;
  is_commanding_ = false;
  connected_ns_ = arrival_ns;
  options_.say("the arm's driver has begun: no command for 0.25 s");
}

void BridgedArm::lose(std::int64_t now_ns, const char* why) {
  is_connected_ = false;
  newest_utime_ = 0;
  ++counts_.absences;
  if (is_commanding_) stopping_until_ns_ = now_ns + kStopping;
  options_.say(why);
}

/// Judges incoming_.
void BridgedArm::accept(std::int64_t now_ns) {
  if (!incoming_.q.allFinite() || !incoming_.dq.allFinite()) {
    ++counts_.rejected;
    return;
  }
  if (!incoming_.tau.allFinite()) incoming_.tau.setZero();
  const bool had_time = newest_utime_ > 0, has_time = incoming_.utime > 0;
  const bool is_restart = had_time && (!has_time || incoming_.utime < newest_utime_ - kRestart);
  if (is_restart && is_connected_) lose(now_ns, "the arm's driver has started again: holds");
  if (has_time && had_time && !is_restart && incoming_.utime <= newest_utime_) {
    ++counts_.rejected;  // overtaken by a later one
    return;
  }
  newest_utime_ = has_time ? incoming_.utime : 0;
  std::swap(reading_, incoming_);
  status_ns_ = reading_.arrival_ns;
  is_new_ = unanswered_ = true;
  ++counts_.statuses;
  if (!is_connected_) connect(reading_.arrival_ns);
}

const char* BridgedArm::stop_reason(std::int64_t now_ns) {
  if (now_ns < foreign_until_ns_) return "another program commands the arm";
  // Once only: palpated, which sees a new session, has then to send a stop.
  if (is_restarted_ || is_early_) {
    is_early_ = false;
    return "the arm's driver has begun";
  }
  if (reading_.halted != nullptr) return reading_.halted;
  if (is_commanding_ && !protocol_->follows(reading_.q))
    unfollowed_until_ns_ = now_ns + kUnfollowed;
  if (now_ns >= unfollowed_until_ns_) return nullptr;
  // Where it stands: no jump to the former target when it moves again.
  protocol_->begin(reading_.q);
  return "the arm does not follow";
}

void BridgedArm::read_wrench(driver::ArmState& state) {
  state.has_wrench = false;
  if (wrenches_ == nullptr) return;
  while (wrenches_->take(state.wrench_S)) state.has_wrench = true;
}

bool BridgedArm::read(driver::ArmState& state) {
  protocol_->receive();
  const std::int64_t now_ns = options_.now_ns();
  is_new_ = false;
  while (protocol_->take(incoming_)) accept(now_ns);
  const std::string complaint = protocol_->complaint();
  if (!complaint.empty()) options_.say(complaint);
  if (protocol_->foreign_command()) {
    if (now_ns >= foreign_until_ns_) options_.say("another program commands the arm: stops");
    foreign_until_ns_ = now_ns + kOthers;
  }
  if (is_connected_ && now_ns - status_ns_ > static_cast<std::int64_t>(options_.stale * 1e9))
    lose(now_ns, "the arm's driver is silent: holds");
  read_wrench(state);
  if (!is_connected_) return false;
  state.q = reading_.q;
  state.dq = reading_.dq;
  state.tau = reading_.tau;
  state.is_new = is_new_;
  state.restarted = is_restarted_;
  const char* const reason = stop_reason(now_ns);
  is_restarted_ = false;
  state.stopped = reason != nullptr;
  if (state.stopped) state.stop_reason = reason;
  return true;
}

void BridgedArm::command(const Joints& dq) {
  const std::int64_t now_ns = options_.now_ns();
  const std::int64_t step_ns = std::min(now_ns - commanded_ns_, kLongestStep);
  commanded_ns_ = now_ns;
  if (!dq.allFinite()) return;
  if (!is_connected_) {
    if (protocol_->is_stopped_by_command() && now_ns < stopping_until_ns_) {
      protocol_->send(Joints::Zero(dq.size()), options_.wall_clock());
      ++counts_.commands;
    }
    return;
  }
  const bool rests = dq.isZero(0);
  if (now_ns - connected_ns_ < kGuard) {
    is_early_ = is_early_ || !rests;  // of a palpated that was left running
    return;
  }
  if (!is_commanding_) {
    if (rests) return;
    is_commanding_ = true;
    protocol_->begin(reading_.q);
  }
  protocol_->advance(dq, 1e-9 * static_cast<double>(step_ns));
  if (rests && now_ns < foreign_until_ns_) {
    // Two masters would fight each other: this one has slowed down, and leaves the arm, which may
    // follow the last command for ever.
    if (is_commanding_ && protocol_->is_stopped_by_command()) {
      protocol_->send(dq, options_.wall_clock());
      ++counts_.commands;
    }
    is_commanding_ = false;
    return;
  }
  // One command for each status, so that a driver in lock-step with its arm finds a new one in
  // every cycle.
  if (!unanswered_) return;
  unanswered_ = false;
  protocol_->send(dq, options_.wall_clock());
  ++counts_.commands;
}

}  // namespace palpate::bridge

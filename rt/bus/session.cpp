#include "rt/bus/session.hpp"

#include <algorithm>
#include <random>

namespace palpate::bus {
namespace {

/// Signed distance from `b` to `a`, modulo 2^32: negative if `a` is older.
std::int32_t distance(std::int32_t a, std::int32_t b) noexcept {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) - static_cast<std::uint32_t>(b));
}

}  // namespace

std::int64_t random_session() {
  std::random_device device;
  const std::uint64_t bits = static_cast<std::uint64_t>(device()) << 32 | device();
  return static_cast<std::int64_t>(bits >> 1 | 1);
}

bool SequenceTracker::accept(std::int64_t session, std::int32_t seq) noexcept {
  if (sessions_ == 0 || (session != session_ && !left_before(session))) {
    begin(session, seq);
    return true;
  }
  const std::int32_t ahead = distance(seq, seq_);
  if (session == session_ && ahead > 0) {
    lost_ += ahead - 1;
    seq_ = seq;
    old_in_a_row_ = 0;
    return true;
  }
  if (old_but_alone(session, seq)) {
    begin(session, seq);
    return true;
  }
  ++rejected_;
  return false;
}

void SequenceTracker::begin(std::int64_t session, std::int32_t seq) noexcept {
  if (sessions_ > 0 && session != session_) {
    // the session that starts is removed from the previous ones; the one that ends becomes the
    // newest of them
    const auto rest = std::remove(left_.begin(), left_.begin() + left_count_, session);
    left_count_ = std::min<std::ptrdiff_t>(rest - left_.begin() + 1, left_.size());
    std::move_backward(left_.begin(), left_.begin() + left_count_ - 1, left_.begin() + left_count_);
    left_[0] = session_;
  }
  ++sessions_;
  session_ = session;
  seq_ = seq;
  old_in_a_row_ = 0;
}

bool SequenceTracker::left_before(std::int64_t session) const noexcept {
  const auto end = left_.begin() + left_count_;
  return std::find(left_.begin(), end, session) != end;
}

bool SequenceTracker::old_but_alone(std::int64_t session, std::int32_t seq) noexcept {
  const bool continues = old_in_a_row_ > 0 && session == old_session_;
  if (continues && seq == old_seq_) return false;
  old_in_a_row_ = continues && distance(seq, old_seq_) > 0 ? old_in_a_row_ + 1 : 1;
  old_session_ = session;
  old_seq_ = seq;
  return old_in_a_row_ >= kRestartAfter;
}

}  // namespace palpate::bus

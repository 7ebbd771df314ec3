#include "tools/record/sequence_gaps.hpp"

namespace palpate::record {
namespace {

// A jump beyond this is a sender that restarted with the same session (a log played again).
constexpr std::int32_t kLargestGap = 1'000'000;
constexpr std::int32_t kLatest = 1000;  // a message this far behind is a late one

}  // namespace

void SequenceGaps::take(const MessageHeader& header) {
  const auto found = last_.find(header.session);
  if (found == last_.end()) {
    // Above any number of real senders; random sessions must not exhaust memory.
    if (last_.size() < kMostSessions) last_[header.session].seq = header.seq;
    return;
  }
  Sender& sender = found->second;
  // Modulo 2^32, as senders count.
  const auto ahead = static_cast<std::int32_t>(static_cast<std::uint32_t>(header.seq) -
                                               static_cast<std::uint32_t>(sender.seq));
  if (ahead == 0) return;
  if (ahead < 0 && ahead > -kLatest) {
    if (sender.missing > 0) {
      --sender.missing;
      --lost_;
    }
    return;
  }
  if (ahead > 0 && ahead < kLargestGap) {
    lost_ += ahead - 1;
    sender.missing += ahead - 1;
  } else {
    sender.missing = 0;
  }
  sender.seq = header.seq;
}

}  // namespace palpate::record

#pragma once

#include <cstdint>
#include <map>

#include "tools/record/message_types.hpp"

namespace palpate::record {

/// Counts the lost messages of one channel, by the gaps in each sender's sequence. A message that
/// arrives late is subtracted again.
class SequenceGaps {
 public:
  void take(const MessageHeader& header);

  std::int64_t lost() const noexcept { return lost_; }
  /// Number of senders' starts, at most kMostSessions.
  int sessions() const noexcept { return static_cast<int>(last_.size()); }

 private:
  static constexpr std::size_t kMostSessions = 64;
  struct Sender {
    std::int32_t seq = 0;
    std::int64_t missing = 0;  // of this sender, not come yet
  };
  std::map<std::int64_t, Sender> last_;
  std::int64_t lost_ = 0;
};

}  // namespace palpate::record

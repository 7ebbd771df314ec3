#pragma once

#include <bitset>
#include <cstdint>

namespace palpate::log {

/// Loss statistics from the sequence numbers of one sender's messages on one channel.
class Sequence {
 public:
  void add(std::int64_t seq);

  std::int64_t received() const { return received_; }
  std::int64_t repeated() const { return repeated_; }  // numbers received before
  std::int64_t late() const { return late_; }          // received after a higher number
  /// Numbers between the first and the last that were never received. A message more than kWindow
  /// numbers behind the highest counts as repeated.
  std::int64_t lost() const;

 private:
  static constexpr std::int64_t kWindow = 1024;

  std::int64_t received_ = 0, repeated_ = 0, late_ = 0;
  std::int64_t lowest_ = 0, highest_ = 0;
  std::bitset<kWindow> seen_;  // of the numbers up to kWindow below the highest, by their remainder
};

}  // namespace palpate::log

#include "tools/log/sequence.hpp"

#include <algorithm>

namespace palpate::log {

void Sequence::add(std::int64_t seq) {
  const auto bit = [](std::int64_t number) {
    return static_cast<std::size_t>((number % kWindow + kWindow) % kWindow);
  };
  if (received_++ == 0) {
    lowest_ = highest_ = seq;
    seen_[bit(seq)] = true;
    return;
  }
  if (seq > highest_) {
    if (seq - highest_ >= kWindow) {
      seen_.reset();
    } else {
      for (std::int64_t number = highest_ + 1; number < seq; ++number) seen_[bit(number)] = false;
    }
    highest_ = seq;
    seen_[bit(seq)] = true;
    return;
  }
  if (highest_ - seq >= kWindow || seen_[bit(seq)]) {
    ++repeated_;
    return;
  }
  ++late_;
  lowest_ = std::min(lowest_, seq);
  seen_[bit(seq)] = true;
}

std::int64_t Sequence::lost() const {
  return received_ == 0 ? 0 : highest_ - lowest_ + 1 - (received_ - repeated_);
}

}  // namespace palpate::log

#include "intake.hpp"

#include <algorithm>

#include "conversions.hpp"

namespace palpate::ros2_bridge {

void Intake::refuse(std::atomic<std::int64_t>& count, const char* reason) {
  ++count;
  if (std::find(reasons_.begin(), reasons_.end(), reason) == reasons_.end())
    reasons_.push_back(reason);
}

std::optional<std::int64_t> Intake::admit(const Time& stamp, std::int64_t now_us) {
  const std::optional<std::int64_t> sent = utime_of(stamp);
  if (!sent) {
    refuse("the stamp is no time");
    return std::nullopt;
  }
  if (!clock_.is_sender || *sent == 0) {
    ++counts_.accepted;
    return now_us;
  }
  const auto most = static_cast<std::int64_t>(1e6 * clock_.most_age);
  if (newest_ > now_us + most) newest_ = 0;  // the clocks have been set
  if (now_us - *sent > most) {
    refuse(counts_.late, "late by its stamp: are the clocks of both machines equal?");
  } else if (*sent - now_us > most) {
    refuse(counts_.ahead, "stamped in the future: are the clocks of both machines equal?");
  } else if (*sent <= newest_) {
    refuse(counts_.overtaken, "not later than the message before");
  } else {
    newest_ = *sent;
    ++counts_.accepted;
    return sent;
  }
  return std::nullopt;
}

std::string Intake::complaint() {
  return said_ < reasons_.size() ? topic_ + ": " + reasons_[said_++] : "";
}

std::string Intake::summary() const {
  const auto text = [](const std::atomic<std::int64_t>& count) {
    return std::to_string(count.load());
  };
  return text(counts_.accepted) + " accepted, " + text(counts_.malformed) + " malformed, " +
         text(counts_.late) + " late, " + text(counts_.ahead) + " ahead, " +
         text(counts_.overtaken) + " overtaken";
}

}  // namespace palpate::ros2_bridge

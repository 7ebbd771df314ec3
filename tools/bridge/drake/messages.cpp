#include "messages.hpp"

#include <algorithm>
#include <cstdio>

namespace palpate::drake_bridge {

std::string Refusals::next() {
  for (const bus::Subscription* input : inputs_) {
    const bus::SubscriptionCounters& counters = input->counters();
    if (counters.wrong_size > 0 && !reported_size_) {
      reported_size_ = true;
      return input->channel() +
             ": messages of another number of joints are refused; allowed: " + accepted_;
    }
    const std::int64_t type = counters.last_wrong_fingerprint;
    const bool is_known = std::any_of(
        inputs_.begin(), inputs_.end(),
        [type](const bus::Subscription* other) { return other->fingerprint() == type; });
    if (counters.wrong_type == 0 || type == reported_type_ || is_known) continue;
    reported_type_ = type;
    char text[24];
    std::snprintf(text, sizeof(text), "0x%016llx", static_cast<unsigned long long>(type));
    return input->channel() + ": messages of type " + text + " are refused; allowed: " + accepted_;
  }
  return "";
}

std::int64_t CommandWatch::stamp(std::int64_t utime) noexcept {
  last_ = std::max(utime, last_ + 1);
  sent_[next_] = last_;
  next_ = (next_ + 1) % kRemembered;
  return last_;
}

bool CommandWatch::any() noexcept {
  const bus::SubscriptionCounters& counters = raw_->counters();
  const std::int64_t refused = counters.wrong_size + counters.wrong_type;
  bool any = refused != refused_;
  refused_ = refused;
  std::int64_t arrival_ns = 0;
  while (const void* data = raw_->take(arrival_ns)) {
    const auto utime = number_at<std::int64_t>(data, kUtimeOffset);
    any = any || std::find(sent_.begin(), sent_.end(), utime) == sent_.end();
  }
  return any;
}

bool ForceTorqueInput::take(math::Wrench& wrench_S) {
  ::drake::lcmt_force_torque message;
  std::int64_t arrival_ns = 0;
  while (messages_.take(message, arrival_ns)) {
    const math::Wrench wrench{{message.fx, message.fy, message.fz},
                              {message.tx, message.ty, message.tz}};
    if (!wrench.force.allFinite() || !wrench.torque.allFinite()) continue;
    wrench_S = wrench;
    return true;
  }
  return false;
}

}  // namespace palpate::drake_bridge

#include "tools/top/daemon_watch.hpp"

#include <algorithm>
#include <palpate/channels.hpp>

#include "tools/record/message_types.hpp"

namespace palpate::top {
namespace {

constexpr std::int64_t kSilent =
    2'000'000'000;  // ns without messages, after which a daemon or a test is no longer counted
constexpr std::size_t kMostSessions = 64;

template <class Message>
bool decoded(const record::Heard& heard, Message& message) {
  const record::MessageType* type = record::type_of(heard.data, heard.size);
  return type != nullptr && type->fingerprint == Message::getHash() &&
         type->fits(heard.data, heard.size) && message.decode(heard.data, 0, heard.size) >= 0;
}

template <std::size_t kSize>
std::string text_of(const std::uint8_t (&field)[kSize]) {
  return printable(field, static_cast<int>(kSize));
}

std::string line_of(const component_event_t& event) {
  std::string line = text_of(event.slot);
  for (const std::string& word : {text_of(event.component), text_of(event.event)}) {
    if (!word.empty()) line += (line.empty() ? "" : " ") + word;
  }
  const std::string reason = text_of(event.reason);
  return reason.empty() ? line : line + ": " + reason;
}

}  // namespace

const std::array<const char*, kPhases> kPhaseNames = {"all",        "read",    "sensing", "contact",
                                                      "estimation", "feature", "control", "gate",
                                                      "publish",    "wake-up"};

std::string printable(const std::uint8_t* field, int size) {
  std::string text;
  for (int i = 0; i < size && field[i] != 0; ++i)
    text += field[i] >= 32 && field[i] < 127 ? static_cast<char>(field[i]) : '?';
  return text;
}

void DaemonWatch::take(const record::Heard& heard) {
  if (heard.channel.substr(0, 6) == channel::kHealth) {
    health_t health{};
    if (!decoded(heard, health)) return;
    health_ = health;
    health_ns_ = heard.arrival_ns;
    if (heard_.size() < kMostSessions || heard_.count(health.session) > 0)
      heard_[health.session] = heard.arrival_ns;
  } else if (heard.channel.substr(0, 15) == channel::kComponentEvent) {
    component_event_t event{};
    if (decoded(heard, event)) event_ = line_of(event);
  } else if (heard.channel.substr(0, 11) == channel::kDiscrepancy) {
    discrepancy_t discrepancy{};
    if (!decoded(heard, discrepancy)) return;
    discrepancy_ = discrepancy;
    discrepancy_ns_ = heard.arrival_ns;
  }
}

double DaemonWatch::health_age(std::int64_t now_ns) const noexcept {
  return static_cast<double>(now_ns - health_ns_) * 1e-9;
}

const discrepancy_t* DaemonWatch::discrepancy(std::int64_t now_ns) const noexcept {
  return discrepancy_ && now_ns - discrepancy_ns_ < kSilent ? &*discrepancy_ : nullptr;
}

int DaemonWatch::daemons(std::int64_t now_ns) const noexcept {
  return static_cast<int>(std::count_if(heard_.begin(), heard_.end(), [now_ns](const auto& one) {
    return now_ns - one.second < kSilent;
  }));
}

}  // namespace palpate::top

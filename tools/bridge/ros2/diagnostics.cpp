#include "diagnostics.hpp"

#include <algorithm>
#include <palpate/channels.hpp>
#include <string_view>

#include "conversions.hpp"
#include "rt/bus/text.hpp"
#include "rt/client/client.hpp"

namespace palpate::ros2_bridge {
namespace {

constexpr std::int64_t kPeriod = 1'000'000;   // us, between two reports
constexpr std::int64_t kAbsence = 1'000'000;  // us without HEALTH

std::string text_of(float number) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.1f", static_cast<double>(number));
  return text;
}

}  // namespace

Diagnosis diagnose(const health_t& health) {
  Diagnosis to;
  to.name = "palpated";
  const bool is_error = health.state == health_t::STATE_FAULTED;
  const bool is_warning =
      health.state == health_t::STATE_DEGRADED || health.state == health_t::STATE_UNCONFIGURED;
  to.level = is_error ? Diagnosis::kError : is_warning ? Diagnosis::kWarning : Diagnosis::kOk;
  to.message = client::name_of_state(health);
  if (const std::string reason = bus::get_text(health.reason); !reason.empty())
    to.message += ": " + reason;
  to.values = {{"cycles", std::to_string(health.cycles)},
               {"overruns", std::to_string(health.overruns)},
               {"gate_limited", std::to_string(health.gate_limited)},
               {"gate_rejected", std::to_string(health.gate_rejected)},
               {"commands_rejected", std::to_string(health.commands_rejected)}};
  const int inputs = std::clamp<int>(health.input_count, 0, std::size(health.input_name));
  for (int i = 0; i < inputs; ++i)
    to.values.emplace_back(bus::get_text(health.input_name[i]),
                           "age " + text_of(health.age_ms[i]) + " ms, " +
                               std::to_string(health.received[i]) + " received, " +
                               std::to_string(health.lost[i]) + " lost, " +
                               std::to_string(health.rejected[i]) + " rejected");
  return to;
}

Diagnosis diagnose(const component_event_t& event) {
  Diagnosis to;
  const std::string_view name = bus::get_text(event.event);
  to.name = std::string("palpated: ") + bus::get_text(event.slot);
  to.message = name;
  if (const std::string reason = bus::get_text(event.reason); !reason.empty())
    to.message += ": " + reason;
  if (name == "faulted") to.level = Diagnosis::kError;
  for (const char* const warning : {"refused", "degraded", "no_access", "wrong type", "fallback"})
    if (name == warning) to.level = Diagnosis::kWarning;
  for (const auto& [key, value] : {std::pair{"component", bus::get_text(event.component)},
                                   std::pair{"instance", bus::get_text(event.instance)}})
    if (*value != 0) to.values.emplace_back(key, value);
  return to;
}

Diagnostics::Diagnostics(const Participant& participant, const std::string& topic,
                         bus::MessageBus& housekeeping, Counters counters)
    : healths_(housekeeping, channel::kHealth, 16),
      events_(housekeeping, channel::kComponentEvent, 64),
      counters_(std::move(counters)),
      writer_(participant, {topic, Quality::kReliable, 10}) {}

void Diagnostics::publish(std::vector<Diagnosis> all, std::int64_t now_us) {
  std::string none;
  std::vector<DiagnosticStatus> statuses;
  std::vector<std::vector<KeyValue>> values(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (auto& [key, value] : all[i].values) values[i].push_back({key.data(), value.data()});
    DiagnosticStatus status{};
    status.level = all[i].level;
    status.name = all[i].name.data();
    status.message = all[i].message.data();
    status.hardware_id = none.data();
    refer(status.values, values[i]);
    statuses.push_back(status);
  }
  DiagnosticArray message{};
  message.header = {stamp_of(now_us), none.data()};
  refer(message.status, statuses);
  writer_.write(message);
}

void Diagnostics::cycle(std::int64_t now_us) {
  std::int64_t arrival_ns = 0;
  while (healths_.take(health_, arrival_ns)) heard_us_ = now_us;
  std::vector<Diagnosis> all;
  for (component_event_t event; events_.take(event, arrival_ns);) all.push_back(diagnose(event));
  if (now_us - sent_us_ >= kPeriod || now_us < sent_us_) {
    sent_us_ = now_us;
    if (now_us - heard_us_ < kAbsence)
      all.push_back(diagnose(health_));
    else
      all.push_back({Diagnosis::kStale, "palpated", "publishes no HEALTH", {}});
    all.push_back({Diagnosis::kOk, "palpate-ros2", "runs", counters_()});
  }
  if (!all.empty()) publish(std::move(all), now_us);
}

}  // namespace palpate::ros2_bridge

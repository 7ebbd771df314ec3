#include "rt/daemon/health.hpp"

#include <algorithm>
#include <palpate/channels.hpp>

#include "rt/bus/text.hpp"

namespace palpate::daemon {

constexpr int kMostModels = 12;                      // capacity of the message
constexpr std::int64_t kBetweenStates = 10'000'000;  // ns, minimum interval of state changes
// ns, minimum interval of losses and rejections
constexpr std::int64_t kBetweenTroubles = 50'000'000;

namespace {

std::int64_t troubles_of(const Inputs& inputs) noexcept {
  std::int64_t sum = 0;
  for (int i = 0; i < inputs.channel_count(); ++i) {
    const InputReport report = inputs.report(i);
    sum += report.lost + report.rejected + report.frozen;
  }
  return sum;
}

}  // namespace

const char* name(Phase phase) noexcept {
  constexpr std::array<const char*, kPhases> kNames = {
      "all",     "read",    "sensing", "contact", "estimation",
      "feature", "control", "gate",    "publish", "wake-up"};
  return kNames[static_cast<int>(phase)];
}

Health::Health(const bus::MessageBus& control, bus::MessageBus& housekeeping, std::int64_t session,
               std::int64_t configuration_hash, std::int64_t mesh_hash)
    : control_(control),
      housekeeping_(housekeeping),
      health_(housekeeping, channel::kHealth, session, bus::Urgency::kLater),
      config_(housekeeping, channel::kConfig, session, bus::Urgency::kLater) {
  bus::put_text(config_message_.version, PALPATE_VERSION);
  describe(configuration_hash, mesh_hash);
}

void Health::describe(std::int64_t configuration_hash, std::int64_t mesh_hash) noexcept {
  config_message_.configuration_hash = configuration_hash;
  config_message_.mesh_hash = mesh_hash;
}

bool Health::has_new_data(const pipeline::Condition& condition, const Inputs& inputs,
                          std::int64_t now_ns) noexcept {
  const std::int64_t since_ns = now_ns - news_ns_;
  const bool another_state = message_.state != static_cast<int>(condition.state);
  const std::int64_t troubles = troubles_of(inputs);
  const bool is_new = (another_state && since_ns >= kBetweenStates) ||
                      (troubles != troubles_ && since_ns >= kBetweenTroubles);
  if (!is_new) return false;
  news_ns_ = now_ns;
  troubles_ = troubles;
  return true;
}

void Health::publish(const Counters& counters, const pipeline::Condition& condition,
                     const Inputs& inputs, const std::vector<pipeline::RunningModel>& models,
                     std::int64_t utime) noexcept {
  message_.state = static_cast<int>(condition.state);
  char reason[sizeof(message_.reason)];
  put_reason(condition, reason);
  bus::put_text(message_.reason, reason);
  message_.cycles = counters.cycles;
  message_.overruns = counters.overruns;
  message_.overrun_us = counters.overrun_ns / 1000;
  message_.shapes_not_converged = counters.shapes_not_converged;
  message_.page_faults = counters.page_faults;
  message_.allocations = counters.allocations;
  message_.telemetry_dropped = control_.unpublished() + housekeeping_.unpublished();
  message_.gate_limited = counters.gate_limited;
  message_.gate_rejected = counters.gate_rejected;
  message_.commands_rejected = counters.commands_rejected;

  const auto microseconds = [](std::int64_t ns) { return static_cast<float>(ns) * 1e-3F; };
  message_.phase_count = kPhases;
  for (int i = 0; i < kPhases; ++i) {
    const loop::LatencyHistogram& latency = counters.latency[i];
    message_.p50_us[i] = microseconds(latency.quantile_ns(0.5));
    message_.p99_us[i] = microseconds(latency.quantile_ns(0.99));
    message_.p999_us[i] = microseconds(latency.quantile_ns(0.999));
    message_.max_us[i] = microseconds(latency.max_ns());
  }

  message_.input_count = inputs.channel_count();
  for (int i = 0; i < message_.input_count; ++i) {
    const InputReport report = inputs.report(i);
    bus::put_text(message_.input_name[i], report.name);
    message_.received[i] = report.received;
    message_.lost[i] = report.lost;
    message_.rejected[i] = report.rejected;
    message_.frozen[i] = report.frozen;
    message_.age_ms[i] = report.age < 0 ? -1.0F : static_cast<float>(report.age * 1e3);
  }

  const bus::DatagramCounters& datagrams = control_.datagrams();
  message_.datagrams = datagrams.received;
  message_.malformed = datagrams.malformed;
  message_.fragmented = datagrams.fragmented;
  message_.unsubscribed = datagrams.unsubscribed;
  message_.overflowed = datagrams.overflowed;

  message_.model_count = std::min(kMostModels, static_cast<int>(models.size()));
  for (int i = 0; i < message_.model_count; ++i) {
    bus::put_text(message_.model_name[i], models[i].name.c_str());
    bus::put_text(message_.model_executor[i], models[i].executor->kind());
    const sensing::ExecutorCounters counts = models[i].executor->counters();
    message_.model_steps[i] = counts.steps;
    message_.model_late[i] = counts.late;
    message_.model_dropped[i] = counts.dropped;
  }
  health_.publish(message_, utime);
}

}  // namespace palpate::daemon

#include "rt/daemon/component_reports.hpp"

#include <cstdio>
#include <cstring>

namespace palpate::daemon {
namespace {

constexpr std::int64_t kInterval = 100'000'000;  // ns
constexpr const char* kSlot = "sensing";

bool same_condition(const pipeline::Condition& a, const pipeline::Condition& b) noexcept {
  return a.state == b.state && std::strcmp(a.reason, b.reason) == 0;
}

}  // namespace

void ComponentReports::begin(const pipeline::Pipeline& pipeline) noexcept {
  reported_.fill(Reported());
  for (int i = 0; i < pipeline.sensor_count(); ++i) {
    const pipeline::SensorReport report = pipeline.sensor_report(i);
    reported_[i].condition.state = report.condition.state;
    for (std::size_t k = 0; k < reported_[i].faults.size(); ++k) {
      const sensing::Executor* executor = report.model->executor(static_cast<int>(k));
      if (executor != nullptr) reported_[i].faults[k] = executor->counters().faults;
    }
  }
}

void ComponentReports::service(const pipeline::Pipeline& pipeline, Commands& commands,
                               std::int64_t now_ns, std::int64_t utime) noexcept {
  for (int i = 0; i < pipeline.sensor_count(); ++i) {
    const pipeline::SensorReport report = pipeline.sensor_report(i);
    Reported& reported = reported_[i];
    report_faults(report, reported, commands, utime);
    if (same_condition(report.condition, reported.condition)) continue;
    const bool fault = report.condition.state == pipeline::LifeCycle::kFaulted &&
                       reported.condition.state != pipeline::LifeCycle::kFaulted;
    if (!fault && reported.ns != 0 && now_ns - reported.ns < kInterval) continue;
    reported.condition = report.condition;
    reported.ns = now_ns;
    commands.announce(kSlot, report.name, report.component, pipeline::name(report.condition.state),
                      report.condition.reason, utime);
  }
  report_control(pipeline, commands, now_ns, utime);
}

void ComponentReports::report_control(const pipeline::Pipeline& pipeline, Commands& commands,
                                      std::int64_t now_ns, std::int64_t utime) noexcept {
  using Action = control::DiscrepancyAction;
  const Action action = pipeline.discrepancy_action();
  if (action == action_ || (action_ns_ != 0 && now_ns - action_ns_ < kInterval)) return;
  action_ = action;
  action_ns_ = now_ns;
  const bool resumed = action == Action::kContinue;
  if (resumed && !pipeline.is_running()) return;  // a stop or a reset ended it
  const char* event = resumed ? "resumed" : action == Action::kStop ? "stopped" : "slowed";
  commands.announce("control", "", "", event,
                    resumed ? "the estimate is no longer in doubt" : pipeline.discrepancy_reason(),
                    utime);
}

void ComponentReports::report_faults(const pipeline::SensorReport& report, Reported& reported,
                                     Commands& commands, std::int64_t utime) noexcept {
  for (std::size_t k = 0; k < reported.faults.size(); ++k) {
    const sensing::Executor* executor = report.model->executor(static_cast<int>(k));
    if (executor == nullptr) return;
    const sensing::ExecutorCounters counters = executor->counters();
    if (counters.faults == reported.faults[k]) continue;
    reported.faults[k] = counters.faults;
    char reason[200];
    std::snprintf(reason, sizeof(reason),
                  "executor %s, model %zu: the network fails or hangs; steps %lld, late %lld, "
                  "dropped %lld",
                  executor->kind(), k, static_cast<long long>(counters.steps),
                  static_cast<long long>(counters.late), static_cast<long long>(counters.dropped));
    commands.announce(kSlot, report.name, report.component, "model_fault", reason, utime);
  }
}

}  // namespace palpate::daemon

#include "rt/daemon/daemon.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "rt/loop/allocation_counter.hpp"

namespace palpate::daemon {
namespace {

std::unique_ptr<CrashRecord> make_record(const Settings& settings, bus::MessageBus& control) {
  if (settings.record.folder.empty()) return nullptr;
  return std::make_unique<CrashRecord>(settings.record, settings.loop.period, control);
}

/// Before anything subscribes or publishes.
Settings name_channels(Settings settings, bus::MessageBus& control, bus::MessageBus& housekeeping) {
  control.set_channel_names(settings.channels);
  housekeeping.set_channel_names(settings.channels);
  return settings;
}

}  // namespace

Daemon::Daemon(const config::Node& root, bus::MessageBus& control, bus::MessageBus& housekeeping,
               Mode mode, std::int64_t session)
    : mode_(mode),
      settings_(name_channels(read_settings(root), control, housekeeping)),
      access_{settings_.key, mode == Mode::kRealTime ? bus::wall_clock_us() : 0},
      record_(mode == Mode::kRealTime ? make_record(settings_, control) : nullptr),
      pipeline_(root, settings_.loop.period, mode == Mode::kDeterministic),
      inputs_(control, pipeline_.arm_count(), settings_.frozen_after, access_),
      commands_(control, housekeeping, session, access_),
      touching_(control, session, access_),
      reports_(pipeline_),
      telemetry_(control, housekeeping, pipeline_, session, access_),
      health_(control, housekeeping, session, root.hash(), pipeline_.object().hash),
      refactoring_(mode == Mode::kRealTime ? -1 : settings_.refactor_delay),
      replacing_(root, pipeline_, telemetry_, housekeeping,
                 mode == Mode::kRealTime ? -1 : settings_.replace_delay),
      types_(control),
      overruns_(settings_.overruns) {
  root.check_all_used();
  inputs_.set_moved_obstacles(pipeline_.obstacles().moved());
}

void Daemon::mark(Phase phase) noexcept {
  if (mode_ != Mode::kRealTime) return;
  const std::int64_t now_ns = loop::monotonic_ns();
  counters_.latency[static_cast<int>(phase)].record(now_ns - phase_began_ns_);
  phase_began_ns_ = now_ns;
}

void Daemon::supervise(const Now& now) noexcept {
  if (mode_ != Mode::kRealTime) return;
  counters_.latency[static_cast<int>(Phase::kWakeUp)].record(now.lateness_ns);
  const auto period_ns = static_cast<std::int64_t>(settings_.loop.period * 1e9);
  // A late wake-up, or a cycle that exceeded its period. A late wake-up may cause its own cycle to
  // end late, which is not another overrun.
  const std::int64_t late_ns = std::max(now.lateness_ns, now.missed * period_ns);
  const bool woke_late = now.lateness_ns >= period_ns;
  if (late_ns >= period_ns) {
    if (woke_late || !woke_late_) ++counters_.overruns;
    counters_.overrun_ns += late_ns;
  }
  woke_late_ = woke_late;
  const OverrunMonitor::Verdict verdict =
      overruns_.record(now.monotonic_ns, late_ns, settings_.loop.period);
  if (verdict == OverrunMonitor::Verdict::kSafeStop && pipeline_.is_running()) {
    pipeline_.fault("no command for too long: safe stop");
  } else {
    pipeline_.set_timing(verdict == OverrunMonitor::Verdict::kDegraded
                             ? UpdateResult{Status::kDegraded, "the loop runs late"}
                             : UpdateResult());
  }
}

void Daemon::tick(const Now& now) noexcept {
  const double dt = settings_.loop.period;
  std::optional<loop::NoAllocationScope> no_allocation;
  if (pipeline_.is_running()) no_allocation.emplace();
  const std::int64_t began_ns = mode_ == Mode::kRealTime ? loop::monotonic_ns() : 0;
  phase_began_ns_ = began_ns;
  ++counters_.cycles;
  if (record_) record_->begin_cycle(now.monotonic_ns, now.utime);
  supervise(now);

  inputs_.read(now.monotonic_ns, dt, now.stepped);
  if (inputs_.any_session_restarted())
    pipeline_.stop("a sensor, hand or robot has restarted: waits for start");
  commands_.handle(pipeline_, replacing_, counters_.cycles, now.utime);
  touching_.handle(pipeline_, now.utime);
  if (const bus::Subscription* channel = types_.look(now.monotonic_ns))
    commands_.announce_wrong_type(*channel, now.utime);
  mark(Phase::kRead);
  pipeline_.sense(inputs_.signals(), inputs_.signals(1));
  replace(now);
  mark(Phase::kSensing);
  pipeline_.distribute();
  mark(Phase::kContact);
  if (pipeline_.has_object()) refactoring_.service(pipeline_.model(), counters_.cycles);
  pipeline_.estimate(dt);
  mark(Phase::kEstimation);
  pipeline_.evaluate_feature();
  mark(Phase::kFeature);
  pipeline_.control(dt);
  mark(Phase::kControl);
  pipeline_.gate(dt);
  bool limited = false, rejected = false;
  for (int arm = 0; arm < pipeline_.arm_count(); ++arm) {
    const control::GateOutput& gate = pipeline_.gate_output(arm);
    telemetry_.publish_command(arm, gate, pipeline_.is_running(), now.utime);
    limited = limited || gate.limited;
    rejected = rejected || gate.rejected;
  }
  if (limited) ++counters_.gate_limited;
  if (rejected) ++counters_.gate_rejected;
  mark(Phase::kGate);
  publish(now);
  mark(Phase::kPublish);
  if (mode_ == Mode::kRealTime) {
    counters_.latency[static_cast<int>(Phase::kAll)].record(loop::monotonic_ns() - began_ns);
  }
}

void Daemon::replace(const Now& now) noexcept {
  if (const std::optional<pipeline::ClosedGrasp> grasp = pipeline_.jaws().wanted())
    if (replacing_.request(*grasp, counters_.cycles)) pipeline_.jaws().begin(grasp->hand);
  const Replacing::Outcome outcome = replacing_.service(refactoring_, counters_.cycles);
  if (outcome == Replacing::Outcome::kNothing) return;
  if (const std::optional<pipeline::ClosedGrasp>& grasp = replacing_.grasp())
    pipeline_.jaws().end(grasp->hand, outcome == Replacing::Outcome::kReplaced);
  if (outcome == Replacing::Outcome::kReplaced) {
    health_.describe(replacing_.configuration_hash(), pipeline_.object().hash);
    reports_.begin(pipeline_);
  }
  commands_.announce(replacing_, outcome, now.utime);
}

void Daemon::publish(const Now& now) noexcept {
  const pipeline::Condition condition = pipeline_.condition();
  if (condition.state != announced_) {
    const bool begins = announced_ == pipeline::LifeCycle::kUnconfigured ||
                        announced_ == pipeline::LifeCycle::kInactive;
    if (begins) {
      faults_at_start_ = loop::page_faults_of_this_thread();
      allocations_at_start_ = loop::allocations_of_this_thread();
    }
    announced_ = condition.state;
    if (record_ && condition.state == pipeline::LifeCycle::kFaulted) record_->hand_over("fault");
    commands_.announce(condition, now.utime);
  }
  const bus::ReplayGuard* const admissions[] = {inputs_.admissions()[0], inputs_.admissions()[1],
                                                &touching_.admission()};
  commands_.announce_rejected(admissions, now.monotonic_ns, now.utime);
  touching_.publish(pipeline_, now.monotonic_ns, now.utime);
  if (pipeline_.fallbacks_taken() != reported_fallbacks_) {
    reported_fallbacks_ = pipeline_.fallbacks_taken();
    if (record_) record_->hand_over("fallback");
    commands_.announce("all", "", "", "fallback", pipeline_.fallback_reason(), now.utime);
  }
  reports_.service(pipeline_, commands_, now.monotonic_ns, now.utime);
  telemetry_.publish_state(pipeline_, now.utime);

  const elasticity::StepStatus status = pipeline_.estimate().step.status;
  if (pipeline_.is_running()) {
    if (status == elasticity::StepStatus::kConverged) shape_ns_ = now.monotonic_ns;
    if (status != elasticity::StepStatus::kConverged) ++counters_.shapes_not_converged;
    if (pipeline_.estimate().jumped) report_jump(now);
  }
  const std::int64_t cycle = counters_.cycles;
  if (cycle % settings_.shape_every == 0 && pipeline_.is_running()) {
    const std::int64_t age_us = shape_ns_ == 0 ? 0 : (now.monotonic_ns - shape_ns_) / 1000;
    telemetry_.publish_shape(pipeline_, age_us, now.utime);
  }
  const auto every = [this, cycle](double seconds, std::int64_t offset) {
    const auto cycles = std::max<std::int64_t>(1, std::llround(seconds / settings_.loop.period));
    return cycle % cycles == offset % cycles;
  };
  const bool is_new = health_.has_new_data(condition, inputs_, now.monotonic_ns);
  if (every(0.1, 3) || is_new) {
    if (mode_ == Mode::kRealTime && pipeline_.is_running()) {
      counters_.page_faults = loop::page_faults_of_this_thread() - faults_at_start_;
      const std::int64_t allocations = loop::allocations_of_this_thread();
      counters_.allocations = allocations < 0 ? -1 : allocations - allocations_at_start_;
    }
    counters_.commands_rejected = commands_.rejected();
    for (const bus::ReplayGuard* admission : admissions)
      counters_.commands_rejected += admission->rejected();
    health_.publish(counters_, condition, inputs_, pipeline_.running_models(), now.utime);
  }
  if (every(1.0, 7)) health_.publish_config(now.utime);
  for (int chunk = 0; chunk < telemetry_.mesh_chunks(); ++chunk) {
    if (every(1.0, 11 + 2 * chunk)) telemetry_.publish_mesh_chunk(now.utime);
  }
}

/// At most once per second, however often the shape jumps.
void Daemon::report_jump(const Now& now) noexcept {
  constexpr std::int64_t kSecond = 1'000'000'000;
  if (jump_reported_ns_ != 0 && now.monotonic_ns - jump_reported_ns_ < kSecond) return;
  jump_reported_ns_ = now.monotonic_ns;
  const bool restarted = pipeline_.estimate().step.restarted;
  commands_.announce("estimation", "", "", "jump",
                     restarted ? "the shape was one that the object can hardly have, and is given "
                                 "up for a better one"
                               : "the shape has moved further in a cycle than any motion explains",
                     now.utime);
}

bool Daemon::is_still() const noexcept {
  for (int arm = 0; arm < pipeline_.arm_count(); ++arm)
    if (!pipeline_.gate_output(arm).V_W_E.vector().isZero(0)) return false;
  return true;
}

void Daemon::finish(const Now& now) noexcept {
  for (int arm = 0; arm < pipeline_.arm_count(); ++arm)
    telemetry_.publish_command(arm, control::GateOutput(), false, now.utime);
}

}  // namespace palpate::daemon

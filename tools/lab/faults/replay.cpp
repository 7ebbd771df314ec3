#include "tools/lab/faults/replay.hpp"

#include <cstring>

namespace palpate::faults {

Replay::Replay(const Recording& recording, const std::vector<std::string>& overrides,
               daemon::Mode mode)
    : recording_(recording) {
  const config::Node root = configuration(overrides);
  daemon_ = std::make_unique<daemon::Daemon>(root, *daemon_bus_, *daemon_bus_, mode, 1);
  monitor_ =
      std::make_unique<Monitor>(registry::read_gate_limits(root), daemon_->settings().loop.period);
}

void look_at(const std::vector<bus::Published>& said, daemon::Daemon& daemon, Monitor& monitor) {
  const auto& robot = daemon.inputs().signals().robot;
  std::optional<Eigen::Vector3d> p_W_E;
  if (robot.freshness != Freshness::kNoData) p_W_E = robot.latest.X_WE.translation();
  const control::GateOutput& gate = daemon.pipeline().gate_output(0);
  const bool restrained = gate.rejected || std::strcmp(gate.reason, "inactive") == 0;
  for (const bus::Published& message : said) monitor.look(message, p_W_E, restrained);
}

Trace Replay::run(const Stream& stream, int ticks, const Each& each) {
  Trace trace;
  auto next = stream.begin();
  for (int tick = 1; tick <= ticks; ++tick) {
    const std::int64_t now_ns = 1'000'000LL * tick;
    bus::set_time(*hub_, now_ns);
    if (tick == kStartTick) user_.send({"start"}, 0);
    if (tick == kTargetTick) user_.set_target(message_of(recording_.target), 0);
    for (; next != stream.end() && next->time_ns <= now_ns; ++next)
      outside_->publish(next->channel.c_str(), next->data.data(),
                        static_cast<int>(next->data.size()));
    daemon::Now now;
    now.monotonic_ns = now_ns;
    now.utime = now_ns / 1000;
    if (each && !each(tick, now)) {
      trace.cycles.push_back(trace.cycles.empty() ? Cycle() : trace.cycles.back());
      continue;
    }
    bus::record(*hub_, &said_);
    daemon_->tick(now);
    bus::record(*hub_, nullptr);
    observe(tick, trace);
  }
  trace.health = monitor_->health();
  trace.events = monitor_->events();
  trace.not_finite = monitor_->not_finite();
  trace.beyond_limits = monitor_->beyond_limits();
  trace.undecoded = monitor_->undecoded();
  trace.complaint = monitor_->complaint();
  trace.largest_step = monitor_->largest_step();
  return trace;
}

void Replay::observe(int tick, Trace& trace) {
  const pipeline::Pipeline& pipeline = daemon_->pipeline();
  look_at(said_, *daemon_, *monitor_);
  said_.clear();

  Cycle cycle;
  cycle.state = pipeline.condition().state;
  cycle.command_valid = monitor_->command_valid();
  cycle.speed = monitor_->speed();
  cycle.hash = monitor_->take_hash();
  cycle.contact_hash = monitor_->take_contact_hash();
  if (pipeline.contacts().count > 0) cycle.wrench = pipeline.contacts().contacts[0].wrench.vector();
  trace.cycles.push_back(cycle);

  const std::size_t index = tick / kTruthEvery;
  if (tick % kTruthEvery != 0 || index > recording_.truth.size()) return;
  const Eigen::Matrix3Xd& truth = recording_.truth[index - 1];
  const Eigen::Matrix3Xd& x = pipeline.model().positions();
  if (x.cols() != truth.cols()) return;
  trace.shape_error.push_back((x - truth).norm() / std::sqrt(static_cast<double>(truth.cols())));
}

}  // namespace palpate::faults

#include "tools/lab/faults/fault_wire.hpp"

#include <poll.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>

#include "rt/bus/session.hpp"
#include "rt/loop/fixed_rate_loop.hpp"
#include "tools/common/interruption.hpp"

namespace palpate::faults {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;  // ns
constexpr int kRoom = 1 << 16;                    // messages queued for the listener

}  // namespace

FaultWire::FaultWire(const runs::Urls& urls)
    : sender_(bus::make_lcm_bus(urls.control)),
      user_(*sender_),
      control_(urls.control),
      housekeeping_(urls.housekeeping) {
  if (!control_.good() || !housekeeping_.good())
    throw std::runtime_error("cannot listen to " + urls.control + " and " + urls.housekeeping);
  control_.subscribe("TWIST_COMMAND|CONTACTS|ESTIMATE|FEATURE", &FaultWire::take, this)
      ->setQueueCapacity(kRoom);
  housekeeping_.subscribe("SHAPE|SHAPE_MESH|HEALTH|CONFIG|COMPONENT_EVENT", &FaultWire::take, this)
      ->setQueueCapacity(kRoom);
  listener_ = std::thread([this] { listen(); });
}

FaultWire::~FaultWire() {
  stop_ = true;
  if (listener_.joinable()) listener_.join();
}

void FaultWire::listen() {
  pollfd watched[] = {{control_.getFileno(), POLLIN, 0}, {housekeeping_.getFileno(), POLLIN, 0}};
  while (!stop_) {
    if (poll(watched, 2, 50) <= 0) continue;
    if (watched[0].revents != 0) control_.handle();
    if (watched[1].revents != 0) housekeeping_.handle();
  }
}

void FaultWire::take(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
  const auto* bytes = static_cast<const std::uint8_t*>(buffer->data);
  heard_any_ = true;
  const std::int64_t origin_us = origin_us_;
  if (origin_us == 0) return;  // before the scenario
  // The kernel's time of arrival at this machine, regardless of when this thread reads the
  // datagram.
  const std::int64_t time_ns = 1000 * (buffer->recv_utime - origin_us);
  heard_.push_back({channel, {bytes, bytes + buffer->data_size}, time_ns});
}

void FaultWire::begin() { origin_us_ = bus::wall_clock_us(); }

double FaultWire::now() const {
  return 1e-6 * static_cast<double>(bus::wall_clock_us() - origin_us_);
}

void FaultWire::play(const faults::Recording& recording, const faults::Scenario& scenario,
                     const std::function<void(int tick)>& each) {
  begin();
  const std::int64_t origin_ns = loop::monotonic_ns();
  auto next = scenario.stream.begin();
  for (int tick = 1; tick <= scenario.ticks; ++tick) {
    common::throw_if_interrupted();
    const std::int64_t due_ns = kMillisecond * tick;
    const std::int64_t early_ns = due_ns - (loop::monotonic_ns() - origin_ns);
    if (early_ns > 0) std::this_thread::sleep_for(std::chrono::nanoseconds(early_ns));
    latest_ = std::max(latest_, -1e-9 * static_cast<double>(early_ns));
    if (tick == faults::kStartTick) user_.send("start");
    if (tick == faults::kTargetTick) user_.send_target("point", recording.target);
    for (const faults::Scenario::Act& act : scenario.acts)
      if (act.tick == tick) act.act(user_);
    each(tick);
    for (; next != scenario.stream.end() && next->time_ns <= due_ns; ++next)
      sender_->publish(next->channel.c_str(), next->data.data(),
                       static_cast<int>(next->data.size()));
  }
}

faults::Trace FaultWire::trace(int ticks, const control::GateLimits& limits, double period) {
  stop_ = true;
  listener_.join();
  // Times of the daemon's actions are taken from its own stamps: on a busy machine HEALTH arrives
  // long after the commands of its cycle, and datagrams overtake each other. The time of a report
  // is its arrival.
  const auto said_ns = [this](const bus::Published& message) {
    return 1000 * (faults::header_of(message).utime - origin_us_);
  };
  std::stable_sort(heard_.begin(), heard_.end(),
                   [&](const auto& a, const auto& b) { return said_ns(a) < said_ns(b); });
  heard_ = faults::rising(heard_);
  faults::Monitor monitor(limits, period);
  faults::Trace trace;
  faults::Cycle cycle;
  auto next = heard_.begin();
  for (int tick = 1; tick <= ticks; ++tick) {
    for (; next != heard_.end() && said_ns(*next) <= kMillisecond * tick; ++next)
      monitor.look(*next, {}, {});
    if (!monitor.health().empty())
      cycle.state = static_cast<pipeline::LifeCycle>(monitor.health().back().state);
    cycle.command_valid = monitor.command_valid();
    cycle.speed = monitor.speed();
    trace.cycles.push_back(cycle);
  }
  trace.health = monitor.health();
  trace.events = monitor.events();
  trace.not_finite = monitor.not_finite();
  trace.beyond_limits = monitor.beyond_limits();
  trace.undecoded = monitor.undecoded();
  trace.complaint = monitor.complaint();
  trace.largest_step = monitor.largest_step();
  return trace;
}

}  // namespace palpate::faults

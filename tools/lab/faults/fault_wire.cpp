#include "tools/lab/faults/fault_wire.hpp"

#include <linux/sockios.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/time.h>

#include <algorithm>
#include <chrono>
#include <palpate/channels.hpp>
#include <palpate/component_event_t.hpp>
#include <palpate/config_t.hpp>
#include <palpate/contacts_t.hpp>
#include <palpate/estimate_t.hpp>
#include <palpate/feature_t.hpp>
#include <palpate/health_t.hpp>
#include <palpate/shape_mesh_t.hpp>
#include <palpate/shape_t.hpp>
#include <palpate/twist_command_t.hpp>

#include "rt/bus/checked_decode.hpp"
#include "rt/bus/session.hpp"
#include "rt/loop/fixed_rate_loop.hpp"
#include "tools/common/interruption.hpp"

namespace palpate::faults {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;  // ns
constexpr int kRoom = 64 << 20;                   // bytes that wait for the listener
constexpr int kTurn = 256;                        // datagrams of a URL while the other one waits

template <class Message>
bool decodes(const void* data, int size) {
  Message message;
  return bus::checked_decode(message, data, size);
}

/// us of the wall clock when the last datagram came to this machine, whenever its reader got to see
/// it. The first call makes the system stamp those that follow.
std::int64_t arrival_us(const bus::UdpmSocket& socket) {
  timeval stamp{};
  if (ioctl(socket.descriptor(), SIOCGSTAMP, &stamp) != 0) return bus::wall_clock_us();
  return std::int64_t{1'000'000} * stamp.tv_sec + stamp.tv_usec;
}

}  // namespace

FaultWire::FaultWire(const runs::Urls& urls)
    : sender_(bus::make_lcm_bus(urls.control)), user_(*sender_, *sender_, {}, 1) {
  control_.channels = {{channel::kTwistCommand, decodes<twist_command_t>},
                       {channel::kContacts, decodes<contacts_t>},
                       {channel::kEstimate, decodes<estimate_t>},
                       {channel::kFeature, decodes<feature_t>}};
  housekeeping_.channels = {{channel::kShape, decodes<shape_t>},
                            {channel::kShapeMesh, decodes<shape_mesh_t>},
                            {channel::kHealth, decodes<health_t>},
                            {channel::kConfig, decodes<config_t>},
                            {channel::kComponentEvent, decodes<component_event_t>}};
  open(control_, urls.control);
  open(housekeeping_, urls.housekeeping);
  listener_ = std::thread([this] { listen(); });
}

void FaultWire::open(Ear& ear, const std::string& url) {
  bus::UdpmUrl parsed = bus::parse_udpm_url(url);
  parsed.receive_buffer_size = kRoom;
  ear.socket.open(parsed);
  arrival_us(ear.socket);
}

FaultWire::~FaultWire() {
  stop_ = true;
  if (listener_.joinable()) listener_.join();
}

void FaultWire::listen() {
  pollfd watched[] = {{control_.socket.descriptor(), POLLIN, 0},
                      {housekeeping_.socket.descriptor(), POLLIN, 0}};
  while (!stop_) {
    if (poll(watched, 2, 50) <= 0) continue;
    take_waiting(control_);
    take_waiting(housekeeping_);
  }
}

void FaultWire::take_waiting(Ear& ear) {
  for (int i = 0; i < kTurn; ++i) {
    const int size = ear.socket.receive(ear.counters);
    if (size < 0) return;
    bus::UdpmFrame frame{};
    if (!bus::parse_udpm_frame(ear.socket.data(), size, ear.counters, frame)) continue;
    const auto channel =
        std::find_if(ear.channels.begin(), ear.channels.end(),
                     [&frame](const Channel& one) { return one.name == frame.channel; });
    if (channel == ear.channels.end()) continue;
    const bool is_whole = channel->decodes(frame.payload, frame.payload_size);
    if (is_whole) heard_any_ = true;
    const std::int64_t origin_us = origin_us_;
    if (origin_us == 0) continue;  // before the scenario
    if (!is_whole) {
      ++undecoded_;
      continue;
    }
    heard_.push_back({std::string(frame.channel),
                      {frame.payload, frame.payload + frame.payload_size},
                      1000 * (arrival_us(ear.socket) - origin_us)});
  }
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
    if (tick == faults::kStartTick) user_.send({"start"}, 0);
    if (tick == faults::kTargetTick) user_.set_target(message_of(recording.target), 0);
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
  std::int64_t commanded_ns = 0;
  for (const bus::Published& message : heard_) {
    if (message.channel != channel::kTwistCommand) continue;
    last_gap_ = 1e-9 * static_cast<double>(said_ns(message) - commanded_ns);
    commanded_ns = said_ns(message);
  }
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
  trace.undecoded = undecoded_ + monitor.undecoded();
  trace.complaint = monitor.complaint();
  trace.largest_step = monitor.largest_step();
  return trace;
}

}  // namespace palpate::faults

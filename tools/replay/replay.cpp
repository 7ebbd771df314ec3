#include "tools/replay/replay.hpp"

#include <array>
#include <cmath>
#include <cstring>
#include <palpate/component_command_t.hpp>
#include <stdexcept>

#include "core/math/fnv1a.hpp"
#include "rt/bus/event_log_reader.hpp"
#include "rt/daemon/text.hpp"

namespace palpate::replay {
namespace {

constexpr std::int64_t kSession = 1;  // of a deterministic run

/// What the daemon itself said on the control URL when the log was made; it says it anew.
constexpr std::array<const char*, 4> kOwnChannels = {"CONTACTS", "ESTIMATE", "FEATURE",
                                                     "TWIST_COMMAND"};

bool is_own(const std::string& channel) {
  for (const char* own : kOwnChannels) {
    if (channel == own) return true;
  }
  return false;
}

void send_start(bus::MessageBus& bus, const std::optional<bus::Key>& key) {
  component_command_t command{};
  command.session = kSession;
  daemon::put_text(command.slot, "all");
  daemon::put_text(command.event, "start");
  bus::Sealer("COMPONENT_COMMAND", {key, 0}).put(command, 0);
  bus::TypedPublisher<component_command_t>(bus, "COMPONENT_COMMAND").publish(command);
}

/// Takes what was published since the last cycle into hash and output log.
void collect(std::vector<bus::Published>& published, lcm::LogFile* output, math::Fnv1a& shapes,
             ReplayResult& result) {
  for (bus::Published& message : published) {
    if (message.channel == "SHAPE") {
      ++result.shapes;
      shapes.add(message.data.data(), message.data.size());
    }
    if (output == nullptr) continue;
    lcm::LogEvent event{};
    event.timestamp = message.time_ns / 1000;
    event.channel = message.channel;
    event.datalen = static_cast<int>(message.data.size());
    event.data = message.data.data();
    output->writeEvent(&event);
  }
  published.clear();
}

/// A log that is damaged may say any time; a replay would be busy for years.
void check_pause(const std::string& log, const bus::LoggedEvent& next, std::int64_t now_ns) {
  constexpr std::int64_t kLongest = 3600 * std::int64_t{1'000'000};  // us
  const std::int64_t pause = next.utime - now_ns / 1000;
  if (pause <= kLongest) return;
  throw std::runtime_error(log + ": byte " + std::to_string(next.at) + ": the next message comes " +
                           std::to_string(pause / 1'000'000) + " s later, an hour is most");
}

}  // namespace

ReplayResult replay(const config::Node& configuration, const ReplayOptions& options) {
  bus::EventLogReader log(options.log);
  const bus::LoggedEvent* event = log.next();
  if (event == nullptr) throw std::runtime_error(options.log + ": holds no message");

  const auto hub = bus::make_memory_hub();
  const auto input = bus::make_memory_bus(hub);
  const auto control = bus::make_memory_bus(hub);
  // The daemon's housekeeping goes to the same hub: nobody subscribes to it there.
  daemon::Daemon daemon(configuration, *control, *control, daemon::Mode::kDeterministic, kSession);
  control->start();

  std::unique_ptr<lcm::LogFile> output;
  if (!options.output.empty()) {
    output = std::make_unique<lcm::LogFile>(options.output, "w");
    if (!output->good()) throw std::runtime_error(options.output + ": cannot be written");
  }
  ReplayResult result;
  math::Fnv1a shapes;
  std::vector<bus::Published> published;
  const std::int64_t period_ns = std::llround(daemon.settings().loop.period * 1e9);
  const std::int64_t first_us = event->utime;
  std::int64_t now_ns = first_us * 1000;
  bus::set_time(*hub, now_ns);
  if (options.start) send_start(*input, daemon.settings().key);

  while (event != nullptr) {
    bus::record(*hub, nullptr);
    for (; event != nullptr && event->utime * 1000 <= now_ns; event = log.next()) {
      if (is_own(event->channel)) continue;
      bus::set_time(*hub, event->utime * 1000);
      input->publish(event->channel.c_str(), event->data, event->size);
      ++result.messages;
    }
    if (event != nullptr) check_pause(options.log, *event, now_ns);
    bus::set_time(*hub, now_ns);
    bus::record(*hub, &published);
    daemon.tick({now_ns, now_ns / 1000, 0});
    collect(published, output.get(), shapes, result);
    ++result.cycles;
    now_ns += period_ns;
  }
  result.complaint = log.complaint();
  result.shape_hash = shapes.value();
  result.duration = static_cast<double>(now_ns - first_us * 1000) * 1e-9;
  return result;
}

}  // namespace palpate::replay

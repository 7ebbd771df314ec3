#include "tools/replay/replay.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <palpate/channels.hpp>
#include <palpate/component_command_t.hpp>
#include <palpate/shape_v1_t.hpp>
#include <set>
#include <stdexcept>

#include "core/math/fnv1a.hpp"
#include "rt/bus/event_log_reader.hpp"
#include "rt/bus/text.hpp"
#include "rt/client/client.hpp"
#include "rt/daemon/stepped_clock.hpp"
#include "tools/log/event_log.hpp"
#include "tools/record/message_types.hpp"

namespace palpate::replay {
namespace {

// Header of an encoded message: fingerprint, utime, seq, session; for a command also counter and
// code.
constexpr int kSeqAt = 16, kHeaderEnd = record::kMessageHeaderSize,
              kCommandHeaderEnd = kHeaderEnd + 8 + 32;

constexpr std::array<const char*, 4> kStates = {channel::kContacts, channel::kEstimate,
                                                channel::kFeature, channel::kShape};
constexpr std::array<const char*, 3> kCommands = {
    channel::kTwistCommand, channel::kJointVelocityCommand, channel::kHandCommand};

/// Without the suffix of a second arm.
std::string plain(const std::string& channel) {
  const std::size_t size = channel.size();
  return size > 2 && channel.compare(size - 2, 2, "_1") == 0 ? channel.substr(0, size - 2)
                                                             : channel;
}

template <std::size_t kSize>
bool is_one(const std::string& channel, const std::array<const char*, kSize>& names) {
  return std::find(names.begin(), names.end(), channel) != names.end();
}

std::int64_t number_at(const std::uint8_t* data) {
  std::uint64_t big_endian = 0;
  std::memcpy(&big_endian, data, sizeof(big_endian));
  return static_cast<std::int64_t>(__builtin_bswap64(big_endian));
}

/// Whether an encoded shape_t is the first of its chunks.
bool is_first_chunk(const std::uint8_t* data) {
  constexpr int kChunkAt = kHeaderEnd + 8 + 4 + 4;
  return data[kChunkAt] == 0 && data[kChunkAt + 1] == 0;
}

constexpr std::int64_t kSession = 1;  // of a deterministic run

/// Inputs of the daemon on a bus; everything else in a log was published by others, or by itself.
std::set<std::string> inputs_of(const bus::MessageBus& bus) {
  std::set<std::string> channels;
  for (const bus::Subscription* one : bus.subscriptions()) channels.insert(one->channel());
  return channels;
}

bool is_start(const bus::MessageBus& bus, const bus::LoggedEvent& event) {
  component_command_t command{};
  return event.channel == bus.name_of(channel::kComponentCommand) &&
         command.decode(event.data, 0, event.size) == event.size &&
         bus::get_text(command.event) == std::string("start");
}

/// A damaged log may contain any time; a replay would take years.
void check_pause(const std::string& log, const bus::LoggedEvent& next, std::int64_t now_ns) {
  constexpr std::int64_t kLongest = 3600 * std::int64_t{1'000'000};  // us
  const std::int64_t pause = next.utime - now_ns / 1000;
  if (pause <= kLongest) return;
  throw std::runtime_error(log + ": byte " + std::to_string(next.at) + ": the next message comes " +
                           std::to_string(pause / 1'000'000) + " s later, an hour is most");
}

/// A daemon on a bus in memory, fed by a log, and a record of its output.
class Run {
 public:
  Run(const config::Node& configuration, const ReplayOptions& options)
      : options_(options),
        hub_(bus::make_memory_hub()),
        input_(bus::make_memory_bus(hub_)),
        control_(bus::make_memory_bus(hub_)),
        // The daemon's housekeeping uses the same hub, where nothing subscribes to it.
        daemon_(configuration, *control_, *control_, daemon::Mode::kDeterministic, kSession),
        clock_(*control_, kSession),
        inputs_(inputs_of(*control_)) {
    control_->start();
    if (!options.output.empty()) output_.emplace(options.output);
  }

  /// Paced by the log's own time; returns the time of its end, ns.
  std::int64_t by_time(bus::EventLogReader& log, const bus::LoggedEvent* event) {
    const std::int64_t period_ns = std::llround(daemon_.settings().loop.period * 1e9);
    std::int64_t now_ns = event->utime * 1000;
    begin(now_ns);
    while (event != nullptr) {
      for (; event != nullptr && event->utime * 1000 <= now_ns; event = log.next()) offer(*event);
      if (event != nullptr) check_pause(options_.log, *event, now_ns);
      bus::set_time(*hub_, now_ns);
      bus::record(*hub_, &published_);
      daemon_.tick({now_ns, now_ns / 1000, 0});
      collect();
      ++result_.cycles;
      now_ns += period_ns;
    }
    return now_ns;
  }

  /// One cycle for each tick of the simulator; returns the time of the last event, ns.
  std::int64_t by_ticks(bus::EventLogReader& log, const bus::LoggedEvent* event) {
    std::int64_t now_ns = event->utime * 1000;
    begin(now_ns);
    for (; event != nullptr; event = log.next()) {
      now_ns = event->utime * 1000;
      offer(*event);
      if (event->channel != channel::kSimTick) continue;
      bus::record(*hub_, &published_);
      clock_.run_pending(daemon_);  // a repeated tick is answered, not executed again
      collect();
    }
    result_.cycles = daemon_.counters().cycles;
    if (result_.cycles == 0) {
      throw std::runtime_error(options_.log +
                               ": holds no SIM_TICK: it was not made in lock-step; "
                               "leave out --stepped");
    }
    return now_ns;
  }

  ReplayResult finish(std::int64_t duration_ns) {
    compare_housekeeping();
    if (options_.compare) result_.comparison = comparison_.result();
    result_.shape_hash = shapes_.value();
    result_.duration = static_cast<double>(duration_ns) * 1e-9;
    return result_;
  }

 private:
  void begin(std::int64_t now_ns) {
    bus::set_time(*hub_, now_ns);
    if (options_.start)
      client::Client(*input_, *input_, {daemon_.settings().key, 0}, kSession).send({"start"}, 0);
  }

  void offer(const bus::LoggedEvent& event) {
    if (options_.compare) comparison_.take_recorded(event.channel, event.data, event.size);
    if (inputs_.count(event.channel) == 0) {
      ++result_.left_out;
      return;
    }
    if (is_start(*control_, event)) ++result_.starts;
    bus::record(*hub_, nullptr);
    bus::set_time(*hub_, event.utime * 1000);
    input_->publish(event.channel.c_str(), event.data, event.size);
    ++result_.messages;
  }

  /// Passes everything published since the last cycle to hash, comparison and output log.
  void collect() {
    for (bus::Published& message : published_) {
      const int size = static_cast<int>(message.data.size());
      if (message.channel == channel::kShape) {
        if (is_first_chunk(message.data.data())) ++result_.shapes;
        shapes_.add(message.data.data(), message.data.size());
      }
      if (options_.compare) comparison_.take_replayed(message.channel, message.data.data(), size);
      if (output_) output_->write(message.channel, message.time_ns / 1000, message.data);
    }
    published_.clear();
  }

  void compare_housekeeping() {
    if (options_.housekeeping.empty()) return;
    bus::EventLogReader log(options_.housekeeping);
    while (const bus::LoggedEvent* event = log.next())
      comparison_.take_recorded(event->channel, event->data, event->size);
  }

  const ReplayOptions& options_;
  std::shared_ptr<bus::MemoryHub> hub_;
  std::unique_ptr<bus::MessageBus> input_, control_;
  daemon::Daemon daemon_;
  daemon::SteppedClock clock_;
  std::set<std::string> inputs_;
  std::optional<log::EventLog> output_;
  std::vector<bus::Published> published_;
  math::Fnv1a shapes_;
  Comparison comparison_;
  ReplayResult result_;
};

}  // namespace

bool Comparison::concerns(const std::string& channel) {
  return is_one(plain(channel), kStates) || is_one(plain(channel), kCommands);
}

void Comparison::take(Hashes& hashes, const std::string& channel, const std::uint8_t* data,
                      int size) {
  const int skipped_to = is_one(plain(channel), kCommands) ? kCommandHeaderEnd : kHeaderEnd;
  if (size < skipped_to) return;
  math::Fnv1a& hash = hashes[record::header_of(data).utime];
  hash.add(data, kSeqAt);
  hash.add(data + skipped_to, static_cast<std::size_t>(size - skipped_to));
}

void Comparison::take_recorded(const std::string& channel, const std::uint8_t* data, int size) {
  const bool is_former = size >= kHeaderEnd && number_at(data) == shape_v1_t::getHash();
  if (concerns(channel) && !is_former) take(recorded_[channel], channel, data, size);
}

void Comparison::take_replayed(const std::string& channel, const std::uint8_t* data, int size) {
  if (concerns(channel)) take(replayed_[channel], channel, data, size);
}

std::map<std::string, ChannelComparison> Comparison::result() const {
  std::map<std::string, ChannelComparison> result;
  for (const auto& [channel, hashes] : replayed_)
    result[channel].replayed = static_cast<std::int64_t>(hashes.size());
  for (const auto& [channel, hashes] : recorded_) {
    ChannelComparison& one = result[channel];
    one.recorded = static_cast<std::int64_t>(hashes.size());
    const auto replayed = replayed_.find(channel);
    if (replayed == replayed_.end()) continue;
    for (const auto& [utime, hash] : hashes) {
      const auto same = replayed->second.find(utime);
      if (same == replayed->second.end()) continue;
      ++one.common;
      if (same->second.value() == hash.value()) {
        ++one.equal;
      } else if (one.first_difference < 0) {
        one.first_difference = utime;
      }
    }
  }
  return result;
}

ReplayResult replay(const config::Node& configuration, const ReplayOptions& options) {
  bus::EventLogReader log(options.log);
  const bus::LoggedEvent* event = log.next();
  if (event == nullptr) throw std::runtime_error(options.log + ": holds no message");
  const std::int64_t first_ns = event->utime * 1000;
  Run run(configuration, options);
  const std::int64_t end_ns = options.stepped ? run.by_ticks(log, event) : run.by_time(log, event);
  ReplayResult result = run.finish(end_ns - first_ns);
  result.complaint = log.complaint();
  return result;
}

}  // namespace palpate::replay

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <map>

#include "rt/client/client.hpp"
#include "rt/daemon/daemon.hpp"
#include "tools/doctor/checks.hpp"
#include "tools/log/type_table.hpp"

namespace palpate::doctor {
namespace {

// In virtual time: the start, to which events belong, and the measured interval; the slowest
// channel publishes once a second.
constexpr double kBeginning = 1, kCounted = 2;

/// Messages on a bus, by channel.
class Listener final : public bus::MessageTap {
 public:
  struct Heard {
    const log::TypeInfo* type = nullptr;
    int messages = 0;
  };
  void note(const std::string& channel, const void* data, int size) noexcept override {
    Heard& heard = heard_[channel];
    heard.type = log::type_of(static_cast<const std::uint8_t*>(data), size);
    if (counts) ++heard.messages;
  }
  bool counts = false;
  const std::map<std::string, Heard>& heard() const { return heard_; }

 private:
  std::map<std::string, Heard> heard_;
};

const log::TypeInfo* type_of(std::int64_t fingerprint) {
  const auto& types = log::types();
  const auto found = std::find_if(types.begin(), types.end(), [fingerprint](const auto& type) {
    return type.fingerprint == fingerprint;
  });
  return found == types.end() ? nullptr : &*found;
}

Channel described(const std::string& name, const log::TypeInfo* type, const std::string& url) {
  Channel channel{name, "unknown", url, false, 0, ""};
  if (type != nullptr) {
    channel.type = type->name;
    channel.about = type->comment.substr(0, type->comment.find_first_of(".;\n"));
  }
  return channel;
}

/// One of the daemon's two buses, in memory, with a tap on all messages.
struct Line {
  std::string url;
  std::shared_ptr<bus::MemoryHub> hub = bus::make_memory_hub();
  std::unique_ptr<bus::MessageBus> bus = bus::make_memory_bus(hub);
  Listener listener;
};

void start_it(Line& control) {
  const auto operator_bus = bus::make_memory_bus(control.hub);
  client::Client(*operator_bus, *operator_bus, {}, 2).send({"start"}, 0);
}

}  // namespace

std::vector<Channel> channels_of(const std::string& path,
                                 const std::vector<std::string>& overrides) {
  const config::Node root = config::Node::load_file(path, overrides);
  const daemon::Settings settings = daemon::read_settings(root);
  // A check needs no key, and leaves no record.
  std::vector<std::string> open = overrides;
  for (const std::string key : {"access", "record"})
    if (root.has(key)) open.push_back(key + "=~");
  Line lines[2];
  lines[0].url = settings.control_url;
  lines[1].url = settings.housekeeping_url;
  daemon::Daemon daemon(config::Node::load_file(path, open), *lines[0].bus, *lines[1].bus,
                        daemon::Mode::kDeterministic, 1);
  for (Line& line : lines) {
    line.bus->set_tap(&line.listener);
    line.bus->start();
  }
  const auto period_ns = static_cast<std::int64_t>(std::llround(1e9 * settings.loop.period));
  const auto cycles = static_cast<int>(std::ceil((kBeginning + kCounted) / settings.loop.period));
  for (int i = 1; i <= cycles; ++i) {
    daemon::Now now;
    now.monotonic_ns = i * period_ns;
    now.utime = now.monotonic_ns / 1000;
    for (Line& line : lines) {
      bus::set_time(*line.hub, now.monotonic_ns);
      line.listener.counts = 1e-9 * static_cast<double>(now.monotonic_ns) > kBeginning;
    }
    if (i == 2) start_it(lines[0]);
    daemon.tick(now);
  }

  std::vector<Channel> channels, sent;
  for (Line& line : lines) {
    std::map<std::string, bool> subscribed;
    for (const bus::Subscription* subscription : line.bus->subscriptions()) {
      subscribed[subscription->channel()] = true;
      channels.push_back(
          described(subscription->channel(), type_of(subscription->fingerprint()), line.url));
      channels.back().is_heard = true;
    }
    for (const auto& [name, heard] : line.listener.heard()) {
      if (subscribed.count(name) != 0) continue;  // messages that were received, not published
      sent.push_back(described(name, heard.type, line.url));
      sent.back().rate = heard.messages / kCounted;
    }
  }
  channels.insert(channels.end(), sent.begin(), sent.end());
  return channels;
}

void print(const std::vector<Channel>& channels, std::ostream& out) {
  for (const bool is_heard : {true, false}) {
    out << (is_heard ? "palpated receives\n" : "palpated publishes\n");
    for (const Channel& channel : channels) {
      if (channel.is_heard != is_heard) continue;
      out << "  " << std::left << std::setw(24) << channel.name << std::setw(26) << channel.type;
      if (is_heard) {
        out << std::setw(9) << "";
      } else if (channel.rate == 0) {
        out << "on change";
      } else {
        out << std::right << std::setw(6) << std::lround(channel.rate) << " Hz";
      }
      out << "  " << channel.url << "\n";
    }
  }
}

nlohmann::json to_json(const std::vector<Channel>& channels) {
  nlohmann::json list = nlohmann::json::array();
  for (const Channel& channel : channels) {
    list.push_back({{"channel", channel.name},
                    {"type", channel.type},
                    {"url", channel.url},
                    {"direction", channel.is_heard ? "received" : "published"},
                    {"about", channel.about}});
    list.back()["rate_hz"] =
        channel.is_heard ? nlohmann::json(nullptr) : nlohmann::json(channel.rate);
  }
  return {{"channels", list}};
}

}  // namespace palpate::doctor

#include "tools/record/listener.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <optional>
#include <stdexcept>

#include "rt/bus/authentication.hpp"
#include "rt/bus/fragments.hpp"
#include "rt/config/command_line.hpp"
#include "rt/loop/fixed_rate_loop.hpp"
#include "rt/loop/real_time.hpp"

namespace palpate::record {
namespace {

constexpr std::size_t kMostKnown = 4096;  // names; a sender of random names must not exhaust memory

std::regex compiled(const std::string& pattern) {
  try {
    return std::regex(pattern, std::regex::ECMAScript | std::regex::optimize);
  } catch (const std::regex_error& error) {
    throw std::invalid_argument("\"" + pattern + "\" is no regular expression: " + error.what());
  }
}

constexpr int kDatagramsAtOnce = 64;                 // of one URL before the others are served
constexpr std::int64_t kLongestEnd = 2'000'000'000;  // ns

bool is_printable(std::string_view name) {
  return std::all_of(name.begin(), name.end(), [](char c) { return c > 32 && c < 127; });
}

}  // namespace

ChannelFilter::ChannelFilter(const std::string& pattern, bool invert)
    : pattern_(compiled(pattern)), all_(pattern == ".*"), invert_(invert) {}

bool ChannelFilter::wants(std::string_view channel) {
  if (all_) return !invert_;
  std::string name(channel);
  const auto found = known_.find(name);
  if (found != known_.end()) return found->second;
  const bool wanted = std::regex_match(name, pattern_) != invert_;
  if (known_.size() < kMostKnown) known_.emplace(std::move(name), wanted);
  return wanted;
}

struct Listener::Group {
  bus::UdpmSocket socket;
  bus::DatagramCounters counters;
  std::optional<bus::FragmentAssembler> fragments;
};

std::vector<Source> default_sources() {
  return {{"control", bus::parse_udpm_url("udpm://239.255.76.67:7667?ttl=0")},
          {"housekeeping", bus::parse_udpm_url("udpm://239.255.76.68:7668?ttl=0")},
          {"pictures", bus::parse_udpm_url("udpm://239.255.76.69:7669?ttl=0")}};
}

void put_urls(const std::vector<std::string>& texts, std::vector<Source>& sources) {
  for (const std::string& text : texts) {
    const config::LabelledUrl given = config::labelled_url(text);
    const std::string& label = given.label;
    const bool is_label =
        !label.empty() &&
        label.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == std::string::npos;
    if (!is_label) {
      throw std::invalid_argument(
          "URL \"" + text +
          "\" must read [LABEL=]udpm://..., with a label of a-z, 0-9 and _, "
          "e.g. control=udpm://239.255.76.67:7667?ttl=0");
    }
    const bus::UdpmUrl url = bus::parse_udpm_url(given.url);
    const auto same = std::find_if(sources.begin(), sources.end(),
                                   [&](const Source& one) { return one.label == label; });
    if (same == sources.end()) {
      sources.push_back({label, url});
    } else {
      same->url = url;
    }
  }
}

void add_url_option(CLI::App& app, std::vector<std::string>& urls) {
  app.add_option(
         "--url", urls,
         "LCM URL of control, housekeeping or pictures in place of the default, or of a further "
         "label (repeatable; without a label: control)")
      ->type_name("[LABEL=]URL")
      ->allow_extra_args(false);
}

Listener::Listener(std::vector<Source> sources, Handler handler, int largest)
    : sources_(std::move(sources)),
      handler_(std::move(handler)),
      wall_us_(bus::wall_clock_us()),
      monotonic_ns_(loop::monotonic_ns()) {
  for (const Source& source : sources_) {
    groups_.push_back(std::make_unique<Group>());
    groups_.back()->socket.open(source.url);
    if (largest > 0) groups_.back()->fragments.emplace(largest);
  }
  wake_ = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (wake_ < 0) throw std::runtime_error(std::string("no event: ") + std::strerror(errno));
}

Listener::~Listener() {
  stop();
  if (wake_ >= 0) close(wake_);
}

void Listener::start() {
  thread_ = loop::start_helper_thread("palpate-listen", [this] {
    while (!stop_.load(std::memory_order_relaxed)) receive(-1);
    // Messages received before the stop; a flood does not delay the end.
    const std::int64_t end = loop::monotonic_ns() + kLongestEnd;
    while (receive(0) && loop::monotonic_ns() < end) {
    }
  });
}

void Listener::stop() noexcept {
  stop_.store(true);
  if (!thread_.joinable()) return;
  const std::uint64_t one = 1;
  while (write(wake_, &one, sizeof(one)) < 0 && errno == EINTR) {
  }
  thread_.join();
}

bool Listener::receive(int timeout_ms) {
  std::vector<pollfd> watched;
  for (const auto& group : groups_) watched.push_back({group->socket.descriptor(), POLLIN, 0});
  watched.push_back({wake_, POLLIN, 0});
  if (poll(watched.data(), watched.size(), timeout_ms) <= 0) return false;
  bool any = false;
  // Round-robin, so that a flood on one URL does not block the others.
  for (int source = 0; source < static_cast<int>(groups_.size()); ++source) {
    for (int i = 0; i < kDatagramsAtOnce && receive_one(source); ++i) any = true;
  }
  return any;
}

bool Listener::receive_one(int source) {
  Group& group = *groups_[static_cast<std::size_t>(source)];
  const int size = group.socket.receive(group.counters);
  if (size < 0) return false;
  handle(source, group.socket.data(), size, group.socket.sender());
  return true;
}

void Listener::handle(int source, const std::uint8_t* data, int size, std::uint64_t sender) {
  Group& group = *groups_[static_cast<std::size_t>(source)];
  bus::DatagramCounters& counters = group.counters;
  bus::UdpmFrame frame{};
  const std::int64_t now = loop::monotonic_ns();
  const bool is_message = group.fragments && bus::FragmentAssembler::is_fragment(data, size)
                              ? group.fragments->take(data, size, sender, now, counters, frame)
                              : bus::parse_udpm_frame(data, size, counters, frame);
  if (!is_message) return;
  if (!is_printable(frame.channel)) {
    counters.malformed.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  handler_({source, wall_us_ + (now - monotonic_ns_) / 1000, now, frame.channel, frame.payload,
            frame.payload_size});
}

const bus::DatagramCounters& Listener::datagrams(int source) const noexcept {
  return groups_[static_cast<std::size_t>(source)]->counters;
}

int Listener::receive_buffer_size(int source) const noexcept {
  return groups_[static_cast<std::size_t>(source)]->socket.receive_buffer_size();
}

}  // namespace palpate::record

#include "tools/top/channel_table.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace palpate::top {
namespace {

constexpr std::int64_t kWindow =
    2'000'000'000;                           // ns, averaging interval if there are enough messages
constexpr std::size_t kLeastKept = 5;        // messages, of slow channels
constexpr std::size_t kMostKept = 8192;      // of fast ones
constexpr std::size_t kMostChannels = 1024;  // a sender of random names must not exhaust memory
constexpr std::int64_t kOtherClock = 10'000'000;  // us

}  // namespace

const char* name(Order order) noexcept {
  constexpr const char* kNames[] = {"name", "rate", "bandwidth", "lost", "age"};
  return kNames[static_cast<std::size_t>(order)];
}

Order next(Order order) noexcept {
  return order == Order::kAge ? Order::kName : static_cast<Order>(static_cast<int>(order) + 1);
}

void ChannelTable::take(const record::Heard& heard) {
  std::string name(heard.channel);
  if (channels_.size() >= kMostChannels && channels_.count({heard.source, name}) == 0)
    name = "(others)";
  Channel& channel = channels_[{heard.source, name}];
  ++channel.messages;
  Arrival arrival{heard.arrival_ns, heard.size, 0, false};
  const record::Recognised message = record::recognise(heard.data, heard.size, types_);
  if (message.fits) channel.type = *message.type;
  if (message.type != nullptr && !message.fits) ++channel.misfits;
  if (message.has_header) {
    const record::MessageHeader header = record::header_of(heard.data);
    channel.gaps.take(header);
    // A difference that does not overflow for any value in a message.
    const double apart = static_cast<double>(heard.utime) - static_cast<double>(header.utime);
    arrival.has_latency = std::abs(apart) < static_cast<double>(kOtherClock);
    if (arrival.has_latency) arrival.latency_us = heard.utime - header.utime;
  }
  channel.recent.push_back(arrival);
  while (channel.recent.size() > kMostKept ||
         (channel.recent.size() > kLeastKept &&
          channel.recent.front().arrival_ns < heard.arrival_ns - kWindow))
    channel.recent.pop_front();
}

ChannelRow ChannelTable::row_of(const Channel& channel, std::int64_t now_ns) {
  ChannelRow row;
  row.type = channel.type;
  row.messages = channel.messages;
  row.misfits = channel.misfits;
  row.lost = channel.gaps.lost();
  row.senders = channel.gaps.sessions();
  const std::deque<Arrival>& recent = channel.recent;
  const Arrival& last = recent.back();
  row.age = std::max(0.0, static_cast<double>(now_ns - last.arrival_ns) * 1e-9);
  row.has_latency = last.has_latency;
  double latency = 0;
  int timed = 0;
  for (const Arrival& one : recent) {
    if (!one.has_latency) continue;
    latency += static_cast<double>(one.latency_us) * 1e-3;
    ++timed;
  }
  if (timed > 0) row.latency_ms = latency / timed;
  const auto intervals = static_cast<double>(recent.size() - 1);
  const double span = static_cast<double>(last.arrival_ns - recent.front().arrival_ns) * 1e-9;
  if (intervals < 1 || span <= 0) return row;

  double bytes = 0, squares = 0, longest = 0;
  const double mean = span / intervals;
  for (std::size_t i = 1; i < recent.size(); ++i) {
    const double interval =
        static_cast<double>(recent[i].arrival_ns - recent[i - 1].arrival_ns) * 1e-9;
    bytes += recent[i].size;
    squares += (interval - mean) * (interval - mean);
    longest = std::max(longest, interval);
  }
  row.jitter_ms = 1e3 * std::sqrt(squares / intervals);
  row.longest_ms = 1e3 * longest;
  // A channel that is silent for longer than ever before counts as stopped.
  if (row.age > std::max(static_cast<double>(kWindow) * 1e-9, 3 * longest)) return row;
  row.rate = intervals / span;
  row.bandwidth = bytes / span;
  return row;
}

std::vector<ChannelRow> ChannelTable::rows(std::int64_t now_ns, Order order) const {
  std::vector<ChannelRow> rows;
  for (const auto& [key, channel] : channels_) {
    rows.push_back(row_of(channel, now_ns));
    rows.back().source = key.first;
    rows.back().channel = key.second;
  }
  if (order == Order::kName) return rows;  // as the map has them
  const auto value = [order](const ChannelRow& row) -> double {
    return order == Order::kRate        ? row.rate
           : order == Order::kBandwidth ? row.bandwidth
           : order == Order::kLost      ? static_cast<double>(row.lost)
                                        : row.age;
  };
  std::stable_sort(rows.begin(), rows.end(), [&value](const ChannelRow& a, const ChannelRow& b) {
    return value(a) > value(b);
  });
  return rows;
}

}  // namespace palpate::top

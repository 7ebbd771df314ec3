#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "tools/record/listener.hpp"
#include "tools/record/message_types.hpp"

namespace palpate::top {

/// State of one channel at a time. Values that need more messages than received are negative.
struct ChannelRow {
  int source = 0;
  std::string channel;
  std::string type;  // empty: the fingerprint is unknown, or the message is malformed
  std::int64_t messages = 0;
  std::int64_t lost = 0;     // by the gaps in their sequence numbers
  std::int64_t misfits = 0;  // that cannot be decoded as their type
  int senders = 0;           // each start of one
  double rate = 0;           // Hz, over the last seconds; 0 if it has stopped
  double jitter_ms = -1;     // standard deviation of the intervals
  double longest_ms = -1;    // interval
  double age = 0;            // s, since the last one
  double bandwidth = 0;      // bytes/s, of the data
  double latency_ms = 0;     // from the sender's clock to here
  bool has_latency = false;  // the sender's clock and ours agree to within 10 s
};

enum class Order { kName, kRate, kBandwidth, kLost, kAge };
const char* name(Order order) noexcept;
Order next(Order order) noexcept;

/// Rates, gaps and ages of every received channel.
class ChannelTable {
 public:
  /// `types`: known besides palpate's.
  explicit ChannelTable(types::TypeSet types = {}) : types_(std::move(types)) {}

  void take(const record::Heard& heard);
  /// `now_ns`: CLOCK_MONOTONIC, as messages arrive.
  std::vector<ChannelRow> rows(std::int64_t now_ns, Order order = Order::kName) const;
  void clear() { channels_.clear(); }

 private:
  struct Arrival {
    std::int64_t arrival_ns;
    int size;
    std::int64_t latency_us;
    bool has_latency;
  };
  struct Channel {
    std::string type;
    std::int64_t messages = 0, misfits = 0;
    record::SequenceGaps gaps;
    std::deque<Arrival> recent;
  };
  static ChannelRow row_of(const Channel& channel, std::int64_t now_ns);

  types::TypeSet types_;
  std::map<std::pair<int, std::string>, Channel> channels_;
};

}  // namespace palpate::top

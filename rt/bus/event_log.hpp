#pragma once

#include <cstdint>
#include <limits>

namespace palpate::bus {

/// LCM event log: a sequence of events, each consisting of kSyncWord (4 bytes), event number (8),
/// time in us (8), lengths of channel and data (4 each), all in network order, then channel and
/// data.
inline constexpr std::uint32_t kSyncWord = 0xEDA1DA01;
inline constexpr int kEventTimeAt = 12, kChannelSizeAt = 20, kDataSizeAt = 24;
inline constexpr int kEventHeaderSize = 28;

/// Limits of a valid event: size of its data, and times >= 0, in us, that are representable in ns
/// as an int64.
inline constexpr std::int64_t kLargestEventData = std::int64_t{64} << 20;
inline constexpr std::int64_t kLatestEventTime = std::numeric_limits<std::int64_t>::max() / 1000;

}  // namespace palpate::bus

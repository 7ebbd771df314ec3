#pragma once

#include <functional>
#include <map>
#include <string>

#include "core/math/random.hpp"
#include "tools/lab/faults/stream.hpp"

namespace palpate::faults {

/// Which messages a fault touches.
using Which = std::function<bool(const bus::Published&)>;
/// Sensors' messages within the window; of one channel if it is named.
Which sensors_in(const Window& window, const std::string& channel = "");

// Faults of a message stream in transit. Each returns the stream as it arrives; all randomness
// comes from `random`, so that a seed determines the run.

/// Each selected message is lost with this probability.
Stream lose(const Stream& stream, const Which& which, double probability, math::Random& random);

/// Within the window all messages are lost for bursts of 1 ms to `longest` s, at least 60 ms apart.
Stream lose_bursts(const Stream& stream, const Window& window, double longest,
                   math::Random& random);

/// Messages of one channel overtake each other by up to `reach` places; times of arrival are
/// unchanged.
Stream reorder(const Stream& stream, const Which& which, int reach, math::Random& random);

/// The messages of a stream that a receiver may accept if it drops those older than the newest:
/// each channel's rising sequence. Independent of the receiver's own rule, as a reference for it.
Stream rising(const Stream& stream);

/// Each message arrives 2 to `most` times at once, and once more some milliseconds later.
Stream duplicate(const Stream& stream, const Which& which, int most, math::Random& random);

/// One or more values in a fraction of the messages are replaced by what `draw` returns.
Stream mutate(const Stream& stream, const Which& which, double share,
              const std::function<double(math::Random&)>& draw, math::Random& random);

/// Values that no sensor sends: not a number, infinite, or near the largest representable number.
double bad_number(math::Random& random);

/// The values of the first selected message are repeated, with new sequence numbers and times.
/// `frozen`: by channel, for a stream that comes in pieces.
Stream freeze(const Stream& stream, const Which& which,
              std::map<std::string, bus::Published>& frozen);
Stream freeze(const Stream& stream, const Which& which);

/// The senders' wall clocks are off by `offset(time_ns)` us.
Stream shift_clocks(const Stream& stream, const std::function<std::int64_t(std::int64_t)>& offset);

/// The selected messages get the fingerprint of another type.
Stream change_type(const Stream& stream, const Which& which, std::int64_t fingerprint);

/// At `at` s every sender stops and restarts after `pause` s, with a new session, sequence numbers
/// and times from zero.
Stream restart(const Stream& stream, double at, double pause, std::int64_t session);

/// The hand's pose jumps by up to `reach` m, each time for a few milliseconds.
Stream throw_about(const Stream& stream, const Window& window, double reach, math::Random& random);

}  // namespace palpate::faults

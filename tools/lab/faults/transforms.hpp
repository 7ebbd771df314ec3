#pragma once

#include <functional>
#include <map>
#include <string>

#include "core/math/random.hpp"
#include "tools/lab/faults/stream.hpp"

namespace palpate::faults {

/// Which messages a fault touches.
using Which = std::function<bool(const bus::Published&)>;
/// Sensors' messages within the window; of one channel where it is named.
Which sensors_in(const Window& window, const std::string& channel = "");

// What may happen to a stream on its way. Each gives the stream as it arrives; all that is random
// comes from `random`, so that a seed tells the run.

/// Each message of those is lost with this probability.
Stream lose(const Stream& stream, const Which& which, double probability, math::Random& random);

/// Within the window everything is lost for 1 ms to `longest` s at a time, with 60 ms and more
/// between two bursts.
Stream lose_bursts(const Stream& stream, const Window& window, double longest,
                   math::Random& random);

/// Messages of one channel overtake each other by up to `reach` places; times of arrival stay.
Stream reorder(const Stream& stream, const Which& which, int reach, math::Random& random);

/// What of a stream a receiver may take where it drops what is older than the newest: each
/// channel's rising sequence. Independent of the receiver's own rule, to judge it by.
Stream rising(const Stream& stream);

/// Each message comes 2 to `most` times at once, and once more some milliseconds later.
Stream duplicate(const Stream& stream, const Which& which, int most, math::Random& random);

/// One or more numbers of a share of the messages are replaced by what `draw` gives.
Stream mutate(const Stream& stream, const Which& which, double share,
              const std::function<double(math::Random&)>& draw, math::Random& random);

/// What no sensor says: not a number, infinite, or near the largest that there is.
double bad_number(math::Random& random);

/// The numbers of the first of them come again and again, new in order and time. `frozen`: by
/// channel, for a stream that comes in pieces.
Stream freeze(const Stream& stream, const Which& which,
              std::map<std::string, bus::Published>& frozen);
Stream freeze(const Stream& stream, const Which& which);

/// The senders' wall clocks are off by `offset(time_ns)` us.
Stream shift_clocks(const Stream& stream, const std::function<std::int64_t(std::int64_t)>& offset);

/// Those have the fingerprint of another type.
Stream change_type(const Stream& stream, const Which& which, std::int64_t fingerprint);

/// At `at` s every sender ends and starts anew after a pause of `pause` s, with another session,
/// numbers and times from zero.
Stream restart(const Stream& stream, double at, double pause, std::int64_t session);

/// The hand's pose is thrown about by up to `reach` m, each time for some milliseconds.
Stream throw_about(const Stream& stream, const Window& window, double reach, math::Random& random);

}  // namespace palpate::faults

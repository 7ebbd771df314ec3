#include "tools/lab/faults/transforms.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <palpate/channels.hpp>

namespace palpate::faults {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;

void sort_by_time(Stream& stream) {
  std::stable_sort(stream.begin(), stream.end(),
                   [](const auto& a, const auto& b) { return a.time_ns < b.time_ns; });
}

}  // namespace

Which sensors_in(const Window& window, const std::string& channel) {
  return [window, channel](const bus::Published& message) {
    return is_sensor(message.channel) && window.holds(message.time_ns) &&
           (channel.empty() || message.channel == channel);
  };
}

Stream lose(const Stream& stream, const Which& which, double probability, math::Random& random) {
  Stream result;
  for (const bus::Published& message : stream)
    if (!which(message) || random.uniform() >= probability) result.push_back(message);
  return result;
}

Stream lose_bursts(const Stream& stream, const Window& window, double longest,
                   math::Random& random) {
  Stream result = stream;
  for (double t = window.begin + random.uniform(0, 0.03); t < window.end;) {
    // Loss is visible where something arrived before: in whole milliseconds.
    const Window burst{t, std::min(window.end, t + random.uniform(1e-3, longest))};
    result = lose(result, sensors_in(burst), 1.0, random);
    t = burst.end + random.uniform(0.06, 0.12);
  }
  return result;
}

Stream reorder(const Stream& stream, const Which& which, int reach, math::Random& random) {
  Stream result = stream;
  std::map<std::string, std::vector<std::size_t>> places;
  for (std::size_t i = 0; i < stream.size(); ++i)
    if (which(stream[i])) places[stream[i].channel].push_back(i);
  for (const auto& [channel, of_channel] : places) {
    std::vector<double> key(of_channel.size());
    std::vector<std::size_t> order(of_channel.size());
    std::iota(order.begin(), order.end(), 0);
    for (std::size_t i = 0; i < key.size(); ++i)
      key[i] = static_cast<double>(i) + random.uniform(0, reach + 0.999);
    std::sort(order.begin(), order.end(), [&](auto a, auto b) { return key[a] < key[b]; });
    for (std::size_t i = 0; i < order.size(); ++i)
      result[of_channel[i]].data = stream[of_channel[order[i]]].data;
  }
  return result;
}

Stream rising(const Stream& stream) {
  Stream result;
  std::map<std::string, std::int32_t> newest;
  for (const bus::Published& message : stream) {
    const std::int32_t seq = header_of(message).seq;
    const auto [at, first] = newest.emplace(message.channel, seq);
    if (!first && seq <= at->second) continue;
    at->second = seq;
    result.push_back(message);
  }
  return result;
}

Stream duplicate(const Stream& stream, const Which& which, int most, math::Random& random) {
  Stream result;
  for (const bus::Published& message : stream) {
    result.push_back(message);
    if (!which(message)) continue;
    const int copies = 1 + static_cast<int>(random.below(most - 1));
    result.insert(result.end(), copies, message);
    bus::Published late = message;
    late.time_ns += kMillisecond * static_cast<std::int64_t>(1 + random.below(20));
    result.push_back(late);
  }
  sort_by_time(result);
  return result;
}

Stream mutate(const Stream& stream, const Which& which, double share,
              const std::function<double(math::Random&)>& draw, math::Random& random) {
  Stream result = stream;
  for (bus::Published& message : result) {
    if (!which(message) || random.uniform() >= share) continue;
    const std::vector<int> offsets = number_offsets(message);
    if (offsets.empty()) continue;
    const int count = 1 + static_cast<int>(random.below(std::min<std::size_t>(3, offsets.size())));
    for (int i = 0; i < count; ++i)
      put_number(message, offsets[random.below(offsets.size())], draw(random));
  }
  return result;
}

double bad_number(math::Random& random) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  constexpr double kBad[] = {std::numeric_limits<double>::quiet_NaN(), kInf, -kInf, 1e308, -1e308};
  return kBad[random.below(5)];
}

Stream freeze(const Stream& stream, const Which& which,
              std::map<std::string, bus::Published>& frozen) {
  Stream result = stream;
  for (bus::Published& message : result) {
    if (!which(message)) continue;
    const Header header = header_of(message);
    message.data = frozen.emplace(message.channel, message).first->second.data;
    put_header(message, header);
  }
  return result;
}

Stream freeze(const Stream& stream, const Which& which) {
  std::map<std::string, bus::Published> frozen;
  return freeze(stream, which, frozen);
}

Stream shift_clocks(const Stream& stream, const std::function<std::int64_t(std::int64_t)>& offset) {
  Stream result = stream;
  for (bus::Published& message : result) {
    if (!is_sensor(message.channel)) continue;
    Header header = header_of(message);
    header.utime += offset(message.time_ns);
    put_header(message, header);
  }
  return result;
}

Stream change_type(const Stream& stream, const Which& which, std::int64_t fingerprint) {
  Stream result = stream;
  for (bus::Published& message : result) {
    if (!which(message)) continue;
    for (int byte = 0; byte < kFingerprintSize; ++byte)
      message.data[byte] = static_cast<std::uint8_t>(fingerprint >> (8 * (7 - byte)));
  }
  return result;
}

Stream restart(const Stream& stream, double at, double pause, std::int64_t session) {
  Stream result;
  std::map<std::string, std::int32_t> seq;
  const auto start_us = static_cast<std::int64_t>((at + pause) * 1e6);
  for (bus::Published message : stream) {
    if (Window{at, at + pause}.holds(message.time_ns)) continue;
    if (message.time_ns >= static_cast<std::int64_t>((at + pause) * 1e9)) {
      Header header = header_of(message);
      header.utime -= start_us;
      header.seq = ++seq[message.channel];
      header.session = session;
      put_header(message, header);
    }
    result.push_back(message);
  }
  return result;
}

Stream throw_about(const Stream& stream, const Window& window, double reach, math::Random& random) {
  constexpr int kPositionOffset = kHeaderSize + 4 + 3 * 16 * 8;
  Stream result = stream;
  const Which robot = sensors_in(window, channel::kRobotState);
  int left = 0;
  double offset[3] = {};
  for (bus::Published& message : result) {
    if (!robot(message)) continue;
    if (left-- <= 0) {
      left = static_cast<int>(random.below(20));
      for (double& x : offset) x = random.uniform(-reach, reach);
    }
    for (int axis = 0; axis < 3; ++axis) {
      const int at = kPositionOffset + 8 * axis;
      put_number(message, at, number_at(message, at) + offset[axis]);
    }
  }
  return result;
}

}  // namespace palpate::faults

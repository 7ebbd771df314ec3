#include "tools/lab/faults/faulty_wire.hpp"

#include <algorithm>
#include <iterator>
#include <memory>
#include <palpate/channels.hpp>
#include <utility>

namespace palpate::faults {
namespace {

constexpr double kLongest = 0.8,
                 kLatest = 0.021;  // s: duration of a fault, and delay that it causes
constexpr std::int64_t kWireMillisecond = 1'000'000;
constexpr const char* kChannels[] = {channel::kFtWrench, channel::kImu, channel::kRobotState,
                                     channel::kHandState};

/// Each selected message is up to `most` ms late, so that they overtake each other.
Stream delay(Stream stream, const Which& which, int most, math::Random& random) {
  for (bus::Published& message : stream)
    if (which(message))
      message.time_ns += kWireMillisecond * static_cast<int>(random.below(most + 1));
  return stream;
}

/// One of a sensor's first three numbers is `value`.
Stream overload(Stream stream, const Which& which, int number, double value) {
  for (bus::Published& message : stream)
    if (which(message)) put_number(message, number_offsets(message)[number], value);
  return stream;
}

}  // namespace

std::string FaultyWire::put_any(double begin, math::Random& random) {
  const Window window{begin, begin + random.uniform(0.05, kLongest)};
  const Which all = sensors_in(window);
  const Which one = sensors_in(window, kChannels[random.below(std::size(kChannels))]);
  const Which wrench = sensors_in(window, channel::kFtWrench);
  // The faults outlive this call, and draw random numbers as messages pass.
  const auto draws = std::make_shared<math::Random>(random.next());
  const double share = random.uniform(0.02, 1);
  const auto number = static_cast<int>(random.below(64));
  const double sign = number % 2 == 0 ? 1 : -1;
  const std::pair<const char*, Change> choices[] = {
      {"messages lost", [=](const Stream& s) { return lose(s, all, 0.6 * share, *draws); }},
      {"a sensor is silent", [=](const Stream& s) { return lose(s, one, 1, *draws); }},
      {"out of order", [=](const Stream& s) { return delay(s, all, 1 + number % 16, *draws); }},
      {"doubled", [=](const Stream& s) { return duplicate(s, all, 2 + number, *draws); }},
      {"bad numbers", [=](const Stream& s) { return mutate(s, all, share, bad_number, *draws); }},
      {"full scale", [=](const Stream& s) { return overload(s, wrench, number % 3, sign * 660); }},
      {"a sensor repeats itself",
       [one, frozen = std::make_shared<std::map<std::string, bus::Published>>()](const Stream& s) {
         return freeze(s, one, *frozen);
       }},
      {"of another type", [=](const Stream& s) { return change_type(s, one, 0x1234 + number); }},
      {"the senders' clocks jump",
       [=](const Stream& s) {
         return shift_clocks(s, [=](std::int64_t time_ns) {
           return window.holds(time_ns) ? static_cast<std::int64_t>(sign * share * 3.6e9) : 0;
         });
       }},
  };
  const auto& [name, change] = choices[random.below(std::size(choices))];
  faults_.push_back({window.end, change});
  end_ = std::max(end_, window.end + kLatest);
  return name;
}

Stream FaultyWire::pass(Stream sent, std::int64_t now_ns) {
  const double now = 1e-9 * static_cast<double>(now_ns);
  faults_.erase(std::remove_if(faults_.begin(), faults_.end(),
                               [now](const Fault& fault) { return now > fault.end; }),
                faults_.end());
  for (const Fault& fault : faults_) sent = fault.change(sent);
  under_way_.insert(under_way_.end(), std::make_move_iterator(sent.begin()),
                    std::make_move_iterator(sent.end()));
  const auto later =
      std::stable_partition(under_way_.begin(), under_way_.end(),
                            [now_ns](const bus::Published& m) { return m.time_ns <= now_ns; });
  Stream arrived(std::make_move_iterator(under_way_.begin()), std::make_move_iterator(later));
  under_way_.erase(under_way_.begin(), later);
  return arrived;
}

}  // namespace palpate::faults

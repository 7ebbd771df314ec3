#include "tools/collect/hand.hpp"

#include <palpate/biotac_t.hpp>
#include <palpate/channels.hpp>
#include <palpate/ft_wrench_t.hpp>
#include <palpate/hand_command_t.hpp>

#include <chrono>
#include <stdexcept>

#include "rt/bus/session.hpp"
#include "tools/common/interruption.hpp"
#include "tools/common/progress.hpp"
#include "tools/log/event_log.hpp"

namespace palpate::collect {
namespace {

constexpr double kRepeat = 0.5;  // s, repetition period of commands: one may be lost
constexpr std::int64_t kPatience = 10 * 1000 * 1000;  // ns, for messages

template <class Clock>
std::int64_t now_us() {
  return std::chrono::duration_cast<std::chrono::microseconds>(Clock::now().time_since_epoch())
      .count();
}

class Hand {
 public:
  Hand(bus::MessageBus& bus, int finger, const std::filesystem::path& log,
       const std::optional<bus::Key>& key)
      : bus_(bus),
        channel_("BIOTAC_" + std::to_string(finger)),
        touches_(bus, channel_, 64),
        wrenches_(bus, channel::kFtWrench, 512),
        commands_(bus, channel::kHandCommand),
        sealer_(channel::kHandCommand, {key, bus::wall_clock_us()}),
        log_(log) {
    bus.start_without_thread();
  }
  ~Hand() { command(hand_command_t::OPEN, 0); }
  Hand(const Hand&) = delete;
  Hand& operator=(const Hand&) = delete;

  void mark(int trial, const std::string& name) {
    component_event_t event = log::trial_event(trial, name);
    marks_.put(event, now_us<std::chrono::system_clock>());
    log_.write(channel::kComponentEvent, event.utime, event);
  }

  /// Requests an action for this long, while recording.
  void keep(int action, double force, double seconds) {
    const std::int64_t begin = now_us<std::chrono::steady_clock>();
    std::int64_t next = begin;
    for (std::int64_t now = begin; now < begin + static_cast<std::int64_t>(1e6 * seconds);
         now = now_us<std::chrono::steady_clock>()) {
      common::throw_if_interrupted();
      if (now >= next) {
        command(action, force);
        next += static_cast<std::int64_t>(1e6 * kRepeat);
      }
      bus_.receive(kPatience);
      record();
    }
  }

  const HandCount& count() const { return count_; }

 private:
  void command(int action, double force) noexcept {
    hand_command_t message{};
    stamp_.put(message, now_us<std::chrono::system_clock>());
    message.action = action;
    message.force = force;
    sealer_.put(message, message.utime);
    commands_.publish(message);
  }

  void record() {
    std::int64_t arrival = 0;
    biotac_t touch{};
    while (touches_.take(touch, arrival)) {
      log_.write(channel_, now_us<std::chrono::system_clock>(), touch);
      ++count_.touches;
    }
    ft_wrench_t wrench{};
    while (wrenches_.take(wrench, arrival)) {
      log_.write(channel::kFtWrench, now_us<std::chrono::system_clock>(), wrench);
      ++count_.wrenches;
    }
  }

  bus::MessageBus& bus_;
  std::string channel_;
  bus::TypedSubscription<biotac_t> touches_;
  bus::TypedSubscription<ft_wrench_t> wrenches_;
  bus::TypedPublisher<hand_command_t> commands_;
  bus::MessageSigner sealer_;
  bus::HeaderStamper stamp_{bus::random_session()}, marks_{bus::random_session()};
  log::EventLog log_;
  HandCount count_;
};

}  // namespace

HandCount collect_from_hand(bus::MessageBus& bus, const HandProtocol& protocol,
                            const std::string& name, const std::filesystem::path& log,
                            const std::optional<bus::Key>& key) {
  Hand hand(bus, protocol.finger, log, key);
  common::Progress progress(1, 1, "pressing " + name);
  for (int trial = 0; trial < protocol.trials; ++trial) {
    progress.show(static_cast<double>(trial) / protocol.trials,
                  "trial " + std::to_string(trial + 1));
    const HandCount before = hand.count();
    hand.mark(trial, name);
    hand.keep(hand_command_t::OPEN, 0, protocol.rest);
    hand.keep(hand_command_t::HOLD, protocol.force, protocol.hold);
    hand.keep(hand_command_t::OPEN, 0, protocol.release);
    if (hand.count().touches == before.touches)
      throw std::runtime_error("no BIOTAC_" + std::to_string(protocol.finger) +
                               " came during a whole trial");
    if (hand.count().wrenches == before.wrenches)
      throw std::runtime_error("no FT_WRENCH came during a whole trial");
  }
  progress.finish(true, log.string());
  return hand.count();
}

}  // namespace palpate::collect

#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <palpate/component_command_t.hpp>
#include <palpate/component_event_t.hpp>
#include <palpate/feature_t.hpp>
#include <palpate/health_t.hpp>
#include <palpate/manual_force_t.hpp>
#include <palpate/shape_target_t.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "rt/bus/authentication.hpp"
#include "rt/bus/message_bus.hpp"
#include "rt/bus/session.hpp"
#include "rt/client/outgoing.hpp"
#include "rt/client/request.hpp"

namespace palpate::client {

/// unconfigured, inactive, active, degraded, faulted, finalized; "unknown" for any other number.
const char* name_of_state(const health_t& health) noexcept;

/// Answer of the daemon to a command or target.
struct Answer {
  std::string event;   // as in COMPONENT_EVENT; empty: none in time
  std::string reason;  // without an answer: what is known about why
  bool last = true;    // false: a replacement has begun, and its result follows
  bool done() const { return last && !event.empty() && event != "refused"; }
};

/// us to wait for an answer: of a command or target, and of a replacement once it has begun.
struct Patience {
  std::int64_t answer = 5'000'000;
  std::int64_t replacement = 60'000'000;
};

/// Client of a running daemon: sends commands, targets and forces, repeats what UDP may lose, and
/// receives answers, HEALTH and FEATURE. Use from one thread; `now_us` is the wall clock.
class Client {
 public:
  using OnAnswer = std::function<void(const Answer&)>;

  /// The buses must outlive the client. They need not be started for what only sends; wait() starts
  /// them. `session`: fixed in deterministic runs.
  Client(bus::MessageBus& control, bus::MessageBus& housekeeping, const bus::Access& access = {},
         std::int64_t session = bus::random_session());

  /// Sends a command once. Throws as make_command() does.
  void send(const Request& request, std::int64_t now_us);
  /// Sends a command, or the chunks of a target, and has service() repeat it until it is answered
  /// or the time is over. `on_answer` is called by service(), and must not ask. Of several pending
  /// targets only the last one is answered.
  void ask(component_command_t command, std::int64_t now_us, OnAnswer on_answer,
           Patience patience = {});
  void ask(std::vector<shape_target_t> target, std::int64_t now_us, OnAnswer on_answer,
           Patience patience = {});
  /// ask() and wait() for the final answer, at most `timeout` s.
  template <class Message>
  Answer ask_and_wait(Message message, double timeout) {
    const auto answer = std::make_shared<Answer>(Answer{"", "", false});
    const auto most = static_cast<std::int64_t>(1e6 * timeout);
    ask(std::move(message), bus::wall_clock_us(), [answer](const Answer& a) { *answer = a; },
        {most, most});
    while (!wait(timeout, [&] { return answer->last; })) {
    }
    return *answer;
  }

  /// Sends a target now, and has service() repeat it at 2 Hz until another one is set.
  void set_target(std::vector<shape_target_t> target, std::int64_t now_us);
  /// Sends the target of set_target() again, as the same revision.
  void repeat_target(std::int64_t now_us);
  std::int32_t target_revision() const { return revision_; }  // of the last target; 0: none

  /// Applies a force for 100 ms, and has service() renew it until `until_us`. `rest_point`: in O,
  /// m; `force`: in O, N.
  void apply_force(const double (&rest_point)[3], const double (&force)[3], std::int64_t now_us,
                   std::int64_t until_us = 0);

  /// Handles what has arrived and repeats what is due; call several times per second.
  void service(std::int64_t now_us);
  /// service() as messages arrive, for `seconds` or until `done` returns true, which is called
  /// after each; returns whether it did. Throws std::runtime_error if a bus cannot be started.
  bool wait(double seconds, const std::function<bool()>& done = {});

  std::size_t pending() const { return asked_.size(); }
  const std::optional<health_t>& health() const { return health_; }     // the last one
  const std::optional<feature_t>& feature() const { return feature_; }  // the last one
  /// Norm of the error of the feature to the last target: m, rad or 1/m, as the feature's; empty
  /// until the daemon follows that target.
  std::optional<double> target_error() const;
  bool is_active() const;
  bool is_running() const;  // active or degraded
  /// Number of messages of an input channel that the daemon has received.
  std::int64_t received(std::string_view channel) const;
  /// Reason of the last refusal of any command or target; empty if there was none.
  const std::string& refusal() const { return refusal_; }

 private:
  struct Asked {
    component_command_t command{};
    std::vector<shape_target_t> target;  // chunks of a target; empty: it is a command
    bool is_target() const { return !target.empty(); }
    OnAnswer on_answer;
    Patience patience;
    std::int64_t first_counter = -1, last_counter = -1;
    std::int64_t sent_us = 0, until_us = 0;
    bool replacing = false;
    std::string reason = "does palpated run, and on this control URL?";  // of no answer
  };
  void add(Asked asked, std::int64_t now_us);
  void send(Asked& asked, std::int64_t now_us);
  void publish(std::vector<shape_target_t>& target, std::int64_t now_us);
  void send_force(std::int64_t now_us);
  static bool answers(const component_event_t& event, const Asked& asked);
  void handle(const component_event_t& event, std::int64_t now_us);
  void finish(std::list<Asked>::iterator asked, const Answer& answer);

  bus::MessageBus &control_, &housekeeping_;
  bus::TypedSubscription<health_t> healths_;
  bus::TypedSubscription<component_event_t> events_;
  bus::TypedSubscription<feature_t> features_;
  Outgoing<component_command_t> commands_;
  Outgoing<shape_target_t> targets_;
  Outgoing<manual_force_t> forces_;
  std::list<Asked> asked_;
  std::vector<shape_target_t> target_;  // repeated at 2 Hz
  std::int64_t target_sent_us_ = 0;
  std::int32_t revision_ = 0;
  manual_force_t force_{};
  std::int64_t force_sent_us_ = 0, force_until_us_ = 0;
  std::optional<health_t> health_;
  std::optional<feature_t> feature_;
  std::string refusal_;
};

}  // namespace palpate::client

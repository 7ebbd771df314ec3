#include "rt/client/client.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <palpate/channels.hpp>

#include "rt/bus/text.hpp"

namespace palpate::client {
namespace {

// us, between two repetitions
constexpr std::int64_t kRepeat = 200'000, kRepeatReplacing = 1'000'000;
constexpr std::int64_t kRepeatTarget = 500'000, kRenewForce = 50'000;
constexpr std::int64_t kLongestWait = 20'000;  // us, for a message on the control bus

}  // namespace

const char* name_of_state(const health_t& health) noexcept {
  constexpr const char* kNames[] = {"unconfigured", "inactive", "active",
                                    "degraded",     "faulted",  "finalized"};
  return health.state >= 0 && health.state < static_cast<int>(std::size(kNames))
             ? kNames[health.state]
             : "unknown";
}

Client::Client(bus::MessageBus& control, bus::MessageBus& housekeeping, const bus::Access& access,
               std::int64_t session)
    : control_(control),
      housekeeping_(housekeeping),
      healths_(housekeeping, channel::kHealth, 32),
      events_(housekeeping, channel::kComponentEvent, 256),
      features_(control, channel::kFeature, 64),
      commands_(control, channel::kComponentCommand, access, session),
      targets_(control, channel::kShapeTarget, access, session),
      forces_(control, channel::kManualForce, access, session) {}

void Client::send(const Request& request, std::int64_t now_us) {
  component_command_t command = make_command(request);
  commands_.sign(command, now_us);
  commands_.publish(command);
}

void Client::ask(component_command_t command, std::int64_t now_us, OnAnswer on_answer,
                 Patience patience) {
  commands_.sign(command, now_us);
  add({command, {}, std::move(on_answer), patience}, now_us);
}

void Client::ask(std::vector<shape_target_t> target, std::int64_t now_us, OnAnswer on_answer,
                 Patience patience) {
  for (auto old = asked_.begin(); old != asked_.end();) {
    const auto next = std::next(old);
    if (old->is_target()) finish(old, {"", "replaced by a later target", true});
    old = next;
  }
  add({{}, std::move(target), std::move(on_answer), patience}, now_us);
}

void Client::add(Asked asked, std::int64_t now_us) {
  asked.until_us = now_us + asked.patience.answer;
  asked_.push_back(std::move(asked));
  send(asked_.back(), now_us);
}

void Client::send(Asked& asked, std::int64_t now_us) {
  asked.sent_us = now_us;
  if (asked.is_target()) {
    // The daemon does not answer a repeated target: a new revision of it is answered, with the
    // counter of the chunk that completed it.
    ++revision_;
    publish(asked.target, now_us);
    asked.last_counter = asked.target.back().counter;
    if (asked.first_counter < 0) asked.first_counter = asked.target.front().counter;
  } else {
    // Identical in each repetition, so that the daemon recognises it.
    asked.last_counter = asked.command.counter;
    if (asked.first_counter < 0) asked.first_counter = asked.last_counter;
    commands_.publish(asked.command);
  }
}

void Client::publish(std::vector<shape_target_t>& target, std::int64_t now_us) {
  for (shape_target_t& chunk : target) {
    chunk.revision = revision_;
    targets_.sign(chunk, now_us);
    targets_.publish(chunk);
  }
}

void Client::set_target(std::vector<shape_target_t> target, std::int64_t now_us) {
  target_ = std::move(target);
  ++revision_;
  repeat_target(now_us);
}

void Client::repeat_target(std::int64_t now_us) {
  target_sent_us_ = now_us;
  publish(target_, now_us);
}

void Client::apply_force(const double (&rest_point)[3], const double (&force)[3],
                         std::int64_t now_us, std::int64_t until_us) {
  std::copy_n(rest_point, 3, force_.rest_point);
  std::copy_n(force, 3, force_.force);
  force_until_us_ = until_us;
  send_force(now_us);
}

void Client::send_force(std::int64_t now_us) {
  force_sent_us_ = now_us;
  forces_.sign(force_, now_us);
  forces_.publish(force_);
}

void Client::finish(std::list<Asked>::iterator asked, const Answer& answer) {
  const OnAnswer on_answer = std::move(asked->on_answer);
  asked_.erase(asked);
  on_answer(answer);
}

/// Whether an event belongs to a command or target: their counters may coincide.
bool Client::answers(const component_event_t& event, const Asked& asked) {
  if (event.command_counter < asked.first_counter || event.command_counter > asked.last_counter)
    return false;
  const std::string_view name = bus::get_text(event.event), slot = bus::get_text(event.slot);
  return asked.is_target() ? slot == "feature" && (name == "target" || name == "refused")
                           : name != "target";
}

void Client::handle(const component_event_t& event, std::int64_t now_us) {
  const Answer answer{bus::get_text(event.event), bus::get_text(event.reason), true};
  if (answer.event == "refused") refusal_ = answer.reason;
  if (answer.event == "no_access")
    for (Asked& each : asked_) each.reason = "no_access: " + answer.reason;
  const auto asked = std::find_if(asked_.begin(), asked_.end(),
                                  [&](const Asked& each) { return answers(event, each); });
  if (asked == asked_.end()) return;
  if (answer.event == "no_access") {
    // Signed before the daemon's start, so that the daemon would never accept it: sign it again.
    if (event.command_counter == asked->last_counter) commands_.sign(asked->command, now_us);
  } else if (answer.event == "replacing") {
    if (asked->replacing) return;
    asked->replacing = true;
    asked->reason = "the replacement has begun, but its result was not received";
    asked->until_us += asked->patience.replacement - asked->patience.answer;
    asked->on_answer({answer.event, answer.reason, false});
  } else if (answer.event != "repeated" || !asked->replacing) {
    // "repeated" after another command: it was received, its answer is in transit or lost.
    finish(asked, answer);
  }
}

void Client::service(std::int64_t now_us) {
  housekeeping_.receive(0);
  control_.receive(0);
  std::int64_t arrival_ns = 0;
  for (health_t health; healths_.take(health, arrival_ns);) health_ = health;
  for (feature_t feature; features_.take(feature, arrival_ns);) feature_ = feature;
  for (component_event_t event; events_.take(event, arrival_ns);) handle(event, now_us);
  for (auto asked = asked_.begin(); asked != asked_.end();) {
    const auto next = std::next(asked);
    if (now_us >= asked->until_us)
      finish(asked, {"", "no answer: " + asked->reason, true});
    else if (now_us - asked->sent_us >= (asked->replacing ? kRepeatReplacing : kRepeat))
      send(*asked, now_us);
    asked = next;
  }
  if (!target_.empty() && now_us - target_sent_us_ >= kRepeatTarget) repeat_target(now_us);
  if (now_us < force_until_us_ && now_us - force_sent_us_ >= kRenewForce) send_force(now_us);
}

bool Client::wait(double seconds, const std::function<bool()>& done) {
  housekeeping_.start_without_thread();
  control_.start_without_thread();
  const std::int64_t end = bus::wall_clock_us() + static_cast<std::int64_t>(1e6 * seconds);
  for (;;) {
    service(bus::wall_clock_us());
    if (done && done()) return true;
    const std::int64_t left = end - bus::wall_clock_us();
    if (left <= 0) return false;
    // A running daemon publishes on the control bus in every cycle.
    control_.receive(1000 * std::min(left, kLongestWait));
  }
}

std::optional<double> Client::target_error() const {
  if (!feature_ || feature_->revision != revision_) return std::nullopt;
  const double* error = feature_->error;
  const int count = std::clamp<int>(feature_->error_count, 0, std::size(feature_->error));
  return std::sqrt(std::inner_product(error, error + count, error, 0.));
}

bool Client::is_active() const { return health_ && health_->state == health_t::STATE_ACTIVE; }

bool Client::is_running() const {
  return is_active() || (health_ && health_->state == health_t::STATE_DEGRADED);
}

std::int64_t Client::received(std::string_view channel) const {
  if (!health_) return 0;
  for (int i = 0; i < std::min<int>(health_->input_count, std::size(health_->input_name)); ++i)
    if (bus::get_text(health_->input_name[i]) == channel) return health_->received[i];
  return 0;
}

}  // namespace palpate::client

#include "rt/client/touch_call.hpp"

#include <palpate/channels.hpp>

namespace palpate::client {
namespace {

constexpr std::int64_t kRepeatTouch = 200'000;  // us

/// Positive, and unlike that of any other request of late.
std::int32_t new_number(std::int64_t now_us) {
  return 1 + static_cast<std::int32_t>((now_us / 1000) % 2'000'000'000);
}

}  // namespace

bool is_final(const touch_t& touch) noexcept {
  switch (touch.state) {
    case touch_t::WAITING:
    case touch_t::APPROACHING:
    case touch_t::RETREATING:
      return false;
    default:
      return true;
  }
}

const char* name_of_state(const touch_t& touch) noexcept {
  constexpr const char* kNames[] = {"refused", "waiting",    "approaching", "retreating",
                                    "touched", "no contact", "stopped"};
  return touch.state >= 0 && touch.state <= touch_t::STOPPED ? kNames[touch.state] : "unknown";
}

TouchCall::TouchCall(bus::MessageBus& control, const bus::Access& access, std::int64_t session)
    : control_(control),
      touches_(control, channel::kTouch, 32),
      requests_(control, channel::kTouchRequest, access, session) {}

void TouchCall::begin(const touch_request_t& request, std::int64_t now_us) {
  request_ = request;
  request_.action = touch_request_t::START;
  request_.request = new_number(now_us);
  latest_.reset();
  heard_us_ = now_us;
  send(now_us);
}

void TouchCall::cancel(std::int64_t now_us) {
  request_.action = touch_request_t::CANCEL;
  send(now_us);
}

/// Each repetition has its own counter and code, so that a daemon that has started meanwhile
/// accepts it; by its number the daemon recognises the request.
void TouchCall::send(std::int64_t now_us) {
  sent_us_ = now_us;
  requests_.sign(request_, now_us);
  requests_.publish(request_);
}

void TouchCall::service(std::int64_t now_us) {
  control_.receive(0);
  std::int64_t arrival_ns = 0;
  for (touch_t touch; touches_.take(touch, arrival_ns);) {
    if (touch.request != request_.request) continue;
    latest_ = touch;
    heard_us_ = now_us;
  }
  const bool is_answered =
      request_.action == touch_request_t::START ? latest_.has_value() : has_ended();
  if (!is_answered && now_us - sent_us_ >= kRepeatTouch) send(now_us);
}

}  // namespace palpate::client

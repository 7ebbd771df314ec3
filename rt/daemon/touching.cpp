#include "rt/daemon/touching.hpp"

#include <algorithm>
#include <palpate/channels.hpp>

#include "rt/bus/text.hpp"

namespace palpate::daemon {
namespace {

constexpr int kMostRequestsPerCycle = 4;                // bounds the work of a message flood
constexpr std::int64_t kTouchInterval = 50'000'000;     // ns
constexpr std::int64_t kTouchRepeated = 1'000'000'000;  // ns, after the end

std::int32_t state_of(control::TouchState state) noexcept {
  switch (state) {
    case control::TouchState::kWaiting:
      return touch_t::WAITING;
    case control::TouchState::kApproaching:
      return touch_t::APPROACHING;
    case control::TouchState::kRetreating:
      return touch_t::RETREATING;
    case control::TouchState::kTouched:
      return touch_t::TOUCHED;
    case control::TouchState::kNoContact:
      return touch_t::NO_CONTACT;
    case control::TouchState::kIdle:
    case control::TouchState::kStopped:
      break;
  }
  return touch_t::STOPPED;
}

bool is_final(std::int32_t state) noexcept {
  return state == touch_t::TOUCHED || state == touch_t::NO_CONTACT || state == touch_t::STOPPED;
}

}  // namespace

Touching::Touching(bus::MessageBus& control, std::int64_t session, const bus::Access& access)
    : requests_(control, channel::kTouchRequest, 8),
      admission_(channel::kTouchRequest, access),
      publisher_(control, channel::kTouch, session, bus::Urgency::kLater) {}

void Touching::handle(pipeline::Pipeline& pipeline, std::int64_t utime) noexcept {
  std::int64_t arrival_ns = 0;
  for (int i = 0; i < kMostRequestsPerCycle && requests_.take(request_, arrival_ns); ++i) {
    if (admission_.judge(request_) == bus::Admitted::kRejected) continue;
    if (request_.request <= 0) {
      refuse("request must be a positive number", utime);
      continue;
    }
    const bool is_last = request_.session == sender_ && request_.request == message_.request;
    switch (request_.action) {
      case touch_request_t::START:
        if (is_last) {
          published_ns_ = 0;  // repeated: its acknowledgement was lost
        } else if (request_.session == refused_sender_ && request_.request == refusal_.request) {
          publisher_.publish(refusal_, utime);
        } else {
          begin(pipeline, utime);
        }
        break;
      case touch_request_t::CANCEL:
        if (is_last && !is_final(message_.state)) pipeline.cancel_touch();
        if (is_last) published_ns_ = 0;
        break;
      default:
        refuse("unknown action; known: START, CANCEL", utime);
    }
  }
}

void Touching::begin(pipeline::Pipeline& pipeline, std::int64_t utime) noexcept {
  const bool runs = message_.request != 0 && !is_final(message_.state);
  if (runs) return refuse("another guarded motion is running", utime);
  control::TouchRequest wanted;
  wanted.direction_W = Eigen::Map<const Eigen::Vector3d>(request_.direction);
  wanted.force = request_.force;
  wanted.speed = request_.speed;
  wanted.distance = request_.distance;
  wanted.retreat = request_.retreat;
  const char* reason = pipeline.begin_touch(wanted);
  if (*reason != '\0') return refuse(reason, utime);
  sender_ = request_.session;
  message_.request = request_.request;
  ended_ns_ = 0;
  published_ns_ = 0;
  put(pipeline.touch_report());
}

void Touching::refuse(const char* reason, std::int64_t utime) noexcept {
  refusal_ = touch_t{};
  refused_sender_ = request_.session;
  refusal_.request = request_.request;
  refusal_.state = touch_t::REFUSED;
  refusal_.point_deviation = refusal_.stiffness = refusal_.stiffness_deviation =
      refusal_.indentation = -1;
  bus::put_text(refusal_.reason, reason);
  publisher_.publish(refusal_, utime);
}

void Touching::put(const control::TouchReport* report) noexcept {
  if (report == nullptr) {
    message_.state = touch_t::STOPPED;
    bus::put_text(message_.reason, "the control law was replaced");
    return;
  }
  message_.state = state_of(report->state);
  message_.travel = report->travel;
  message_.force = report->force;
  std::copy_n(report->point_W.data(), 3, message_.point);
  std::copy_n(report->centre_W.data(), 3, message_.centre);
  message_.point_deviation = report->point_deviation;
  message_.stiffness = report->stiffness;
  message_.stiffness_deviation = report->stiffness_deviation;
  message_.indentation = report->indentation;
  bus::put_text(message_.reason, report->reason.data());
  if (report->state == control::TouchState::kIdle)
    bus::put_text(message_.reason, "the control law was replaced");
}

void Touching::publish(const pipeline::Pipeline& pipeline, std::int64_t monotonic_ns,
                       std::int64_t utime) noexcept {
  if (message_.request == 0) return;
  if (ended_ns_ == 0) {
    put(pipeline.touch_report());
    if (is_final(message_.state)) {
      ended_ns_ = monotonic_ns;
      published_ns_ = 0;
    }
  }
  const bool is_asked = published_ns_ == 0;
  if (!is_asked && ended_ns_ != 0 && monotonic_ns - ended_ns_ > kTouchRepeated) return;
  if (!is_asked && monotonic_ns - published_ns_ < kTouchInterval) return;
  published_ns_ = monotonic_ns;
  publisher_.publish(message_, utime);
}

}  // namespace palpate::daemon

#include "rt/daemon/wrench_telemetry.hpp"

#include <algorithm>
#include <cmath>
#include <palpate/channels.hpp>

#include "rt/bus/text.hpp"

namespace palpate::daemon {
namespace {

void put_numbers(const math::Vector6d& v, double (&out)[6]) noexcept {
  std::copy_n(v.data(), 6, out);
}

/// A model, of a plug-in for instance, may not know the deviations of its output.
math::Vector6d known_deviation(const math::Pose& X_AS, const sensing::Contact& contact) noexcept {
  const auto is_known = [](double value) { return std::isfinite(value) && value > 0; };
  const math::Matrix6d covariance = frames::transformed_covariance(X_AS, contact.covariance);
  if (is_known(covariance.trace())) return covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  math::Vector6d deviation =
      frames::transformed_deviation(X_AS, contact.force_deviation, contact.torque_deviation);
  if (!is_known(contact.force_deviation)) {
    deviation.setConstant(-1);
  } else if (!is_known(contact.torque_deviation)) {
    deviation.tail<3>().setConstant(-1);
  }
  return deviation;
}

void put_wrench(const pipeline::WristReport& wrist, const registry::Frames& frames,
                compensated_wrench_t& message) noexcept {
  message.valid = wrist.contact != nullptr ? 1 : 0;
  math::Wrench F_S, F_G;
  math::Vector6d deviation_S = math::Vector6d::Constant(-1), deviation_G = deviation_S;
  if (const sensing::Contact* contact = wrist.contact) {
    const math::Pose X_GS = frames.X_GS();
    F_S = contact->wrench;
    F_G = math::transform(X_GS, F_S);
    deviation_S = known_deviation(math::Pose::Identity(), *contact);
    deviation_G = known_deviation(X_GS, *contact);
  }
  put_numbers(F_S.vector(), message.wrench_s);
  put_numbers(deviation_S, message.deviation_s);
  put_numbers(F_G.vector(), message.wrench_g);
  put_numbers(deviation_G, message.deviation_g);
}

}  // namespace

static_assert(static_cast<int>(Status::kOk) == compensated_wrench_t::STATUS_OK);
static_assert(static_cast<int>(Status::kDegraded) == compensated_wrench_t::STATUS_DEGRADED);
static_assert(static_cast<int>(Status::kFault) == compensated_wrench_t::STATUS_FAULT);

WrenchTelemetry::WrenchTelemetry(bus::MessageBus& control, int arms, std::int64_t session) {
  for (int arm = 0; arm < arms; ++arm)
    publishers_.emplace_back(control, channel::of_arm(channel::kWrenchCompensated, arm), session,
                             bus::Urgency::kLater);
}

void WrenchTelemetry::publish(const pipeline::Pipeline& pipeline, std::int64_t utime) noexcept {
  for (std::size_t arm = 0; arm < publishers_.size(); ++arm) {
    const auto wrist = pipeline.wrist(static_cast<int>(arm));
    if (!wrist) continue;
    // only an estimator is in doubt
    message_.status = static_cast<int>(
        wrist->result.status == Status::kDoubtful ? Status::kDegraded : wrist->result.status);
    bus::put_text(message_.reason, wrist->result.reason);
    message_.reading_utime = static_cast<std::int64_t>(std::llround(1e6 * wrist->reading_time));
    message_.age = wrist->age;
    put_wrench(*wrist, pipeline.frames(static_cast<int>(arm)), message_);
    publishers_[arm].publish(message_, utime);
  }
}

}  // namespace palpate::daemon

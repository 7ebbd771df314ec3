#include "rt/daemon/discrepancy_telemetry.hpp"

#include <algorithm>
#include <palpate/channels.hpp>
#include <type_traits>

namespace palpate::daemon {
namespace {

using estimation::Cause;

constexpr std::int32_t number_of(Cause cause) noexcept { return static_cast<std::int32_t>(cause); }

static_assert(number_of(Cause::kUnknown) == discrepancy_t::CAUSE_UNKNOWN);
static_assert(number_of(Cause::kContact) == discrepancy_t::CAUSE_CONTACT);
static_assert(number_of(Cause::kSlip) == discrepancy_t::CAUSE_SLIP);
static_assert(number_of(Cause::kClampPlace) == discrepancy_t::CAUSE_CLAMP_PLACE);
static_assert(number_of(Cause::kClampCompliance) == discrepancy_t::CAUSE_CLAMP_COMPLIANCE);
static_assert(number_of(Cause::kUnevenStiffness) == discrepancy_t::CAUSE_UNEVEN_STIFFNESS);
static_assert(number_of(Cause::kWeight) == discrepancy_t::CAUSE_WEIGHT);
static_assert(number_of(Cause::kSensorBias) == discrepancy_t::CAUSE_SENSOR_BIAS);
static_assert(estimation::kCauses == std::extent_v<decltype(discrepancy_t::cause)>);

}  // namespace

DiscrepancyTelemetry::DiscrepancyTelemetry(bus::MessageBus& control, std::int64_t session)
    : stamp_(session), publisher_(control, channel::kDiscrepancy, bus::Urgency::kLater) {}

void DiscrepancyTelemetry::publish(const estimation::DiscrepancyReport* report, int grasp_count,
                                   std::int64_t utime) noexcept {
  if (report == nullptr || report->tests == published_) return;
  published_ = report->tests;
  stamp_.put(message_, utime);
  message_.inconsistent = report->is_inconsistent ? 1 : 0;
  message_.duration = report->time;
  message_.test = report->test;
  message_.threshold = report->threshold;
  message_.hand = report->hand;
  message_.axis = report->axis;
  message_.grasp_count = grasp_count;
  for (std::size_t g = 0; g < report->difference.size(); ++g) {
    std::copy_n(report->difference[g].data(), 6, message_.difference[g]);
    std::copy_n(report->deviation[g].data(), 6, message_.deviation[g]);
  }
  put_explanations(*report);
  message_.adopted = number_of(report->adopted);
  publisher_.publish(message_);
}

void DiscrepancyTelemetry::put_explanations(const estimation::DiscrepancyReport& report) noexcept {
  message_.cause_count = std::clamp(report.count, 0, estimation::kCauses);
  const estimation::Explanation none;
  for (int i = 0; i < estimation::kCauses; ++i) {
    const bool is_ranked = i < message_.cause_count;
    const estimation::Explanation& one =
        is_ranked ? report.explanations[static_cast<std::size_t>(i)] : none;
    message_.cause[i] = number_of(one.cause);
    message_.probability[i] = one.probability;
    message_.cause_hand[i] = one.hand;
    std::copy_n(one.location_O.data(), 3, message_.location[i]);
    std::copy_n(one.value.data(), 6, message_.value[i]);
  }
}

}  // namespace palpate::daemon

#include "core/estimation/consistency/cause_hypothesis.hpp"

#include <cmath>

namespace palpate::estimation {
namespace {

// Prior standard deviations.
constexpr double kSlip = 0.01, kSlipAngle = 0.1;     // m, rad
constexpr double kPlace = 0.01, kPlaceAngle = 0.05;  // m, rad
constexpr double kCompliance = 0.5;                  // of the object's own compliance
constexpr double kUneven = 0.7;                      // 1
constexpr double kWeightScale = 3;  // of the force of the discrepancy, which a hand bears in part
constexpr double kLeastForce = 0.05, kLeastTorque = 0.005;  // N, N m
/// Changes of an unknown force, relative to the measured changes of the wrenches.
constexpr double kFollows = 1.5;
constexpr double kSideways = 0.4;  // of a contact's force, relative to its normal component
// What begins with the discrepancy may still grow in so many records.
constexpr int kOnsetRecords = 5;
/// Error of the response to a cause: it is linearised about a shape that is not the true one.
constexpr double kResponseError = 0.05;
/// Part of the wrench of a contact that its place does not explain, because it acts between the
/// places and over an area: changes relative to the measured changes of the wrenches.
constexpr double kPlaceError = 0.25;
constexpr int kContactForce = 3;  // number of states of a contact's force

/// Logarithm of the probability of a positive value, times 2, that is zero for an unknown sign.
double log_positive(double mean, double variance) noexcept {
  constexpr double kLeast = 1e-12;
  const double z = mean / std::sqrt(std::max(variance, 1e-300));
  return std::log(std::max(kLeast, std::erfc(-z / std::sqrt(2.0))));
}

Eigen::Matrix3d pressing(const Eigen::Vector3d& inward, double force) noexcept {
  const Eigen::Matrix3d along = inward * inward.transpose();
  return force * force * (along + kSideways * kSideways * (Eigen::Matrix3d::Identity() - along));
}

}  // namespace

int CauseHypothesis::state_count() const noexcept {
  if (!has_states_) return 0;
  switch (cause_) {
    case Cause::kUnknown:
      return 6 * knowledge_.states().grasps;
    case Cause::kContact:
      return kContactForce + 6 * knowledge_.states().grasps;
    case Cause::kWeight:
      return 1;
    case Cause::kClampCompliance:
    case Cause::kUnevenStiffness:
      return 2;
    case Cause::kSlip:
    case Cause::kClampPlace:
    case Cause::kSensorBias:
      break;
  }
  return 6;
}

void CauseHypothesis::begin(const WrenchKnowledge& before, const Eigen::Vector2d& own_compliance,
                            const math::Vector6d& difference) noexcept {
  const double force = std::max(kLeastForce, difference.head<3>().norm()),
               torque = std::max(kLeastTorque, difference.tail<3>().norm());
  WrenchKnowledge::Vector prior = WrenchKnowledge::Vector::Zero(state_count());
  const auto six = [&prior](double linear, double angular) {
    prior << Eigen::Vector3d::Constant(linear), Eigen::Vector3d::Constant(angular);
  };
  switch (cause_) {
    case Cause::kUnknown:
      break;  // zero before it begins
    case Cause::kContact:
      prior.head<kContactForce>().setConstant(kLeastForce);
      break;
    case Cause::kWeight:
      prior.setConstant(kWeightScale * force);
      break;
    case Cause::kClampCompliance:
      prior = kCompliance * own_compliance;
      break;
    case Cause::kUnevenStiffness:
      prior.setConstant(kUneven);
      break;
    case Cause::kSlip:
      six(kSlip, kSlipAngle);
      break;
    case Cause::kClampPlace:
      six(kPlace, kPlaceAngle);
      break;
    case Cause::kSensorBias:
      six(kFollows * force, kFollows * torque);
      break;
  }
  knowledge_ = before;
  misfit_ = 0;
  if (!has_states_) return;
  prior_ = prior.cwiseAbs2();
  records_ = 0;
  knowledge_.append(WrenchKnowledge::Matrix(prior.cwiseAbs2().asDiagonal()));
}

/// Dependence of the wrench of a hand on the states of the cause.
WrenchKnowledge::Appended CauseHypothesis::rows(int hand,
                                                const CauseRecord& record) const noexcept {
  const HandRecord& known = record.hands[hand];
  const CauseResponses::Hand& responses = record.responses[hand];
  const WrenchStates states = knowledge_.states();
  WrenchKnowledge::Appended own = WrenchKnowledge::Appended::Zero(6, state_count());
  if (!has_states_) return own;
  switch (cause_) {
    case Cause::kUnknown:
      own.middleCols<6>(6 * hand).setIdentity();
      break;
    case Cause::kContact:
      own.leftCols<kContactForce>() = responses.force[place_];
      own.middleCols<6>(kContactForce + 6 * hand).setIdentity();
      break;
    case Cause::kWeight:
      own = responses.force[place_] * record.gravity;
      break;
    case Cause::kClampCompliance:
      own = responses.clamp_compliance;
      break;
    case Cause::kUnevenStiffness:
      own = responses.uneven_stiffness;
      break;
    case Cause::kSlip:
      own = known.H.middleCols<6>(states.offset(hand_));
      break;
    case Cause::kClampPlace:
      own = responses.clamp_place;
      break;
    case Cause::kSensorBias:
      own = known.H.middleCols<6>(states.bias(hand_));
      break;
  }
  return own;
}

/// Forces that follow the motion of the hands change as fast as the measured wrenches. A slip, a
/// bias or a weight may still grow shortly after the report.
void CauseHypothesis::diffuse(const CauseRecord& record) noexcept {
  if (cause_ == Cause::kContact) {
    double change = 0;
    for (int g = 0; g < knowledge_.states().grasps; ++g)
      if (record.hands[g].valid) change = std::max(change, record.change[g].head<3>().norm());
    knowledge_.diffuse(0, pressing(record.inward[place_], kFollows * change));
  }
  const bool begins =
      cause_ == Cause::kSlip || cause_ == Cause::kSensorBias || cause_ == Cause::kWeight;
  if (begins && ++records_ <= kOnsetRecords) {
    double change = 0, difference = 0;
    for (int g = 0; g < knowledge_.states().grasps; ++g) {
      change += record.change[g].head<3>().squaredNorm();
      difference += record.difference[g].head<3>().squaredNorm();
    }
    const double share = std::min(1.0, change / std::max(difference, kLeastForce * kLeastForce));
    knowledge_.diffuse(0, WrenchKnowledge::Matrix((share * prior_).asDiagonal()));
  }
  const bool is_contact = cause_ == Cause::kContact;
  if (!has_states_ || (cause_ != Cause::kUnknown && !is_contact)) return;
  const double follows = is_contact ? kPlaceError : kFollows;
  const int first = is_contact ? kContactForce : 0;
  for (int g = 0; g < knowledge_.states().grasps; ++g) {
    if (!record.hands[g].valid) continue;
    math::Vector6d change;
    change << Eigen::Vector3d::Constant(follows * record.change[g].head<3>().norm()),
        Eigen::Vector3d::Constant(follows * record.change[g].tail<3>().norm());
    knowledge_.diffuse(first + 6 * g, WrenchKnowledge::Matrix(change.cwiseAbs2().asDiagonal()));
  }
}

double CauseHypothesis::take(const CauseRecord& record) noexcept {
  knowledge_.advance(record.hands);
  diffuse(record);
  double log_likelihood = 0, misfit = 0;
  int hands = 0;
  for (int g = 0; g < knowledge_.states().grasps; ++g) {
    const HandRecord& hand = record.hands[g];
    if (!hand.valid) continue;
    math::Matrix6d R = hand.R;
    const double force = kResponseError * record.difference[g].head<3>().norm(),
                 torque = kResponseError * record.difference[g].tail<3>().norm();
    R.diagonal().head<3>().array() += force * force;
    R.diagonal().tail<3>().array() += torque * torque;
    R *= kMotionErrors / kRecordPeriod;
    const WrenchKnowledge::Appended own = rows(g, record);
    const WrenchKnowledge::Comparison found = knowledge_.compare(hand, own, R);
    if (!found.valid) continue;
    knowledge_.correct(hand, own, R);
    log_likelihood += found.log_likelihood;
    misfit += found.squared / kHandRows;
    ++hands;
  }
  if (hands > 0) misfit_ += kRecordPeriod * (misfit / hands - misfit_);
  return log_likelihood;
}

math::Vector6d CauseHypothesis::value() const noexcept {
  math::Vector6d value = math::Vector6d::Zero();
  const int first = knowledge_.states().count(),
            count = cause_ == Cause::kContact ? kContactForce : std::min(6, state_count());
  value.head(count) = knowledge_.mean().segment(first, count);
  return value;
}

double CauseHypothesis::relative_size() const noexcept {
  const auto own = knowledge_.mean().tail(state_count());
  return own.cwiseAbs2().cwiseQuotient(prior_).cwiseSqrt().maxCoeff();
}

double CauseHypothesis::log_possible(const CauseRecord& record) const noexcept {
  const int first = knowledge_.states().count();
  const WrenchKnowledge::Vector& mean = knowledge_.mean();
  const WrenchKnowledge::Matrix& P = knowledge_.covariance();
  if (cause_ == Cause::kContact) {
    const Eigen::Vector3d& n = record.inward[place_];
    return log_positive(n.dot(mean.segment<3>(first)), n.dot(P.block<3, 3>(first, first) * n));
  }
  if (cause_ == Cause::kWeight) return log_positive(mean[first], P(first, first));
  if (cause_ != Cause::kClampCompliance) return 0;
  return log_positive(mean[first], P(first, first)) +
         log_positive(mean[first + 1], P(first + 1, first + 1));
}

WrenchKnowledge CauseHypothesis::absorbed() const noexcept {
  const WrenchStates states = knowledge_.states();
  const int into = cause_ == Cause::kSlip ? states.offset(hand_) : states.bias(hand_);
  WrenchKnowledge result = knowledge_.folded(into);
  if (cause_ != Cause::kSlip) return result;
  // The hand holds other material now.
  for (const int first :
       {states.stiffness(hand_), states.pose_error(hand_), states.wrench_error(hand_)})
    result.forget(first);
  return result;
}

}  // namespace palpate::estimation

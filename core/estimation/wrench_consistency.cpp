#include "core/estimation/wrench_consistency.hpp"

#include <Eigen/Cholesky>

#include "core/math/option_check.hpp"

namespace palpate::estimation {
namespace {

constexpr double kPeriod = 0.05;         // s, between two tests
constexpr double kSnapshotPeriod = 0.5;  // s
/// Ages of the knowledge that is tested, in snapshots.
constexpr std::array<int, 4> kAges{1, 2, 4, 8};
/// Tests whose results are nearly independent: one a second for each age and the prior.
constexpr double kTestsPerHour = 3600.0 * (kAges.size() + 1);
constexpr int kConsecutive = 2;        // tests beyond the threshold that begin a discrepancy
constexpr double kEnded = 0.5;         // fraction of the threshold below which it ends
constexpr double kEndsAfter = 0.3;     // s
constexpr double kForgotten = 1e3;     // decorrelation lengths that no knowledge of errors survives
constexpr double kMotionErrors = 0.3;  // s, correlation time of the errors of a moving hand

/// Value that a chi-square variable with 6 degrees of freedom exceeds with this probability.
double chi_square_6(double probability) {
  double below = 0, above = 200;
  for (int i = 0; i < 60; ++i) {
    const double x = 0.5 * (below + above);
    const bool is_below = std::exp(-x / 2) * (1 + x / 2 + x * x / 8) > probability;
    (is_below ? below : above) = x;
  }
  return above;
}

}  // namespace

WrenchConsistency::WrenchConsistency(const elasticity::Body& body, const WrenchSampling& sampling,
                                     const WrenchFilter::Options& priors, const Options& options)
    : grasps_(static_cast<int>(body.grasps.size())), sampling_(sampling), options_(options) {
  math::check_not_negative(options.dimensions, "dimensions");
  math::check_not_negative(options.poisson, "poisson");
  math::check_not_negative(options.density, "density");
  math::check_not_negative(options.pose_error, "pose_error");
  math::check_positive_finite(options.false_alarms, "false_alarms");
  const Eigen::Vector3d middle = body.mesh.nodes.rowwise().mean();
  for (std::size_t g = 0; g < body.grasps.size(); ++g)
    lever_[g] = (body.grasps[g].X_OG_rest.translation() - middle).norm();
  const Eigen::Vector3d size =
      body.mesh.nodes.rowwise().maxCoeff() - body.mesh.nodes.rowwise().minCoeff();
  const double position = std::hypot(priors.position, options.dimensions * size.maxCoeff());
  threshold_ = chi_square_6(options.false_alarms / kTestsPerHour) / kHandRows;

  const int states = error(grasps_);
  prior_.mean = Vector::Zero(states);
  Vector deviations = Vector::Zero(states);
  for (int g = 0; g < grasps_; ++g) {
    deviations.segment<3>(6 * g).setConstant(position);
    deviations.segment<3>(6 * g + 3).setConstant(priors.rotation);
    deviations.segment<3>(bias(g)).setConstant(priors.bias_force);
    deviations.segment<3>(bias(g) + 3).setConstant(priors.bias_torque);
  }
  deviations.segment<3>(material()) << priors.log_young, options.poisson, options.density;
  prior_.covariance = deviations.cwiseAbs2().asDiagonal();
  prior_.travel.fill(-kForgotten);
  snapshots_.fill(prior_);
  for (HandData& hand : hands_) hand.H = Rows::Zero(6, states);
  reset();
}

void WrenchConsistency::reset() noexcept {
  now_ = prior_;
  newest_ = snapshot_count_ = updates_ = sum_count_ = 0;
  travel_.fill(0);
  for (math::Vector6d& sum : sums_) sum.setZero();
  for (HandData& hand : hands_) hand.valid = false;
  discrepancy_ = Discrepancy();
  is_inconsistent_ = has_just_begun_ = false;
  snapshots_back_ = exceeded_ = passed_ = 0;
}

bool WrenchConsistency::take(const Innovation& now, const FusedState& state,
                             const elasticity::DeformationModel& model, bool learn) noexcept {
  has_just_begun_ = false;
  linearise(now, state, model);
  if (++sum_count_ < sampling_.updates_in(kPeriod)) return false;
  for (int g = 0; g < grasps_; ++g) {
    hands_[g].y = sums_[g] / sum_count_;
    sums_[g].setZero();
  }
  sum_count_ = 0;
  judge();
  if (is_inconsistent_ || !learn) return false;
  learn_from_wrenches();
  constexpr int kUpdates = static_cast<int>(kSnapshotPeriod / kPeriod);
  if (++updates_ % kUpdates != 0) return false;
  newest_ = (newest_ + 1) % kSnapshots;
  snapshots_[newest_] = now_;
  snapshot_count_ = std::min(snapshot_count_ + 1, kSnapshots);
  return true;
}

/// Wrench difference of each hand for the nominal parameters, and its dependence on the states.
void WrenchConsistency::linearise(const Innovation& now, const FusedState& state,
                                  const elasticity::DeformationModel& model) noexcept {
  const WrenchFilter& filter = state.filter;
  const elasticity::Sensitivity& sensitivity = model.sensitivity();
  const int offsets = 6 * grasps_;
  for (int g = 0, row = 0; g < grasps_; ++g) {
    HandData& hand = hands_[g];
    travel_[g] += now.travel[g];
    hand.valid = now.held[g];
    if (!hand.valid) continue;
    const auto rows = now.H.middleRows<6>(row);
    hand.H.setZero();
    hand.H.leftCols(offsets) = rows.leftCols(offsets);
    hand.H.middleCols<6>(bias(g)) = rows.middleCols<6>(filter.bias(g));
    hand.H.col(material()) = rows.col(filter.log_young());
    const auto felt = state.motion.felt().block<6, 12>(6 * g, 0);
    for (int other = 0; other < grasps_; ++other) {
      if (!model.is_held(other)) continue;
      hand.H.middleCols<2>(material() + 1) += state.stiffness() * felt.middleCols<6>(6 * other) *
                                              sensitivity.dw_dparameter[other].rightCols<2>();
    }
    math::Vector6d y = now.y.segment<6>(row);
    y += rows.leftCols(offsets) * filter.mean().head(offsets);
    y += rows.col(filter.log_young()) * filter.mean()[filter.log_young()];
    y += rows.middleCols<6>(filter.bias(g)) * filter.mean().segment<6>(filter.bias(g));
    sums_[g] += y;
    hand.R = now.noise.block<6, 6>(row, row);
    const math::Vector6d predicted = now.measured.segment<6>(row) - now.y.segment<6>(row);
    const double force = options_.pose_error * predicted.head<3>().norm();
    const double torque = options_.pose_error * predicted.tail<3>().norm() + lever_[g] * force;
    hand.error << Eigen::Vector3d::Constant(force), Eigen::Vector3d::Constant(torque);
    hand.H.middleCols<6>(error(g)).setIdentity();
    row += 6;
  }
}

/// Earlier knowledge about the present: the errors that vary with the pose have decorrelated.
WrenchConsistency::Knowledge WrenchConsistency::at_present(
    const Knowledge& earlier) const noexcept {
  Knowledge present = earlier;
  for (int g = 0; g < grasps_; ++g) {
    const double kept = std::exp(earlier.travel[g] - travel_[g]);
    present.mean.segment<6>(error(g)) *= kept;
    present.covariance.middleRows<6>(error(g)) *= kept;
    present.covariance.middleCols<6>(error(g)) *= kept;
    present.covariance.diagonal().segment<6>(error(g)) +=
        (1 - kept * kept) * hands_[g].error.cwiseAbs2();
    present.travel[g] = travel_[g];
  }
  return present;
}

WrenchConsistency::Discrepancy WrenchConsistency::compare(int index,
                                                          const Knowledge& earlier) const noexcept {
  const HandData& hand = hands_[index];
  const Knowledge known = at_present(earlier);
  Discrepancy result;
  result.hand = index;
  result.wrench = hand.y - hand.H * known.mean;
  const Rows HP = hand.H * known.covariance;
  const math::Matrix6d S = HP * hand.H.transpose() + hand.R;
  const Eigen::LLT<math::Matrix6d> factor(S);
  if (factor.info() != Eigen::Success || !result.wrench.allFinite()) return result;
  result.test = result.wrench.dot(factor.solve(result.wrench)) / kHandRows;
  result.normalised = result.wrench.cwiseQuotient(S.diagonal().cwiseSqrt());
  result.normalised.cwiseAbs().maxCoeff(&result.axis);
  return result;
}

void WrenchConsistency::judge() noexcept {
  discrepancy_ = Discrepancy();
  int back = 0;
  for (int g = 0; g < grasps_; ++g) {
    if (!hands_[g].valid) continue;
    const auto consider = [&](const Knowledge& knowledge, int age) {
      const Discrepancy found = compare(g, knowledge);
      // The age of the most recent knowledge that is contradicted bounds the time since it began.
      if (found.test > threshold_ && (back == 0 || age < back)) back = age;
      if (found.test > discrepancy_.test) discrepancy_ = found;
    };
    if (is_inconsistent_) {
      consider(now_, 1);
      continue;
    }
    for (const int age : kAges)
      if (age <= snapshot_count_)
        consider(snapshots_[(newest_ - age + 1 + kSnapshots) % kSnapshots], age);
    consider(prior_, kSnapshots);
  }
  if (discrepancy_.test < 0) return;  // no wrench
  if (is_inconsistent_) {
    const bool passes = discrepancy_.test < kEnded * threshold_;
    passed_ = passes ? passed_ + 1 : 0;
    if (passed_ * kPeriod >= kEndsAfter) {
      is_inconsistent_ = false;
      exceeded_ = snapshot_count_ = updates_ = 0;
    }
    return;
  }
  exceeded_ = back > 0 ? exceeded_ + 1 : 0;
  if (exceeded_ < kConsecutive) return;
  is_inconsistent_ = has_just_begun_ = true;
  passed_ = 0;
  snapshots_back_ = back;
  now_ = back >= kSnapshots ? prior_ : snapshots_[(newest_ - back + 1 + kSnapshots) % kSnapshots];
}

void WrenchConsistency::learn_from_wrenches() noexcept {
  now_ = at_present(now_);
  for (int g = 0; g < grasps_; ++g) {
    const HandData& hand = hands_[g];
    if (!hand.valid) continue;
    const Rows HP = hand.H * now_.covariance;
    // Errors of a moving hand last longer than one update.
    math::Matrix6d S = hand.R * (kMotionErrors / kPeriod);
    S.noalias() += HP * hand.H.transpose();
    const Eigen::LLT<math::Matrix6d> factor(S);
    if (factor.info() != Eigen::Success) continue;
    const math::Vector6d y = hand.y - hand.H * now_.mean;
    const Rows gain = factor.solve(HP);  // transposed
    now_.mean.noalias() += gain.transpose() * y;
    now_.covariance.noalias() -= gain.transpose() * HP;
    now_.covariance = (0.5 * (now_.covariance + now_.covariance.transpose())).eval();
  }
}

}  // namespace palpate::estimation

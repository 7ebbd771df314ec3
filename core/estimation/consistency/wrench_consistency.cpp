#include "core/estimation/consistency/wrench_consistency.hpp"

#include "core/math/option_check.hpp"

namespace palpate::estimation {
namespace {

constexpr double kPeriod = 0.05;         // s, between two tests
constexpr double kSnapshotPeriod = 0.5;  // s
/// Ages of the knowledge that is tested, in snapshots.
constexpr std::array<int, 4> kAges{1, 2, 4, 8};
/// Tests whose results are nearly independent: one a second for each age and the prior.
constexpr double kTestsPerHour = 3600.0 * (kAges.size() + 1);
/// Fraction of the threshold that applies to the prior: the deviations of what was set up are
/// bounds rather than those of a normal distribution.
constexpr double kOfPrior = 0.48;
/// Tests beyond the threshold that begin a discrepancy: against earlier knowledge, and against the
/// prior, which lasts and may wait until vibrations of the object have passed.
constexpr int kConsecutive = 2, kConsecutiveOfPrior = 4;
constexpr double kEnded = 0.5;      // fraction of the threshold below which it ends
constexpr double kEndsAfter = 0.3;  // s

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

WrenchKnowledge prior_knowledge(const elasticity::Body& body, const WrenchFilter::Options& priors,
                                const WrenchConsistency::Options& options) {
  math::check_not_negative(options.poisson, "poisson");
  math::check_not_negative(options.density, "density");
  math::check_not_negative(options.stiffness_error, "stiffness_error");
  math::check_not_negative(options.pose_error, "pose_error");
  math::check_not_negative(options.position_error, "position_error");
  math::check_not_negative(options.rotation_error, "rotation_error");
  math::check_positive_finite(options.false_alarms, "false_alarms");
  const WrenchStates states{static_cast<int>(body.grasps.size()),
                            static_cast<int>(priors.obstacles.size())};
  WrenchKnowledge::Vector deviations = WrenchKnowledge::Vector::Zero(states.count());
  const auto six = [&deviations](int first, double linear, double angular) {
    deviations.segment<6>(first) << Eigen::Vector3d::Constant(linear),
        Eigen::Vector3d::Constant(angular);
  };
  for (int g = 0; g < states.grasps; ++g) {
    six(states.offset(g), priors.position, priors.rotation);
    six(states.bias(g), priors.bias_force, priors.bias_torque);
    six(states.stiffness(g), options.stiffness_error, options.stiffness_error);
    six(states.pose_error(g), options.position_error, options.rotation_error);
    six(states.wrench_error(g), options.pose_error, options.pose_error);
  }
  for (int k = 0; k < states.free_directions; ++k)
    deviations[states.obstacle() + k] = priors.obstacles[static_cast<std::size_t>(k)].deviation;
  deviations.segment<3>(states.log_young()) << priors.log_young, options.poisson, options.density;
  return {states, deviations, priors.memory};
}

/// Copies of one knowledge.
template <std::size_t... kIndex>
std::array<WrenchKnowledge, sizeof...(kIndex)> copies(const WrenchKnowledge& knowledge,
                                                      std::index_sequence<kIndex...> /*count*/) {
  return {((void)kIndex, knowledge)...};
}

}  // namespace

WrenchConsistency::WrenchConsistency(const elasticity::Body& body, const WrenchSampling& sampling,
                                     const WrenchFilter::Options& priors, const Options& options)
    : states_{static_cast<int>(body.grasps.size()), static_cast<int>(priors.obstacles.size())},
      sampling_(sampling),
      threshold_(chi_square_6(options.false_alarms / kTestsPerHour) / kHandRows),
      touch_(priors.obstacles),
      prior_(prior_knowledge(body, priors, options)),
      initial_(prior_),
      now_(prior_),
      snapshots_(copies(prior_, std::make_index_sequence<kSnapshots>())) {
  const Eigen::Vector3d middle = body.mesh.nodes.rowwise().mean();
  for (std::size_t g = 0; g < body.grasps.size(); ++g)
    lever_[g] = (body.grasps[g].X_OG_rest.translation() - middle).norm();
  for (std::size_t g = 0; g < record_.size(); ++g) {
    record_[g].grasp = static_cast<int>(g);
    record_[g].H = HandRecord::Rows::Zero(6, states_.count());
  }
  reset();
}

void WrenchConsistency::reset() noexcept {
  now_ = initial_ = prior_;
  newest_ = sum_count_ = 0;
  forget_snapshots();
  for (math::Vector6d& sum : sums_) sum.setZero();
  for (HandRecord& hand : record_) {
    hand.valid = false;
    hand.travel = hand.time = 0;
  }
  discrepancy_ = Discrepancy();
  is_inconsistent_ = has_just_begun_ = is_suspected_ = false;
  snapshots_back_ = passed_ = 0;
}

void WrenchConsistency::take_over(const WrenchFilter& filter) noexcept {
  reset();
  const auto assume = [&](int state, int first, int count) {
    WrenchKnowledge::Vector deviations(count);
    for (int i = 0; i < count; ++i) deviations[i] = filter.deviation(first + i);
    initial_.assume(state, filter.mean().segment(first, count), deviations);
  };
  for (int g = 0; g < states_.grasps; ++g) {
    assume(states_.offset(g), filter.offset(g), 6);
    assume(states_.bias(g), filter.bias(g), 6);
  }
  assume(states_.log_young(), filter.log_young(), 1);
  assume(states_.obstacle(), filter.obstacle(), states_.free_directions);
  now_ = initial_;
}

void WrenchConsistency::forget_snapshots() noexcept {
  exceeded_ = exceeded_prior_ = snapshot_count_ = updates_ = 0;
}

bool WrenchConsistency::take(const Innovation& now, const FusedState& state,
                             const elasticity::DeformationModel& model, bool learn) noexcept {
  has_just_begun_ = false;
  linearise(now, state, model);
  if (++sum_count_ < sampling_.updates_in(kPeriod)) return false;
  for (int g = 0; g < states_.grasps; ++g) {
    record_[g].y = sums_[g] / sum_count_;
    sums_[g].setZero();
  }
  sum_count_ = 0;
  judge();
  if (is_inconsistent_ || is_pending() || !learn) return false;
  learn_from_wrenches();
  constexpr int kUpdates = static_cast<int>(kSnapshotPeriod / kPeriod);
  if (++updates_ % kUpdates != 0) return false;
  newest_ = (newest_ + 1) % kSnapshots;
  snapshots_[newest_] = now_;
  snapshot_count_ = std::min(snapshot_count_ + 1, kSnapshots);
  return true;
}

/// Wrench difference of each hand for the nominal parameters, and its dependence on the states. The
/// innovation refers to the state of the filter, about which the model was linearised.
void WrenchConsistency::linearise(const Innovation& now, const FusedState& state,
                                  const elasticity::DeformationModel& model) noexcept {
  const WrenchFilter& filter = state.filter;
  const elasticity::Sensitivity& sensitivity = model.sensitivity();
  const int log_young = states_.log_young();
  const double stiffness = std::exp(filter.mean()[filter.log_young()]);
  const int obstacle = states_.obstacle(), free = states_.free_directions;
  touch_.take(model, stiffness);
  for (int g = 0, row = 0; g < states_.grasps; ++g) {
    HandRecord& hand = record_[g];
    hand.travel += now.travel[g];
    hand.time += sampling_.period;
    hand.valid = now.held[g];
    if (!hand.valid) continue;
    const auto rows = now.H.middleRows<6>(row);
    math::Vector6d y = now.y.segment<6>(row);
    math::Vector6d displaced = math::Vector6d::Zero();
    hand.H.setZero();
    for (int other = 0; other < states_.grasps; ++other) {
      const auto by_offset = rows.middleCols<6>(filter.offset(other));
      hand.H.middleCols<6>(states_.offset(other)) = by_offset / stiffness;
      hand.H.middleCols<6>(states_.pose_error(other)) = by_offset / stiffness;
      displaced += by_offset * filter.mean().segment<6>(filter.offset(other));
    }
    const UncertainTouch::Wrench touch =
        touch_.linearise(g, rows.middleCols(filter.obstacle(), free),
                         now_.covariance().block(obstacle, obstacle, free, free),
                         now.measured.segment<3>(row).norm());
    hand.H.middleCols(obstacle, free) = touch.by_direction / stiffness;
    displaced += touch.by_direction * filter.mean().segment(filter.obstacle(), free);
    const auto by_bias = rows.middleCols<6>(filter.bias(g));
    hand.H.middleCols<6>(states_.bias(g)) = by_bias;
    hand.H.col(log_young) = (rows.col(filter.log_young()) - displaced) / stiffness;
    const auto felt = state.motion.felt().block<6, 12>(6 * g, 0);
    for (int other = 0; other < states_.grasps; ++other) {
      if (!model.is_held(other)) continue;
      hand.H.middleCols<2>(log_young + 1) += state.stiffness() * felt.middleCols<6>(6 * other) *
                                             sensitivity.dw_dparameter[other].rightCols<2>();
    }
    y += displaced - touch.excess + (stiffness - 1) * hand.H.col(log_young) +
         by_bias * filter.mean().segment<6>(filter.bias(g));
    sums_[g] += y;
    hand.R = now.noise.block<6, 6>(row, row) + touch.covariance;
    hand.size = now_.size_of_wrench(hand, now.measured.segment<6>(row) - y, lever_[g]);
    row += 6;
  }
}

WrenchKnowledge::Comparison WrenchConsistency::compare(
    int hand, const WrenchKnowledge& earlier) const noexcept {
  WrenchKnowledge known = earlier;
  known.advance(record_);
  return known.compare(record_[hand]);
}

void WrenchConsistency::judge() noexcept {
  discrepancy_ = Discrepancy();
  int back = 0;
  bool contradicts_prior = false;
  for (int g = 0; g < states_.grasps; ++g) {
    differences_[g].setZero();
    deviations_[g].setConstant(-1);
    if (!record_[g].valid) continue;
    double most = -1;
    const auto consider = [&](const WrenchKnowledge& knowledge, int age) {
      const WrenchKnowledge::Comparison found = compare(g, knowledge);
      if (!found.valid) return;
      const double test =
          found.squared / kHandRows / (age == kSnapshots && !is_inconsistent_ ? kOfPrior : 1);
      // The age of the most recent knowledge that is contradicted bounds the time since it began.
      if (test > threshold_ && (back == 0 || age < back)) back = age;
      contradicts_prior = contradicts_prior || (test > threshold_ && age == kSnapshots);
      if (test <= most) return;
      most = test;
      differences_[g] = found.difference;
      deviations_[g] = found.S.diagonal().cwiseSqrt();
      if (test <= discrepancy_.test) return;
      discrepancy_.test = test;
      discrepancy_.hand = g;
      discrepancy_.wrench = found.difference;
      differences_[g].cwiseQuotient(deviations_[g]).cwiseAbs().maxCoeff(&discrepancy_.axis);
    };
    if (is_inconsistent_) {
      consider(now_, 1);
      continue;
    }
    for (const int age : kAges)
      if (age <= snapshot_count_)
        consider(snapshots_[(newest_ - age + 1 + kSnapshots) % kSnapshots], age);
    consider(initial_, kSnapshots);
  }
  if (discrepancy_.test < 0) return;  // no wrench
  if (is_inconsistent_) {
    const bool passes = !is_suspected_ && discrepancy_.test < kEnded * threshold_;
    passed_ = passes ? passed_ + 1 : 0;
    if (passed_ * kPeriod >= kEndsAfter) {
      is_inconsistent_ = false;
      forget_snapshots();
    }
    return;
  }
  exceeded_ = back > 0 && back < kSnapshots ? exceeded_ + 1 : 0;
  exceeded_prior_ = contradicts_prior ? exceeded_prior_ + 1 : 0;
  if (exceeded_ < kConsecutive && exceeded_prior_ < kConsecutiveOfPrior && !is_suspected_) return;
  if (back == 0) back = kSnapshots;
  is_inconsistent_ = has_just_begun_ = true;
  passed_ = 0;
  snapshots_back_ = back;
  now_ = back >= kSnapshots ? initial_ : snapshots_[(newest_ - back + 1 + kSnapshots) % kSnapshots];
}

/// Whether the last test exceeds the threshold and waits for the next ones. What is learnt from
/// such a wrench would be forgotten if they confirm it; one that is far off, as of a saturated
/// sensor, would move the parameters beyond where the model's derivatives hold.
bool WrenchConsistency::is_pending() const noexcept {
  return exceeded_ > 0 || (snapshot_count_ == 0 && exceeded_prior_ > 0);
}

void WrenchConsistency::learn_from_wrenches() noexcept {
  now_.advance(record_);
  for (const HandRecord& hand : record_) {
    if (!hand.valid) continue;
    now_.correct(hand, WrenchKnowledge::Appended::Zero(6, 0), hand.R * (kMotionErrors / kPeriod));
  }
}

void WrenchConsistency::resume(const WrenchKnowledge& knowledge) noexcept {
  now_ = initial_ = knowledge;
  is_inconsistent_ = is_suspected_ = false;
  forget_snapshots();
}

void WrenchConsistency::write(DiscrepancyReport& report) const noexcept {
  ++report.tests;
  report.is_inconsistent = is_inconsistent_;
  report.test = discrepancy_.test;
  report.threshold = threshold_;
  report.hand = discrepancy_.hand;
  report.axis = discrepancy_.axis;
  report.difference = differences_;
  report.deviation = deviations_;
}

}  // namespace palpate::estimation

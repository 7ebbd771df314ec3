#include "core/contact/indentation_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/math/option_check.hpp"

namespace palpate::contact {
namespace {

constexpr int kFewestSteps = 8;  // of the record, and 4 of them in contact
constexpr int kFewestInContact = 4;
constexpr int kMostIterations = 60;   // of a stage
constexpr double kMostDamping = 1e6;  // beyond it no step improves the fit
constexpr double kSettled = 1e-6;     // relative decrease of the cost
constexpr double kQuarter = 0.25;     // fraction of the largest force at which the guess looks
constexpr double kMostExponent = 4;
enum { kTouch, kForce, kBias, kExponent };

}  // namespace

void IndentationFit::Options::check() const {
  math::check_option(exponent >= 1 && exponent <= 3, "exponent", exponent, "1 to 3");
  math::check_option(exponent_deviation >= 0 && exponent_deviation <= 1, "exponent_deviation",
                     exponent_deviation, "0 to 1");
  math::check_positive_finite(bias_deviation, "bias_deviation");
  math::check_not_negative(force_play, "force_play");
}

IndentationFit::IndentationFit(const Options& options) : options_(options) { options.check(); }

void IndentationFit::begin(const ApproachRecord& record) noexcept {
  record_ = &record;
  result_ = Result();
  stage_ = Stage::kLaw;
  has_best_ = false;
  damping_ = 1e-3;
  iterations_ = 0;
  if (!guess()) fail("the approach has too few steps of travel in contact");
}

void IndentationFit::fail(const char* reason) noexcept {
  result_.valid = false;
  result_.reason = reason;
  stage_ = Stage::kDone;
}

/// s0 from where the force is a quarter of the largest one, and the part of the record that is
/// fitted: from two depths, at least 2 mm, before it, so that a slow drift of the force along the
/// approach does not matter.
bool IndentationFit::guess() noexcept {
  constexpr double kLeastBefore = 2e-3;  // m
  const ApproachRecord& steps = *record_;
  const int count = steps.count();
  if (count < kFewestSteps) return false;
  const auto smooth = [&](int i) {  // mean of up to three steps
    double sum = 0;
    int n = 0;
    for (int j = std::max(0, i - 1); j <= std::min(count - 1, i + 1); ++j)
      sum += steps[j].force, ++n;
    return sum / n;
  };
  const double largest = smooth(count - 1);
  if (!(largest > 0)) return false;
  int quarter = count - 1;
  while (quarter > 0 && smooth(quarter) > kQuarter * largest) --quarter;
  const double end = steps[count - 1].travel;
  const double below = end - steps[quarter].travel;  // m, over which the rest of the force grew
  depth_ = below / (1 - std::pow(kQuarter, 1 / options_.exponent));
  if (!(depth_ > kFewestInContact * steps.resolution())) return false;
  best_ << end - depth_, largest, 0, options_.exponent;
  trial_ = best_;
  const double from = best_[kTouch] - std::max(2 * depth_, kLeastBefore);
  begin_ = 0;
  while (steps[begin_].travel < from) ++begin_;
  // A first value, without influence on the result: replaced once the first stage has ended.
  variance_ = std::pow(0.05 * largest, 2);
  return count - begin_ >= kFewestSteps;
}

double IndentationFit::residual(const Vector& parameters, int i) const noexcept {
  const ApproachRecord::Step& step = (*record_)[i];
  const double depth = (step.travel - parameters[kTouch]) / depth_;
  const double force = depth > 0 ? parameters[kForce] * std::pow(depth, parameters[kExponent]) : 0;
  return step.force - parameters[kBias] - force;
}

IndentationFit::Sums IndentationFit::evaluate(const Vector& parameters) const noexcept {
  Sums sums;
  const double n = parameters[kExponent];
  for (int i = begin_; i < record_->count(); ++i) {
    const ApproachRecord::Step& step = (*record_)[i];
    const double depth = (step.travel - parameters[kTouch]) / depth_;
    Vector slope = Vector::Zero();
    slope[kBias] = 1;
    double force = 0;
    if (depth > 0) {
      const double shape = std::pow(depth, n);
      force = parameters[kForce] * shape;
      slope[kTouch] = -n * force / (depth * depth_);
      slope[kForce] = shape;
      if (frees_exponent()) slope[kExponent] = force * std::log(depth);
    }
    const double error = step.force - parameters[kBias] - force;
    sums.squares += step.samples * error * error;
    sums.gradient += step.samples * error * slope;
    sums.normal += step.samples * slope * slope.transpose();
  }
  return sums;
}

/// Negative log likelihood and priors, without constants.
double IndentationFit::cost(const Sums& sums, const Vector& parameters) const noexcept {
  const double bias = parameters[kBias] / options_.bias_deviation;
  double cost = sums.squares / variance_ + bias * bias;
  if (frees_exponent()) {
    const double off = (parameters[kExponent] - options_.exponent) / options_.exponent_deviation;
    cost += off * off;
  }
  return 0.5 * cost;
}

IndentationFit::Matrix IndentationFit::information(const Sums& sums) const noexcept {
  Matrix information = sums.normal / variance_;
  information(kBias, kBias) += std::pow(options_.bias_deviation, -2);
  information(kExponent, kExponent) +=
      frees_exponent() ? std::pow(options_.exponent_deviation, -2) : 1;  // 1: it does not move
  return information;
}

void IndentationFit::propose() noexcept {
  Vector slope = sums_.gradient / variance_;
  slope[kBias] -= best_[kBias] / std::pow(options_.bias_deviation, 2);
  if (frees_exponent())
    slope[kExponent] -=
        (best_[kExponent] - options_.exponent) / std::pow(options_.exponent_deviation, 2);
  Matrix damped = information(sums_);
  damped.diagonal() *= 1 + damping_;
  Vector step = damped.ldlt().solve(slope);
  // A step across the whole depth would leave the part of the record that is fitted.
  step[kTouch] = std::clamp(step[kTouch], -0.5 * depth_, 0.5 * depth_);
  trial_ = best_ + step;
  trial_[kExponent] = std::clamp(trial_[kExponent], 0.5, kMostExponent);
}

void IndentationFit::advance() noexcept {
  if (done()) return;
  const Sums sums = evaluate(trial_);
  const double cost = this->cost(sums, trial_);
  if (!std::isfinite(cost) && !has_best_) return fail("the record is not finite");
  const bool better = !has_best_ || cost < best_cost_;
  const double decrease = has_best_ ? (best_cost_ - cost) / std::max(best_cost_, 1e-12) : 1;
  if (better) {
    best_ = trial_;
    best_cost_ = cost;
    sums_ = sums;
    has_best_ = true;
    damping_ = std::max(1e-9, damping_ / 5);
  } else {
    damping_ *= 4;
  }
  const bool settled = (better && decrease < kSettled) || damping_ > kMostDamping;
  if (settled || ++iterations_ >= kMostIterations) return next_stage();
  propose();
}

void IndentationFit::next_stage() noexcept {
  if (iterations_ >= kMostIterations && damping_ <= kMostDamping && stage_ == Stage::kAll)
    return fail("the fit of the approach did not converge");
  find_noise();
  if (stage_ == Stage::kAll) return conclude();
  stage_ = Stage::kAll;
  has_best_ = false;
  damping_ = 1e-3;
  iterations_ = 0;
  trial_ = best_;
}

/// Variance of a sample from the residuals, and their integrated autocorrelation time up to the
/// first lag that is not significantly correlated.
void IndentationFit::find_noise() noexcept {
  constexpr int kParameters = 4, kMostLag = 64;
  const int count = record_->count() - begin_;
  double squares = 0;
  for (int i = 0; i < count; ++i) {
    const double samples = (*record_)[begin_ + i].samples;
    residuals_[static_cast<std::size_t>(i)] = std::sqrt(samples) * residual(best_, begin_ + i);
    squares += std::pow(residuals_[static_cast<std::size_t>(i)], 2);
  }
  const double significant = 2 / std::sqrt(static_cast<double>(count));
  double time = 1;
  for (int lag = 1; lag <= std::min(kMostLag, count / 4); ++lag) {
    double sum = 0;
    for (int i = lag; i < count; ++i)
      sum +=
          residuals_[static_cast<std::size_t>(i)] * residuals_[static_cast<std::size_t>(i - lag)];
    if (!(sum > significant * squares)) break;
    time += 2 * sum / squares;
  }
  const double variance = squares / std::max(1, count - kParameters);
  result_.noise = std::sqrt(variance);
  result_.correlation = time;
  // The floor keeps a record without noise solvable.
  variance_ = std::max(variance * time, 1e-12 * best_[kForce] * best_[kForce] + 1e-24);
}

void IndentationFit::conclude() noexcept {
  const double end = (*record_)[record_->count() - 1].travel;
  const double depth = end - best_[kTouch];
  stage_ = Stage::kDone;
  if (!best_.allFinite() || !(best_[kForce] > 0)) return fail("the force does not rise");
  if (best_[kTouch] <= (*record_)[begin_].travel) return fail("the record begins in contact");
  if (!(depth > kFewestInContact * record_->resolution()))
    return fail("the approach has too few steps of travel in contact");
  stage_ = Stage::kAll;  // information() with all parameters
  const Matrix covariance = information(sums_).inverse();
  stage_ = Stage::kDone;
  const double shape = std::pow(depth / depth_, best_[kExponent]);
  const double n = best_[kExponent];
  result_.touch = best_[kTouch];
  result_.touch_deviation = std::sqrt(covariance(kTouch, kTouch));
  result_.indentation = depth;
  result_.force = best_[kForce] * shape;
  result_.stiffness = result_.force / depth;
  result_.exponent = n;
  // d (F / d): the depth at a fixed travel falls as s0 rises.
  Vector slope;
  slope << (1 - n) * result_.stiffness / depth, shape / depth, 0,
      result_.stiffness * std::log(depth / depth_);
  result_.stiffness_deviation = std::sqrt(slope.dot(covariance * slope));
  result_.valid =
      std::isfinite(result_.touch_deviation) && std::isfinite(result_.stiffness_deviation);
  if (!result_.valid) return fail("the fit of the approach is singular");
  if (options_.force_play > 0) correct_for_play();
}

/// Means over p by Gauss's quadrature. The true depth is that of the reading plus the shift, the
/// true force F + p, and the shift the depth at which Hertz' law, or that of the option, has the
/// force p: the fitted exponent is that of the reading, which begins with a slope. It is skewed:
/// the deviation of the touch covers the whole range of p in 95 % intervals.
void IndentationFit::correct_for_play() noexcept {
  constexpr std::array<double, 5> kPlaces = {0.0469100770, 0.2307653449, 0.5, 0.7692346551,
                                             0.9530899230};
  constexpr std::array<double, 5> kWeights = {0.1184634425, 0.2393143352, 0.2844444444,
                                              0.2393143352, 0.1184634425};
  constexpr double kNormal95 = 1.96;
  const auto shift_of = [this](double p) {
    const double share = std::pow(p / (result_.force + p), 1 / options_.exponent);
    return result_.indentation * share / (1 - share);
  };
  double shift = 0, stiffness = 0, stiffness_squares = 0;
  for (std::size_t i = 0; i < kPlaces.size(); ++i) {
    const double p = kPlaces[i] * options_.force_play, s = shift_of(p);
    const double k = (result_.force + p) / (result_.indentation + s);
    shift += kWeights[i] * s;
    stiffness += kWeights[i] * k;
    stiffness_squares += kWeights[i] * k * k;
  }
  const double farthest = std::max(shift, shift_of(options_.force_play) - shift);
  result_.touch -= shift;
  result_.touch_deviation = std::hypot(result_.touch_deviation, farthest / kNormal95);
  result_.indentation += shift;
  result_.force += 0.5 * options_.force_play;
  result_.stiffness = stiffness;
  result_.stiffness_deviation =
      std::hypot(result_.stiffness_deviation,
                 std::sqrt(std::max(0.0, stiffness_squares - stiffness * stiffness)));
}

}  // namespace palpate::contact

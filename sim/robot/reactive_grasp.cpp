#include "sim/robot/reactive_grasp.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace palpate::robot {
namespace {
constexpr double kTouch = 1e-3;  // N
/// Growth factor of the step without contact. Two reversals reduce the step by more than it grows
/// while a finger that has bounced off finds the object again; otherwise it would chatter for ever.
constexpr double kGrowth = 1.1;
}  // namespace

ReactiveGrasp::ReactiveGrasp(std::vector<Finger> fingers, JointLimits limits,
                             const GraspOptions& options)
    : fingers_(std::move(fingers)),
      limits_(std::move(limits)),
      options_(options),
      progress_(fingers_.size()),
      target_(Eigen::VectorXd::Zero(limits_.lower.size())) {
  for (const Finger& finger : fingers_) {
    if (!(finger.step > 0)) throw std::invalid_argument("a finger's step must be above zero");
    for (int joint : finger.joints)
      if (joint < 0 || joint >= target_.size())
        throw std::invalid_argument("a finger has a joint that the hand does not have");
  }
  if (!(options_.lead > 0) || !(options_.finest > 0 && options_.finest <= 1))
    throw std::invalid_argument("lead must be above zero and finest above zero, 1 at most");
}

void ReactiveGrasp::reset(const Eigen::VectorXd& q) {
  if (q.size() != target_.size()) throw std::invalid_argument("wrong number of hand joints");
  target_ = q;
  stay();
}

void ReactiveGrasp::close(const ForceBand& band) {
  if (!(band.lower > 0 && band.upper > band.lower))
    throw std::invalid_argument("a force band needs 0 < lower < upper");
  band_ = band;
  action_ = Action::kClose;
}

void ReactiveGrasp::open() { action_ = Action::kOpen; }

void ReactiveGrasp::stay() {
  action_ = Action::kStay;
  in_band_ = 0;
  std::fill(progress_.begin(), progress_.end(), Progress());
}

int ReactiveGrasp::direction(double force) const {
  if (action_ == Action::kStay) return 0;
  if (action_ == Action::kOpen) return -1;
  if (force < band_.lower) return 1;
  return force > band_.upper ? -1 : 0;  // also 0 if it is not finite
}

double ReactiveGrasp::part(Progress& progress, int direction, bool touching) const {
  if (!touching && direction >= 0) {
    progress.part = std::min(1.0, kGrowth * progress.part);
  } else if (direction * progress.direction < 0) {
    progress.part = std::max(options_.finest, progress.part / 2);
  }
  if (direction != 0) progress.direction = direction;
  return progress.part;
}

const Eigen::VectorXd& ReactiveGrasp::step(const Eigen::VectorXd& q, const Eigen::VectorXd& force) {
  in_band_ = 0;
  for (int f = 0; f < finger_count(); ++f) {
    const int way = direction(force(f));
    if (action_ == Action::kClose && way == 0 && std::isfinite(force(f))) ++in_band_;
    if (way == 0) continue;
    const double most =
        action_ == Action::kOpen ? 1 : part(progress_[f], way, std::abs(force(f)) > kTouch);
    for (int joint : fingers_[f].joints) {
      const double wanted = target_(joint) + way * most * fingers_[f].step;
      const double near = std::clamp(wanted, q(joint) - options_.lead, q(joint) + options_.lead);
      target_(joint) = std::clamp(near, limits_.lower(joint), limits_.upper(joint));
    }
  }
  return target_;
}

}  // namespace palpate::robot

#include "integral_law.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <stdexcept>

namespace example {

using palpate::plugin::number;

std::vector<palpate::plugin::Parameter> IntegralLaw::parameters() {
  const Options o;
  return {number("gain", 1e-3, 50, o.gain, "of the error, 1/s"),
          number("integral_gain", 0, 50, o.integral_gain, "of its integral, 1/s^2"),
          number("integral_zone", 1e-4, 1, o.integral_zone, "error that is integrated, m or rad"),
          number("damping", 1e-4, 1, o.damping, "of the inverse"),
          number("linear_speed", 1e-4, 10, o.linear_speed, "limit, m/s"),
          number("angular_speed", 1e-4, 10, o.angular_speed, "limit, rad/s"),
          number("length", 1e-3, 10, o.length, "that counts as much as a radian, m")};
}

IntegralLaw::Options IntegralLaw::read(const palpate::plugin::Parameters& p) {
  return {p.number("gain"),    p.number("integral_gain"), p.number("integral_zone"),
          p.number("damping"), p.number("linear_speed"),  p.number("angular_speed"),
          p.number("length")};
}

void IntegralLaw::configure_for(const palpate::shape::Feature& feature) {
  if (feature.dimension() > 6)
    throw std::invalid_argument("steers features of at most 6 rows; " +
                                std::string(feature.kind()) + " has " +
                                std::to_string(feature.dimension()));
  integral_.setZero(feature.dimension());
  target_.setZero(0);
}

void IntegralLaw::compute(const palpate::control::LawInputs& inputs,
                          palpate::control::LawOutput& output) {
  const Rows error = *inputs.error;
  if (inputs.jacobian->cols() != 6) {
    output.remark = "integral_twist moves one hand only";
    return;
  }
  // Another target: the integral of the previous one is discarded.
  if (inputs.target->size() <= 6 &&
      (target_.size() != inputs.target->size() || target_ != *inputs.target)) {
    target_ = *inputs.target;
    integral_.setZero();
  }
  if (error.norm() < options_.integral_zone) integral_ += inputs.dt * error;
  const double most = options_.integral_zone / std::max(options_.integral_gain, 1e-9);
  if (integral_.norm() > most) integral_ *= most / integral_.norm();

  // Rotations as metres at `length`, so that both have equal weight.
  Jacobian J = *inputs.jacobian;
  J.rightCols<3>() /= options_.length;
  Square normal = J * J.transpose();
  normal.diagonal().array() += options_.damping * options_.damping;
  const Eigen::LDLT<Square> factor(normal);
  const Rows wanted = options_.gain * error + options_.integral_gain * integral_;
  Eigen::Matrix<double, 6, 1> u = J.transpose() * Rows(factor.solve(wanted));
  u.tail<3>() /= options_.length;
  output.unreachable = error - Rows(J * (J.transpose() * Rows(factor.solve(error))));

  const double excess = std::max({1.0, u.head<3>().norm() / options_.linear_speed,
                                  u.tail<3>().norm() / options_.angular_speed});
  output.V_O_G = {u.head<3>() / excess, u.tail<3>() / excess};
}

}  // namespace example

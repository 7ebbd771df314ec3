#include "integral_law.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <stdexcept>

namespace example {

palpate::config::OptionTable<IntegralLaw::Options> IntegralLaw::table() {
  return palpate::config::OptionTable<Options>()
      .number("gain", "1/s", "gain on the error", {1e-3, 50}, &Options::gain)
      .number("integral_gain", "1/s^2", "gain on the integral of the error", {0, 50},
              &Options::integral_gain)
      .number("integral_zone", "m or rad", "largest error that is integrated", {1e-4, 1},
              &Options::integral_zone)
      .number("damping", "", "of the inverse", {1e-4, 1}, &Options::damping)
      .number("linear_speed", "m/s", "largest", {1e-4, 10}, &Options::linear_speed)
      .number("angular_speed", "rad/s", "largest", {1e-4, 10}, &Options::angular_speed)
      .number("length", "m", "translation equivalent to a rotation by a radian", {1e-3, 10},
              &Options::length);
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
                          palpate::plugin::PluginLawOutput& output) {
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

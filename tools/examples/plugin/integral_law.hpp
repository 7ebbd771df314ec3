#pragma once

#include "rt/plugin/plugin.hpp"

namespace example {

/// Example of a user's control law: a damped inverse of the Jacobian drives the error and its
/// integral to zero,
///   u = J^T (J J^T + d^2)^-1 (kp e + ki integral of e),
/// which removes the steady-state error of a proportional law due to friction or a drifting target.
/// For features of at most six rows that one hand moves.
class IntegralLaw : public palpate::plugin::PluginControlLaw {
 public:
  struct Options {
    double gain = 1;           // kp, 1/s
    double integral_gain = 1;  // ki, 1/s^2
    double integral_zone =
        0.01;  // largest error (m, rad) that is integrated: prevents wind-up far from the target
    double damping = 0.02;       // d, of rows per metre
    double linear_speed = 0.05;  // m/s
    double angular_speed = 0.4;  // rad/s
    double length = 0.1;         // m, translation equivalent to a rotation of one radian
  };
  /// The keys of the configuration.
  static palpate::config::OptionTable<Options> table();

  explicit IntegralLaw(const Options& options) : options_(options) {}

  /// Throws std::invalid_argument if the feature has more than six rows.
  void configure_for(const palpate::shape::Feature& feature) override;
  void compute(const palpate::control::LawInputs& inputs,
               palpate::plugin::PluginLawOutput& output) override;
  void reset() override { integral_.setZero(); }

 private:
  // Of bounded size, to avoid any heap allocation.
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1>;
  using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, 6, 0, 6, 6>;
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;

  Options options_;
  Rows integral_, target_;
};

}  // namespace example

#pragma once

#include "rt/plugin/plugin.hpp"

namespace example {

/// A control law of one's own: a damped inverse of the Jacobian drives the error and its integral
/// to zero,
///   u = J^T (J J^T + d^2)^-1 (kp e + ki integral of e),
/// so that what a proportional law leaves over, for friction or a drifting target, goes away. For
/// features of at most six rows that one hand moves.
class IntegralLaw : public palpate::plugin::PluginControlLaw {
 public:
  struct Options {
    double gain = 1;              // kp, 1/s
    double integral_gain = 1;     // ki, 1/s^2
    double integral_zone = 0.01;  // largest error (m, rad) that is integrated: no wind-up far away
    double damping = 0.02;        // d, of rows per metre
    double linear_speed = 0.05;   // m/s
    double angular_speed = 0.4;   // rad/s
    double length = 0.1;          // m, of motion that counts as much as a radian
  };
  /// The keys of the configuration, and the options that they say.
  static std::vector<palpate::plugin::Parameter> parameters();
  static Options read(const palpate::plugin::Parameters& parameters);

  explicit IntegralLaw(const Options& options) : options_(options) {}

  /// Throws std::invalid_argument where the feature has more than six rows.
  void configure_for(const palpate::shape::Feature& feature) override;
  void compute(const palpate::control::LawInputs& inputs,
               palpate::control::LawOutput& output) override;
  void reset() override { integral_.setZero(); }

 private:
  // Of bounded size, so that nothing of it is ever on the heap.
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1>;
  using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, 6, 0, 6, 6>;
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;

  Options options_;
  Rows integral_, target_;
};

}  // namespace example

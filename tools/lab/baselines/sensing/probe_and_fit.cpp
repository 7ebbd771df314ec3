#include "tools/lab/baselines/sensing/probe_and_fit.hpp"

#include <Eigen/LU>
#include <cmath>
#include <stdexcept>

namespace palpate::baselines {

using elasticity::Sensitivity;

namespace {

constexpr double kKept = 0.1;  // weight of previous data in the next round

}  // namespace

ProbeAndFit::ProbeAndFit(const elasticity::Body& body, const mesh::Surface& surface,
                         const Options& options)
    : CloudEstimator(body, surface, options),
      options_(options),
      nominal_poisson_(body.material.poisson_ratio),
      nominal_log_young_(std::log(body.material.young_modulus)) {
  for (const double value :
       {options.probing, options.rounds, options.force, options.torque, options.period,
        options.deviation, options.log_young_prior, options.poisson_prior})
    if (!(value > 0)) throw std::invalid_argument("options of probe and fit must be positive");
  if (!options.hand) throw std::invalid_argument("probe and fit cannot do without the hand's pose");
  begin(body.mesh.nodes);
}

void ProbeAndFit::begin(const Eigen::Matrix3Xd&) noexcept {
  since_start_ = since_solved_ = since_wrench_ = 0;
  found_ << 0, nominal_poisson_;
  deviation_ << options_.log_young_prior, options_.poisson_prior;
  information_ = deviation_.cwiseAbs2().cwiseInverse().asDiagonal();
  vector_.setZero();
}

/// Adds a difference between measurement and model, which uses the estimated E but its configured
/// nu.
void ProbeAndFit::add(const Eigen::Vector2d& slope, double residual, double deviation) noexcept {
  const double at_zero = residual + slope[0] * found_[0];  // residual for (0, nominal nu)
  if (!slope.allFinite() || !std::isfinite(at_zero)) return;
  information_ += slope * slope.transpose() / (deviation * deviation);
  vector_ += slope * (at_zero / (deviation * deviation));
}

void ProbeAndFit::add_wrench(int grasp, const estimation::GraspInput& input,
                             const elasticity::DeformationModel& model) noexcept {
  if (!input.wrench_valid || !model.is_held(grasp)) return;
  const double k = std::exp(found_[0]);
  const math::Vector6d residual = input.F_G_O.vector() - k * model.reaction(grasp).vector();
  // The model represents an object k times as stiff under 1 / k of its weight: the derivative of
  // the wrench with respect to log E is the model's own times k.
  const Eigen::Matrix<double, 6, 3>& by = model.sensitivity().dw_dparameter[grasp];
  for (int i = 0; i < 6; ++i)
    add({k * by(i, Sensitivity::kLogYoung), k * by(i, Sensitivity::kPoisson)}, residual[i],
        i < 3 ? options_.force : options_.torque);
}

void ProbeAndFit::take(elasticity::DeformationModel& model) noexcept {
  if (is_done() || !model.sensitivity().valid) return;
  const auto& by = model.sensitivity().dx_dparameter;
  for (int i = 0; i < matches().count(); ++i) {
    const CloudMatch& match = matches()[i];
    Eigen::Vector2d slope = Eigen::Vector2d::Zero();
    for (int n = 0; n < match.place.count; ++n) {
      const auto rows = by.middleRows<3>(3 * match.place.nodes[n]);
      slope[0] += match.place.weights[n] * match.place.normal.dot(rows.col(Sensitivity::kLogYoung));
      slope[1] += match.place.weights[n] * match.place.normal.dot(rows.col(Sensitivity::kPoisson));
    }
    add(slope, match.place.normal.dot(match.point - match.of(model.positions())),
        options_.deviation);
  }
}

void ProbeAndFit::solve() noexcept {
  since_solved_ = 0;
  const Eigen::Matrix2d covariance = information_.inverse();
  const Eigen::Vector2d change = covariance * vector_;
  if (!change.allFinite()) return;
  found_[0] = std::clamp(change[0], -3.0, 3.0);
  found_[1] = std::clamp(nominal_poisson_ + change[1], -0.99, 0.499);
  deviation_ = covariance.diagonal().cwiseSqrt();
  // The next data are linearised at a better estimate: previous data are weighted less.
  information_ *= kKept;
  vector_ *= kKept;
}

elasticity::StepReport ProbeAndFit::advance(double dt, const estimation::EstimationInputs& inputs,
                                            elasticity::DeformationModel& model) noexcept {
  const bool was_done = is_done();
  since_start_ += dt;
  since_solved_ += dt;
  since_wrench_ += dt;
  if (!was_done && since_wrench_ >= options_.period && model.sensitivity().valid) {
    since_wrench_ = 0;
    for (int g = 0; g < inputs.grasp_count; ++g) add_wrench(g, inputs.grasps[g], model);
  }
  if (!was_done && (is_done() || since_solved_ >= options_.rounds)) solve();
  model.set_gravity(std::exp(-found_[0]) * model.body().gravity_O);
  return model.step(dt);
}

void ProbeAndFit::report(estimation::Estimate& estimate) noexcept {
  const double k = std::exp(found_[0]);
  for (math::Wrench& reaction : estimate.reaction)
    reaction = math::Wrench::from(k * reaction.vector());
  estimate.log_young_modulus = nominal_log_young_ + found_[0];
  estimate.log_young_modulus_deviation = deviation_[0];
  estimate.poisson_ratio = found_[1];
}

}  // namespace palpate::baselines

#include "tools/lab/baselines/sensing/probed_cloud_fem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace palpate::baselines {
namespace {

constexpr double kSettled = 0.5;  // s, until the model has settled under its weight
// Limit of the factor on E in either direction, beyond which the cloud's springs are unstable.
constexpr double kMostChange = 5;

}  // namespace

ProbedCloudFem::ProbedCloudFem(const elasticity::Body& body, const mesh::Surface& surface,
                               const Options& options)
    : CloudEstimator(body, surface, options),
      options_(options),
      nominal_log_young_(std::log(body.material.young_modulus)) {
  if (!(options.stiffness > 0) || !(options.damping >= 0))
    throw std::invalid_argument("springs of a cloud want stiffness > 0 and damping >= 0");
  if (!(options.probing > 0) || !(options.force > 0))
    throw std::invalid_argument("duration and force of probing must be above zero");
  if (!options.hand) throw std::invalid_argument("where the probe pushes has to be known");
}

void ProbedCloudFem::begin(const Eigen::Matrix3Xd&) noexcept {
  found_ = 1;
  since_start_ = common_ = simulated_ = 0;
  first_measured_.setConstant(std::numeric_limits<double>::quiet_NaN());
}

/// as changes since the first one, so that tare and bias of a sensor cancel
void ProbedCloudFem::compare_forces(const estimation::EstimationInputs& inputs,
                                    const elasticity::DeformationModel& model) noexcept {
  if (since_start_ < kSettled || inputs.grasp_count == 0 || !inputs.grasps[0].wrench_valid ||
      !model.is_held(0))
    return;
  const Eigen::Vector3d simulated = model.reaction(0).force;
  const Eigen::Vector3d measured = inputs.grasps[0].F_G_O.force;
  if (!simulated.allFinite() || !measured.allFinite()) return;
  if (!first_measured_.allFinite()) {
    first_measured_ = measured;
    first_simulated_ = simulated;
  }
  const Eigen::Vector3d change = simulated - first_simulated_;
  // Keeps the configured E if the force has hardly changed.
  const double noise = options_.force * options_.force;
  common_ += change.dot(measured - first_measured_) + noise;
  simulated_ += change.squaredNorm() + noise;
}

elasticity::StepReport ProbedCloudFem::advance(double dt,
                                               const estimation::EstimationInputs& inputs,
                                               elasticity::DeformationModel& model) noexcept {
  const bool probing = since_start_ < options_.probing;
  if (probing) {
    since_start_ += dt;
    compare_forces(inputs, model);
    if (since_start_ >= options_.probing && simulated_ > 0)
      found_ = std::clamp(common_ / simulated_, 1 / kMostChange, kMostChange);
  }
  model.set_gravity(model.body().gravity_O / found_);
  model.loads().setZero();
  // springs to the cloud would bear a part of the compared force
  if (!probing)
    pull_to_cloud(matches(), options_.stiffness / found_, options_.damping / found_,
                  model.positions(), model.velocities(), model.loads());
  return model.step(dt);
}

void ProbedCloudFem::report(estimation::Estimate& estimate) noexcept {
  for (math::Wrench& reaction : estimate.reaction)
    reaction = math::Wrench::from(found_ * reaction.vector());
  estimate.log_young_modulus = nominal_log_young_ + std::log(found_);
}

}  // namespace palpate::baselines

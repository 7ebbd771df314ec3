#include "core/published_sensing/probed_cloud_fem.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace palpate::published_sensing {
namespace {

constexpr double kMostChange = 20;  // of E, either way

}  // namespace

ProbedCloudFem::ProbedCloudFem(const elasticity::Body& body, const mesh::Surface& surface,
                               const Options& options)
    : CloudEstimator(body, surface, options),
      options_(options),
      nominal_log_young_(std::log(body.material.young_modulus)) {
  if (!(options.stiffness > 0) || !(options.damping >= 0))
    throw std::invalid_argument("springs of a cloud want stiffness > 0 and damping >= 0");
  if (!(options.probing > 0) || !(options.round > 0))
    throw std::invalid_argument("probing of a cloud's finite elements must take some time");
  if (!options.hand) throw std::invalid_argument("where the probe pushes has to be known");
}

void ProbedCloudFem::begin(const Eigen::Matrix3Xd&) noexcept {
  found_ = 1;
  since_start_ = since_found_ = common_ = simulated_ = 0;
}

/// The model's reaction is that of the configuration's E: the object's is `found_` times that.
void ProbedCloudFem::compare_forces(const estimation::EstimationInputs& inputs,
                                    const elasticity::DeformationModel& model) noexcept {
  for (int g = 0; g < inputs.grasp_count; ++g) {
    const estimation::GraspInput& grasp = inputs.grasps[g];
    if (!grasp.wrench_valid || !model.is_held(g)) continue;
    const Eigen::Vector3d simulated = model.reaction(g).force, measured = grasp.F_G_O.force;
    if (!simulated.allFinite() || !measured.allFinite()) continue;
    common_ += simulated.dot(measured);
    simulated_ += simulated.squaredNorm();
  }
}

elasticity::StepReport ProbedCloudFem::advance(double dt,
                                               const estimation::EstimationInputs& inputs,
                                               elasticity::DeformationModel& model) noexcept {
  if (since_start_ < options_.probing) {
    since_start_ += dt;
    since_found_ += dt;
    compare_forces(inputs, model);
    if ((since_found_ >= options_.round || since_start_ >= options_.probing) && simulated_ > 0) {
      found_ = std::clamp(common_ / simulated_, 1 / kMostChange, kMostChange);
      since_found_ = common_ = simulated_ = 0;
    }
  }
  model.set_gravity(model.body().gravity_O / found_);
  model.loads().setZero();
  pull_to_cloud(matches(), options_.stiffness / found_, options_.damping / found_,
                model.positions(), model.velocities(), model.loads());
  return model.step(dt);
}

void ProbedCloudFem::tell(estimation::Estimate& estimate) noexcept {
  for (math::Wrench& reaction : estimate.reaction)
    reaction = math::Wrench::from(found_ * reaction.vector());
  estimate.log_young_modulus = nominal_log_young_ + std::log(found_);
}

}  // namespace palpate::published_sensing

#include "tools/lab/baselines/sensing/cloud_driven_fem.hpp"

#include <stdexcept>

namespace palpate::baselines {

CloudDrivenFem::CloudDrivenFem(const elasticity::Body& body, const mesh::Surface& surface,
                               const Options& options)
    : CloudEstimator(body, surface, options),
      stiffness_(options.stiffness),
      damping_(options.damping) {
  if (!(stiffness_ > 0) || !(damping_ >= 0))
    throw std::invalid_argument("springs of a cloud want stiffness > 0 and damping >= 0");
}

void CloudDrivenFem::begin(const Eigen::Matrix3Xd&) noexcept {}

elasticity::StepReport CloudDrivenFem::advance(double dt, const estimation::EstimationInputs&,
                                               elasticity::DeformationModel& model) noexcept {
  model.loads().setZero();
  pull_to_cloud(matches(), stiffness_, damping_, model.positions(), model.velocities(),
                model.loads());
  return model.step(dt);
}

}  // namespace palpate::baselines

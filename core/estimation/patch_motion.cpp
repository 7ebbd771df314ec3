#include "core/estimation/patch_motion.hpp"

#include <Eigen/LU>
#include <algorithm>

#include "core/estimation/virtual_loads.hpp"

namespace palpate::estimation {

PatchMotion::PatchMotion(int shape_size)
    : by_state_(WrenchFilter::ShapeMatrix::Zero(shape_size, shape_size)),
      wrench_by_state_(WrenchRows::Zero(12, shape_size)) {}

void PatchMotion::update(const elasticity::DeformationModel& model, const WrenchFilter& filter,
                         const std::array<math::Pose, 2>& X_OG, double stiffness) noexcept {
  const elasticity::Sensitivity& sensitivity = model.sensitivity();
  const int grasps = filter.grasp_count(), load = filter.load();
  Wrenches K = Wrenches::Zero(), C = Wrenches::Zero(), turn = Wrenches::Identity();
  Eigen::Matrix<double, 12, 1> scaled = Eigen::Matrix<double, 12, 1>::Zero();
  for (int g = 0; g < grasps; ++g) {
    if (!model.is_held(g)) continue;
    const elasticity::GraspRegion& grasp = model.body().grasps[static_cast<std::size_t>(g)];
    const math::Matrix6d R = math::both_halves(X_OG[static_cast<std::size_t>(g)].linear());
    turn.block<6, 6>(6 * g, 6 * g) = R;
    C.block<6, 6>(6 * g, 6 * g) =
        R * (stiffness * grasp.compliance + grasp.object_compliance) * R.transpose();
    // a stiffer object deflects the grasp less for the same model wrench
    scaled.segment<6>(6 * g) =
        R * grasp.object_compliance * (R.transpose() * model.reaction(g).vector());
    for (int other = 0; other < grasps; ++other)
      if (model.is_held(other)) K.block<6, 6>(6 * g, 6 * other) = sensitivity.dw_dxi[g][other];
  }
  felt_ = (Wrenches::Identity() + K * C).eval().partialPivLu().inverse();
  if (!felt_.allFinite()) felt_.setIdentity();

  WrenchRows& wrench = wrench_by_state_;
  wrench.setZero();
  wrench.leftCols(6 * grasps) = (K * turn).leftCols(6 * grasps);
  for (int g = 0; g < grasps; ++g) {
    if (!model.is_held(g)) continue;
    wrench.block<6, 1>(6 * g, filter.log_young()) =
        sensitivity.dw_dparameter[g].col(elasticity::Sensitivity::kLogYoung);
    const int free = std::min<int>(filter.free_directions(),
                                   static_cast<int>(sensitivity.dw_dobstacle[g].cols()));
    wrench.block(6 * g, filter.obstacle(), 6, free) = sensitivity.dw_dobstacle[g].leftCols(free);
    for (int k = 0; filter.has_loads() && k < VirtualLoads::kCount; ++k)
      wrench.block<6, 3>(6 * g, load + 3 * k) = sensitivity.dw_dforce[g][k];
  }
  wrench.col(filter.log_young()) += K * scaled;
  wrench = (felt_ * wrench).eval();

  by_state_.setIdentity();
  by_state_.topRows(6 * grasps) = -(C * wrench).topRows(6 * grasps);
  by_state_.topLeftCorner(6 * grasps, 6 * grasps) += turn.topLeftCorner(6 * grasps, 6 * grasps);
  by_state_.col(filter.log_young()).head(6 * grasps) += scaled.head(6 * grasps);
}

}  // namespace palpate::estimation

#include "core/estimation/fused_state.hpp"

#include <algorithm>
#include <cmath>

#include "core/estimation/contact_search.hpp"

namespace palpate::estimation {

FusedState::FusedState(int grasps, const WrenchFilter::Options& options)
    : filter(grasps, options),
      motion(filter.shape_size()),
      shift(WrenchFilter::ShapeState::Zero(filter.shape_size())) {}

void FusedState::reset() noexcept {
  filter.reset();
  shift.setZero();
}

WrenchFilter::ShapeState FusedState::applied() const noexcept {
  return filter.mean().head(filter.shape_size()) + shift;
}

double FusedState::stiffness() const noexcept {
  constexpr double kMost = 3;  // a factor of 20
  const int i = filter.log_young();
  return std::exp(std::clamp(filter.mean()[i] + shift[i], -kMost, kMost));
}

math::Pose FusedState::correction(int grasp) const noexcept {
  const int first = filter.offset(grasp);
  const math::Vector6d offset = filter.mean().segment<6>(first) + shift.segment<6>(first);
  return math::make_pose(math::exp_rotation(offset.tail<3>()), offset.head<3>());
}

WrenchFilter::Rows FusedState::wrench_rows(
    const std::array<bool, 2>& held, const elasticity::DeformationModel& model) const noexcept {
  const int rows = 6 * (static_cast<int>(held[0]) + static_cast<int>(held[1]));
  WrenchFilter::Rows H = WrenchFilter::Rows::Zero(rows, filter.size());
  for (int g = 0, row = 0; g < filter.grasp_count(); ++g) {
    if (!held[g]) continue;
    H.block(row, 0, 6, filter.load()) =
        stiffness() * motion.wrench_by_state().block(6 * g, 0, 6, filter.load());
    H.block<6, 6>(row, filter.bias(g)) = math::both_halves(X_OG[g].linear());
    if (filter.has_contact()) H.block<6, 3>(row, filter.contact()) = contact_response(g, model);
    row += 6;
  }
  return H;
}

Eigen::Matrix<double, 6, 3> FusedState::contact_response(
    int grasp, const elasticity::DeformationModel& model) const noexcept {
  return ContactSearch::response(contact_point, model.sensitivity(), motion, grasp);
}

SurfaceFit::Basis FusedState::basis(const elasticity::DeformationModel& model) const noexcept {
  SurfaceFit::Basis basis;
  basis.sensitivity = &model.sensitivity();
  basis.filter = &filter;
  basis.motion = &motion;
  basis.held = held_grasps(model, filter.grasp_count());
  return basis;
}

math::Vector6d FusedState::wrench_of_shift(
    int grasp, const elasticity::DeformationModel& model) const noexcept {
  if (!model.sensitivity().valid) return math::Vector6d::Zero();
  WrenchFilter::ShapeState off = shift;
  if (filter.has_loads())
    off.segment<WrenchFilter::kLoads>(filter.load()) +=
        filter.mean().segment<WrenchFilter::kLoads>(filter.load());
  return stiffness() * motion.wrench_by_state().middleRows<6>(6 * grasp) * off;
}

void FusedState::load_with_contact(elasticity::DeformationModel& model) const noexcept {
  if (!filter.has_contact()) return;
  const Eigen::Vector3d force = filter.mean().tail<3>() / stiffness();
  for (int i = 0; i < contact_point.count; ++i)
    model.loads().col(contact_point.nodes[i]) += contact_point.weights[i] * force;
}

std::array<bool, 2> held_grasps(const elasticity::DeformationModel& model, int grasps) noexcept {
  std::array<bool, 2> held{};
  for (int g = 0; g < grasps; ++g) held[g] = model.is_held(g);
  return held;
}

}  // namespace palpate::estimation

#include "core/estimation/consistency/cause_responses.hpp"

#include <algorithm>
#include <limits>

namespace palpate::estimation {
namespace {

using Eigen::Vector3d;

Vector3d centre_of(const Eigen::Matrix3Xd& nodes, const std::vector<int>& chosen) {
  Vector3d sum = Vector3d::Zero();
  for (const int node : chosen) sum += nodes.col(node);
  return sum / static_cast<double>(chosen.size());
}

/// Rigid motion, about the origin of a frame at `p`, of a body that moves by (m, rad) about `c`.
math::Matrix6d about(const Vector3d& c, const Vector3d& p) {
  math::Matrix6d moved = math::Matrix6d::Identity();
  moved.topRightCorner<3, 3>() = -math::cross_matrix(p - c);
  return moved;
}

}  // namespace

CauseResponses::CauseResponses(const elasticity::Body& body, const mesh::Surface& surface)
    : nodal_mass_(elasticity::ElementSet(body).nodal_mass()),
      has_clamp_(!body.fixed_nodes.empty()) {
  if (has_clamp_) clamp_O_ = centre_of(body.mesh.nodes, body.fixed_nodes);
  if (body.gravity_O.norm() > 0) gravity_ = body.gravity_O.normalized();
  choose_places(body, surface);
  divide(body);
}

/// Candidates that are as far apart as possible.
void CauseResponses::choose_places(const elasticity::Body& body, const mesh::Surface& surface) {
  const Vector3d size = body.mesh.nodes.rowwise().maxCoeff() - body.mesh.nodes.rowwise().minCoeff();
  const std::vector<ContactSearch::Place> all =
      contact_places(body, surface, size.maxCoeff() / kPlaces);
  std::vector<double> distance(all.size(), std::numeric_limits<double>::infinity());
  std::size_t next = 0;
  while (places_.size() < std::min<std::size_t>(kPlaces, all.size())) {
    places_.push_back(all[next]);
    const Vector3d chosen = all[next].point.interpolate(body.mesh.nodes);
    for (std::size_t i = 0; i < all.size(); ++i)
      distance[i] =
          std::min(distance[i], (all[i].point.interpolate(body.mesh.nodes) - chosen).norm());
    next = static_cast<std::size_t>(std::max_element(distance.begin(), distance.end()) -
                                    distance.begin());
  }
  locations_.resize(places_.size());
  inward_.resize(places_.size());
}

void CauseResponses::divide(const elasticity::Body& body) {
  const mesh::ElementMesh& mesh = body.mesh;
  const Vector3d hand = centre_of(mesh.nodes, body.grasps[0].nodes);
  const Vector3d other = has_clamp_               ? clamp_O_
                         : body.grasps.size() > 1 ? centre_of(mesh.nodes, body.grasps[1].nodes)
                                                  : Vector3d(mesh.nodes.rowwise().mean());
  const Vector3d along = hand - other, middle = 0.5 * (hand + other);
  for (const bool is_at_hand : {false, true}) {
    std::vector<int> elements;
    for (int e = 0; e < mesh.element_count(); ++e) {
      Vector3d centre = Vector3d::Zero();
      for (int i = 0; i < 4; ++i) centre += mesh.nodes.col(mesh.elements(i, e)) / 4;
      if ((along.dot(centre - middle) > 0) == is_at_hand) elements.push_back(e);
    }
    mesh::ElementMesh half = mesh;
    half.elements.resize(mesh.elements.rows(), static_cast<Eigen::Index>(elements.size()));
    std::vector<elasticity::Lame> materials;
    for (std::size_t i = 0; i < elements.size(); ++i) {
      half.elements.col(static_cast<Eigen::Index>(i)) = mesh.elements.col(elements[i]);
      materials.push_back(elasticity::lame(body.material_of(elements[i])));
    }
    halves_.push_back({elasticity::MeshForces(half, {std::move(materials), body.law}),
                       Eigen::Matrix3Xd::Zero(3, mesh.node_count())});
  }
}

math::Vector6d CauseResponses::response(int grasp, const Eigen::Matrix3Xd& forces,
                                        const FusedState& state,
                                        const elasticity::DeformationModel& model) const noexcept {
  const Eigen::Map<const Eigen::VectorXd> stacked(forces.data(), forces.size());
  math::Vector6d wrench = math::Vector6d::Zero();
  for (int other = 0; other < state.filter.grasp_count(); ++other) {
    if (!model.is_held(other)) continue;
    const math::Vector6d held = -(model.sensitivity().dx_dxi[other].transpose() * stacked);
    wrench.noalias() += state.motion.felt().block<6, 6>(6 * grasp, 6 * other) * held;
  }
  return wrench;
}

Eigen::Matrix<double, 6, 3> CauseResponses::gravity_response(
    int grasp, const FusedState& state, const elasticity::DeformationModel& model) const noexcept {
  Eigen::Matrix<double, 6, 3> result = Eigen::Matrix<double, 6, 3>::Zero();
  for (int other = 0; other < state.filter.grasp_count(); ++other) {
    if (!model.is_held(other)) continue;
    Eigen::Matrix<double, 6, 3> held = Eigen::Matrix<double, 6, 3>::Zero();
    for (Eigen::Index i = 0; i < nodal_mass_.size(); ++i)
      held -= nodal_mass_[i] * model.sensitivity().dx_dxi[other].middleRows<3>(3 * i).transpose();
    result.noalias() += state.motion.felt().block<6, 6>(6 * grasp, 6 * other) * held;
  }
  return result;
}

/// A clamp that moves takes the object, its hands and, relative to the object, gravity with it;
/// then the hands and gravity return to where they are.
void CauseResponses::update_clamp(const FusedState& state,
                                  const elasticity::DeformationModel& model) noexcept {
  const int grasps = state.filter.grasp_count();
  const Vector3d g_O = model.body().gravity_O;
  Vector3d force = nodal_mass_.sum() * g_O;  // of the object on the clamp
  Vector3d torque = (model.positions() * nodal_mass_ - nodal_mass_.sum() * clamp_O_).cross(g_O);
  for (int g = 0; g < grasps; ++g) {
    if (!model.is_held(g)) continue;
    const math::Vector6d w = state.stiffness() * model.reaction(g).vector();
    force += w.head<3>();
    torque += w.tail<3>() + (state.X_OG[g].translation() - clamp_O_).cross(Vector3d(w.head<3>()));
  }
  for (int g = 0; g < grasps; ++g) {
    Hand& hand = hands_[g];
    hand.clamp_place.setZero();
    hand.clamp_compliance.setZero();
    if (!model.is_held(g) || !has_clamp_) continue;
    const math::Vector6d w = state.stiffness() * model.reaction(g).vector();
    hand.clamp_place.topRightCorner<3, 3>() = -math::cross_matrix(w.head<3>());
    hand.clamp_place.bottomRightCorner<3, 3>() = -math::cross_matrix(w.tail<3>());
    hand.clamp_place.rightCols<3>() += gravity_response(g, state, model) * math::cross_matrix(g_O);
    for (int other = 0; other < grasps; ++other) {
      if (!model.is_held(other)) continue;
      const auto moved =
          state.motion.wrench_by_state().block<6, 6>(6 * g, state.filter.offset(other));
      hand.clamp_place -= state.stiffness() * moved *
                          math::both_halves(state.X_OG[other].linear().transpose()) *
                          about(clamp_O_, state.X_OG[other].translation());
    }
    hand.clamp_compliance.col(0) = hand.clamp_place.leftCols<3>() * force;
    hand.clamp_compliance.col(1) = hand.clamp_place.rightCols<3>() * torque;
  }
}

void CauseResponses::update(const FusedState& state,
                            const elasticity::DeformationModel& model) noexcept {
  const Eigen::Matrix3Xd& x = model.positions();
  for (std::size_t i = 0; i < places_.size(); ++i) {
    locations_[i] = places_[i].point.interpolate(x);
    const Eigen::Vector3i& corners = places_[i].corners;
    const Vector3d corner = x.col(corners[0]);
    inward_[i] = -(x.col(corners[1]) - corner).cross(x.col(corners[2]) - corner).normalized();
  }
  for (Half& half : halves_) half.forces.evaluate(x, half.nodal);
  update_clamp(state, model);
  for (int g = 0; g < state.filter.grasp_count(); ++g) {
    Hand& hand = hands_[g];
    for (int k = 0; k < 2; ++k)
      hand.uneven_stiffness.col(k) =
          -state.stiffness() *
          response(g, halves_[static_cast<std::size_t>(k)].nodal, state, model);
    for (std::size_t i = 0; i < places_.size(); ++i)
      hand.force[i] =
          ContactSearch::response(places_[i].point, model.sensitivity(), state.motion, g);
  }
  const math::Matrix6d K = state.stiffness() * model.sensitivity().dw_dxi[0][0];
  own_compliance_ << 3 / K.topLeftCorner<3, 3>().trace(), 3 / K.bottomRightCorner<3, 3>().trace();
}

}  // namespace palpate::estimation

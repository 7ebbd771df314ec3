#include "core/estimation/node_deviations.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/math/option_check.hpp"

namespace palpate::estimation {
namespace {

/// Deviations as fractions of the displacement that explains a contradicting wrench: of all nodes,
/// and of each node as far as it follows the hand.
constexpr double kAnywhere = 0.15, kWithHand = 0.3;

}  // namespace

NodeDeviations::NodeDeviations(int nodes, double own, const WrenchConsistency::Options& material,
                               const Options& options)
    : own_(own),
      poisson_(material.poisson),
      density_(material.density),
      options_(options),
      deviations_(static_cast<std::size_t>(nodes), 0.0F) {
  math::check_not_negative(own, "surface");
  math::check_not_negative(options.clamp, "clamp");
  math::check_not_negative(options.shape, "shape");
}

void NodeDeviations::reset() noexcept {
  std::fill(deviations_.begin(), deviations_.end(), 0.0F);
  narrow();
}

void NodeDeviations::widen(int hand, const math::Vector6d& wrench,
                           const FusedState& state) noexcept {
  // The least displacement, in units of these, that explains the wrench but for its noise.
  constexpr double kDistance = 0.1, kAngle = 1;     // m, rad
  constexpr double kForce = 0.03, kTorque = 0.003;  // N, N m
  math::Vector6d size, noise;
  size << Eigen::Vector3d::Constant(kDistance), Eigen::Vector3d::Constant(kAngle);
  noise << Eigen::Vector3d::Constant(kForce), Eigen::Vector3d::Constant(kTorque);
  const int offset = state.filter.offset(hand);
  const math::Matrix6d R = math::both_halves(state.X_OG[static_cast<std::size_t>(hand)].linear());
  const math::Matrix6d K = state.stiffness() *
                           state.motion.wrench_by_state().block<6, 6>(offset, offset) *
                           R.transpose();
  const math::Matrix6d DK = size.cwiseAbs2().asDiagonal() * K.transpose();
  math::Matrix6d S = K * DK;
  S.diagonal() += noise.cwiseAbs2();
  hand_ = hand;
  displacement_ = DK * S.ldlt().solve(wrench);
  if (!displacement_.allFinite()) displacement_.setZero();
}

/// m^2, of the place of the object, of its material, and of the shape between clamp and hand.
double NodeDeviations::variance_of_model(int node, bool is_observed,
                                         const elasticity::DeformationModel& model) const noexcept {
  std::array<double, 2> follows{};  // share of a hand's displacement that the node makes
  for (std::size_t g = 0; g < model.body().grasps.size(); ++g)
    if (model.is_held(static_cast<int>(g)))
      follows[g] = std::min(
          1.0, model.sensitivity().dx_dxi[g].block<3, 3>(3 * node, 0).norm() / std::sqrt(3.0));
  const double displacement =
      (model.positions().col(node) - model.body().mesh.nodes.col(node)).norm();
  const double between = 4 * follows[0] * (1 - follows[0]);
  const double shape = between * options_.shape * displacement;
  const auto by_material = model.sensitivity().dx_dparameter.middleRows<3>(3 * node);
  const double poisson = poisson_ * by_material.col(elasticity::Sensitivity::kPoisson).norm();
  const double density = density_ * by_material.col(elasticity::Sensitivity::kLogDensity).norm();
  // An observed shape corrects the hands' points, but not those of the clamp.
  const double clamp =
      options_.clamp * (is_observed ? std::max(0.0, 1 - follows[0] - follows[1]) : 1);
  return clamp * clamp + shape * shape + (poisson * poisson + density * density) / 3;
}

void NodeDeviations::update(const FusedState& state,
                            const elasticity::DeformationModel& model) noexcept {
  if (!model.sensitivity().valid) return;
  const WrenchFilter& filter = state.filter;
  const SurfaceFit::Basis now = state.basis(model);
  const int columns = filter.has_loads() ? filter.shape_size() : filter.load();
  SurfaceFit::NodeRows rows, J(3, columns), JP(3, columns);
  const double anywhere = kAnywhere * displacement_.head<3>().norm();
  const double own = own_ * own_ + anywhere * anywhere;
  const int nodes = static_cast<int>(deviations_.size());
  for (int i = 0; i < nodes / 10 + 1; ++i, next_ = (next_ + 1) % nodes) {
    rows.setZero(3, filter.shape_size());
    SurfaceFit::add_node(now, next_, 1, rows);
    J.noalias() = rows * state.motion.by_state().leftCols(columns);
    JP.noalias() = J * filter.covariance().topLeftCorner(columns, columns);
    const Eigen::Vector3d with_hand =
        kWithHand * rows.middleCols<6>(filter.offset(hand_)) * displacement_;
    const double variance = JP.cwiseProduct(J).sum() / 3 + with_hand.squaredNorm() / 3 + own +
                            variance_of_model(next_, filter.has_loads(), model);
    deviations_[static_cast<std::size_t>(next_)] =
        static_cast<float>(std::sqrt(std::max(0.0, variance)));
  }
}

}  // namespace palpate::estimation

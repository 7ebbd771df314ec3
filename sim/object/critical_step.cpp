#include "sim/object/critical_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace palpate::object {
namespace {

constexpr int kPowerIterations = 150;

/// Largest eigenvalue of M^-1 A by power iteration. `apply(direction, out)` writes A direction;
/// rows of fixed nodes must be zero.
template <class Operator>
double greatest_eigenvalue(const Eigen::VectorXd& masses, const Operator& apply) {
  std::minstd_rand generator(1);
  Eigen::Matrix3Xd direction(3, masses.size());
  for (double& value : direction.reshaped()) {
    value = static_cast<double>(generator()) / std::minstd_rand::max() - 0.5;
  }
  Eigen::Matrix3Xd image(3, masses.size());
  double eigenvalue = 0;
  for (int i = 0; i < kPowerIterations; ++i) {
    direction /= direction.norm();
    apply(direction, image);
    image.array().rowwise() /= masses.transpose().array();
    eigenvalue = image.norm();
    if (!(eigenvalue > 0)) return 0;
    direction = image;
  }
  return eigenvalue;
}

}  // namespace

double critical_step(const HexahedralGrid& grid, NeoHookeanSolid solid,
                     const Eigen::VectorXd& masses, const Eigen::VectorXd& springs,
                     const std::vector<int>& held) {
  const Eigen::Matrix3Xd still = Eigen::Matrix3Xd::Zero(3, grid.node_count());
  const auto hold = [&held](Eigen::Matrix3Xd& values, const Eigen::Matrix3Xd& at) {
    for (const int n : held) values.col(n) = at.col(n);
  };
  double shortest = std::numeric_limits<double>::infinity();
  for (int e = 0; e < grid.element_count(); ++e)
    shortest = std::min(shortest, grid.element_size(e).minCoeff());
  const double tiny = 1e-6 * shortest;
  Eigen::Matrix3Xd moved(3, grid.node_count());
  Eigen::Matrix3Xd back(3, grid.node_count());
  const double stiffest = greatest_eigenvalue(masses, [&](const auto& direction, auto& out) {
    out.setZero();
    back.setZero();
    moved = grid.nodes() - tiny * direction;
    hold(moved, grid.nodes());
    solid.add_forces(moved, still, 0, out);
    moved = grid.nodes() + tiny * direction;
    hold(moved, grid.nodes());
    solid.add_forces(moved, still, 0, back);
    out = (out - back) / (2 * tiny);
    out.array() += direction.array().rowwise() * springs.transpose().array();
    hold(out, still);
  });
  const double frequency = std::sqrt(stiffest);
  if (solid.viscosity() == 0) return 2 / frequency;

  const double damping = greatest_eigenvalue(masses, [&](const auto& direction, auto& out) {
    out.setZero();
    moved = -direction;
    hold(moved, still);
    solid.add_forces(grid.nodes(), moved, 0, out);
    hold(out, still);
  });
  const double xi = damping / (2 * frequency);
  return 2 / frequency * (std::sqrt(xi * xi + 1) - xi);
}

}  // namespace palpate::object

#pragma once

#include <memory>
#include <optional>

#include "core/elasticity/body.hpp"
#include "core/elasticity/sensitivity.hpp"

namespace palpate::elasticity {

/// Poses of the hands, if held.
using HeldPoses = std::array<std::optional<math::Pose>, 2>;

/// Displacements (3 x n, m) of small-displacement statics, K u = loads + weight, with fixed nodes
/// at zero and no grasp held. loads: 3 x n, N. Throws std::invalid_argument for an invalid body,
/// std::runtime_error if K is not positive definite.
Eigen::Matrix3Xd solve_linear_statics(const Body& body, const Eigen::Matrix3Xd& loads);

struct StaticOptions {
  int iterations = 100;      // maximum number of Newton steps per load step
  double tolerance = 1e-10;  // N, largest unbalanced nodal force
  int load_steps = 64;       // maximum number; the load is divided only if Newton's method fails
};

struct StaticSolution {
  bool converged = false;
  int iterations = 0;   // total number of Newton steps
  int load_steps = 0;   // number of load steps that were necessary
  double residual = 0;  // N, largest over free nodes
  Eigen::Matrix3Xd positions;
  Eigen::Matrix3Xd reactions;  // N, force that holds each fixed or grasped node; zero elsewhere
};

/// Co-rotational equilibrium by full Newton with line search, offline: factors in every step. Knows
/// no obstacles. Reuses the elimination order for all equilibria of a body.
class StaticSolver {
 public:
  /// Throws std::invalid_argument for an invalid body.
  explicit StaticSolver(const Body& body);
  ~StaticSolver();

  /// loads: 3 x n, N, in addition to weight. `start`: initial positions; default: the rest shape.
  StaticSolution solve(const Eigen::Matrix3Xd& loads, const HeldPoses& held = {},
                       const StaticOptions& options = {}, const Eigen::Matrix3Xd* start = nullptr);

  /// As solve_linear_statics().
  Eigen::Matrix3Xd solve_linear(const Eigen::Matrix3Xd& loads);

  /// Sensitivity of the last solve() to hands, material and loads. Its `valid` is false if the
  /// equilibrium is not stable.
  Sensitivity response();

 private:
  class Newton;
  std::unique_ptr<Newton> newton_;
};

/// Single equilibrium with a temporary StaticSolver.
StaticSolution solve_static(const Body& body, const Eigen::Matrix3Xd& loads,
                            const HeldPoses& held = {}, const StaticOptions& options = {},
                            const Eigen::Matrix3Xd* start = nullptr);

/// Wrench about the origin of G, in O, of the nodal forces on the patch of a grasp held at X_OG.
math::Wrench patch_wrench(const GraspRegion& grasp, const math::Pose& X_OG,
                          const Eigen::Matrix3Xd& positions, const Eigen::Matrix3Xd& forces);

}  // namespace palpate::elasticity

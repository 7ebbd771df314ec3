#pragma once

#include <memory>
#include <optional>

#include "core/elasticity/body.hpp"
#include "core/elasticity/sensitivity.hpp"

namespace palpate::elasticity {

/// Poses of the hands, where held.
using HeldPoses = std::array<std::optional<math::Pose>, 2>;

/// Displacements (3 x n, m) of small-displacement statics, K u = loads + weight, fixed nodes at
/// zero and nothing grasped. loads: 3 x n, N. Throws std::invalid_argument for an invalid body,
/// std::runtime_error where K is not positive definite.
Eigen::Matrix3Xd solve_linear_statics(const Body& body, const Eigen::Matrix3Xd& loads);

struct StaticOptions {
  int iterations = 100;      // Newton steps per load step at most
  double tolerance = 1e-10;  // N, largest nodal force out of balance
  int load_steps = 64;       // at most; the load is split only where Newton fails
};

struct StaticSolution {
  bool converged = false;
  int iterations = 0;   // Newton steps in all
  int load_steps = 0;   // that the load had to be split into
  double residual = 0;  // N, largest over free nodes
  Eigen::Matrix3Xd positions;
  Eigen::Matrix3Xd reactions;  // N, what holds each fixed or grasped node; zero elsewhere
};

/// Co-rotational equilibrium by full Newton with line search, off line: factors in every step.
/// Keeps the order of elimination from one equilibrium of a body to the next.
class StaticSolver {
 public:
  /// Throws std::invalid_argument for an invalid body.
  explicit StaticSolver(const Body& body);
  ~StaticSolver();

  /// loads: 3 x n, N, beside weight. `start`: positions to begin with, else the rest shape.
  StaticSolution solve(const Eigen::Matrix3Xd& loads, const HeldPoses& held = {},
                       const StaticOptions& options = {}, const Eigen::Matrix3Xd* start = nullptr);

  /// As solve_linear_statics().
  Eigen::Matrix3Xd solve_linear(const Eigen::Matrix3Xd& loads);

  /// How the equilibrium of the last solve() follows hands, material and loads. Its valid is false
  /// where the equilibrium is not stable.
  Sensitivity response();

 private:
  class Newton;
  std::unique_ptr<Newton> newton_;
};

/// One equilibrium by a StaticSolver of its own.
StaticSolution solve_static(const Body& body, const Eigen::Matrix3Xd& loads,
                            const HeldPoses& held = {}, const StaticOptions& options = {},
                            const Eigen::Matrix3Xd* start = nullptr);

/// Wrench about the origin of G, in O, of nodal forces on the patch of a grasp held at X_OG.
math::Wrench patch_wrench(const GraspRegion& grasp, const math::Pose& X_OG,
                          const Eigen::Matrix3Xd& positions, const Eigen::Matrix3Xd& forces);

}  // namespace palpate::elasticity

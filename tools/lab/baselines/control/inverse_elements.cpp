#include "tools/lab/baselines/control/inverse_elements.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <stdexcept>

#include "core/control/jacobian_providers.hpp"
#include "core/elasticity/static_solver.hpp"
#include "core/math/singular_values.hpp"

namespace palpate::baselines {
namespace {

math::Pose moved(const math::Pose& X, const math::Vector6d& step) {
  math::Pose to = X;
  to.translation() += step.head<3>();
  to.linear() = math::exp_rotation(step.tail<3>()) * X.linear();
  return to;
}

}  // namespace

InverseSolution solve_inverse(const elasticity::Body& body, int grasp, shape::Feature& feature,
                              const Eigen::VectorXd& target, const InverseOptions& options) {
  if (grasp < 0 || grasp >= static_cast<int>(body.grasps.size()))
    throw std::invalid_argument("nothing is grasped");
  if (target.size() != feature.value_count())
    throw std::invalid_argument("the target has another size than the feature");
  const elasticity::GraspRegion& region = body.grasps[grasp];
  elasticity::StaticSolver solver(body);
  const Eigen::Matrix3Xd no_loads = Eigen::Matrix3Xd::Zero(3, body.mesh.node_count());
  Eigen::VectorXd value(feature.value_count()), error(feature.dimension());
  Eigen::MatrixXd J(feature.dimension(), 6);
  const math::Vector6d scale =
      (math::Vector6d() << 1, 1, 1, 1 / options.length, 1 / options.length, 1 / options.length)
          .finished();

  InverseSolution best;
  best.error = std::numeric_limits<double>::infinity();
  math::Pose X = region.X_OG_rest;
  Eigen::Matrix3Xd shape = body.mesh.nodes;
  math::Vector6d step = math::Vector6d::Zero();
  for (best.iterations = 0; best.iterations < options.iterations; ++best.iterations) {
    elasticity::HeldPoses held;
    held[grasp] = X;
    const elasticity::StaticSolution now = solver.solve(no_loads, held, {}, &shape);
    bool better = false;
    if (now.converged) {
      feature.evaluate(now.positions, value);
      feature.error(value, target, error);
      better = error.norm() < best.error;
    }
    if (!better) {  // undo, and reduce the step
      step *= 0.5;
      if (!(step.norm() > options.tolerance)) break;
      X = moved(best.X_OG, step);
      continue;
    }
    const elasticity::Sensitivity response = solver.response();
    if (!response.valid) break;
    shape = now.positions;
    best.error = error.norm();
    best.X_OG = X;
    best.F_G_O = elasticity::patch_wrench(region, X, now.positions, now.reactions);
    best.stiffness = response.dw_dxi[grasp][grasp];
    control::accumulate_support(
        feature,
        [&](int node) -> Eigen::Matrix<double, 3, 6> {
          return response.dx_dxi[grasp].middleRows<3>(3 * node);
        },
        J);
    const Eigen::MatrixXd scaled = J * scale.asDiagonal();
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(scaled, Eigen::ComputeThinU | Eigen::ComputeThinV);
    const double floor = options.damping * svd.singularValues()[0];
    Eigen::VectorXd along = svd.matrixU().transpose() * error;
    for (int i = 0; i < along.size(); ++i) {
      const double s = svd.singularValues()[i];
      along[i] *= s / (s * s + floor * floor);
    }
    step = svd.matrixV() * along;
    if (step.norm() > options.longest) step *= options.longest / step.norm();
    if (step.norm() < options.tolerance) {
      best.converged = true;
      break;
    }
    step = step.cwiseProduct(scale);
    X = moved(best.X_OG, step);
  }
  best.converged = best.converged || best.error < std::numeric_limits<double>::infinity();
  return best;
}

}  // namespace palpate::baselines

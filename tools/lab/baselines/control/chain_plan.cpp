#include "tools/lab/baselines/control/chain_plan.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <stdexcept>

#include "tools/lab/baselines/control/feature_view.hpp"

namespace palpate::baselines {

InverseSolution plan_with_chain(const elasticity::Body& body, int grasp,
                                const shape::Feature& feature, const Eigen::VectorXd& target,
                                const ChainPlanOptions& options) {
  check_points(feature);
  if (target.size() != feature.value_count())
    throw std::invalid_argument("the target has another size than the feature");
  const RheologicalChain at_rest(options.chain, body, grasp);
  const math::Pose X_rest = body.grasps[grasp].X_OG_rest;
  // pose from a displacement from rest (m, scaled rotation)
  const auto pose = [&](const math::Vector6d& way) {
    math::Pose X = X_rest;
    X.translation() += way.head<3>();
    X.linear() = math::exp_rotation(way.tail<3>() / options.length) * X.linear();
    return X;
  };
  const auto shape_after = [&](const math::Vector6d& way) {
    RheologicalChain chain = at_rest;
    const double moving = std::clamp(way.norm() / options.linear_speed, 0.1, 0.9 * options.until);
    constexpr int kMoves = 10, kHolds = 10;
    for (int i = 1; i <= kMoves; ++i) chain.step(pose(way * i / kMoves), moving / kMoves);
    for (int i = 0; i < kHolds; ++i) chain.step(pose(way), (options.until - moving) / kHolds);
    return chain.points(feature.rest_points());
  };
  InverseSolution best;
  best.X_OG = X_rest;
  math::Vector6d way = math::Vector6d::Zero();
  Eigen::VectorXd error = target - shape_after(way);
  best.error = error.norm();
  for (; best.iterations < options.iterations; ++best.iterations) {
    constexpr double kProbe = 1e-3;
    Eigen::MatrixXd J(target.size(), 6);
    for (int k = 0; k < 6; ++k) {
      const math::Vector6d probe = kProbe * math::Vector6d::Unit(k);
      J.col(k) = (shape_after(way + probe) - shape_after(way - probe)) / (2 * kProbe);
    }
    math::Matrix6d normal = J.transpose() * J;
    normal.diagonal().array() += 1e-4 * normal.trace();
    math::Vector6d step = normal.ldlt().solve(J.transpose() * error);
    if (step.norm() > 0.03) step *= 0.03 / step.norm();
    bool better = false;
    for (int halvings = 0; halvings < 6 && !better; ++halvings, step *= 0.5) {
      const Eigen::VectorXd next = target - shape_after(way + step);
      if (!(next.norm() < best.error - 1e-7)) continue;
      better = true;
      way += step;
      error = next;
      best.error = next.norm();
    }
    if (!better) break;
  }
  best.X_OG = pose(way);
  best.converged = true;
  return best;
}

}  // namespace palpate::baselines

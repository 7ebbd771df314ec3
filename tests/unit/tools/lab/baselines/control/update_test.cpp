// Learning of Jacobians, on features that are linear in the hand's motion.

#include <gtest/gtest.h>

#include "core/math/random.hpp"
#include "tools/lab/baselines/control/broyden_update.hpp"
#include "tools/lab/baselines/control/factored_update.hpp"
#include "tools/lab/baselines/control/gradient_update.hpp"
#include "tools/lab/baselines/control/weighted_least_squares_update.hpp"

namespace palpate::baselines {
namespace {

Eigen::MatrixXd random_matrix(math::Random& random, int rows, int columns) {
  Eigen::MatrixXd m(rows, columns);
  for (Eigen::Index i = 0; i < m.size(); ++i) m.data()[i] = random.normal();
  return m;
}

/// Error of J after `steps` random motions of 1 mm.
double error_after(JacobianUpdate& update, int steps, double noise = 0) {
  math::Random random(7);
  const Eigen::MatrixXd truth = random_matrix(random, 3, 6);
  Eigen::MatrixXd J = truth + 0.5 * random_matrix(random, 3, 6);
  update.resize(3);
  for (int i = 0; i < steps; ++i) {
    const ScaledMotion motion = 1e-3 * random_matrix(random, 6, 1);
    const Eigen::VectorXd change = truth * motion + noise * random_matrix(random, 3, 1);
    update.learn(motion, change, false, J);
  }
  return (J - truth).norm() / truth.norm();
}

TEST(BroydenUpdate, MeetsTheSecantAndLeavesOtherDirectionsAlone) {
  math::Random random(3);
  Eigen::MatrixXd J = random_matrix(random, 4, 6);
  const Eigen::MatrixXd before = J;
  const ScaledMotion motion = random_matrix(random, 6, 1);
  const Eigen::VectorXd change = random_matrix(random, 4, 1);
  BroydenUpdate update(1);
  update.resize(4);
  update.learn(motion, change, false, J);
  EXPECT_LT((J * motion - change).norm(), 1e-12);
  ScaledMotion across = random_matrix(random, 6, 1);
  across -= motion * (motion.dot(across) / motion.squaredNorm());
  EXPECT_LT((J * across - before * across).norm(), 1e-12);
}

TEST(BroydenUpdate, FindsALinearFeatureAndLeavesProbesToOthers) {
  BroydenUpdate update(1);
  EXPECT_LT(error_after(update, 100), 1e-3);
  Eigen::MatrixXd J = Eigen::MatrixXd::Ones(3, 6);
  update.learn(ScaledMotion::Ones(), Eigen::VectorXd::Zero(3), true, J);
  EXPECT_EQ(J, Eigen::MatrixXd::Ones(3, 6));
  update.learn(ScaledMotion::Zero(), Eigen::VectorXd::Ones(3), false, J);
  EXPECT_EQ(J, Eigen::MatrixXd::Ones(3, 6)) << "a motion of nothing says nothing";
  EXPECT_THROW(BroydenUpdate(0), std::invalid_argument);
  EXPECT_THROW(BroydenUpdate(1.5), std::invalid_argument);
}

TEST(FactoredUpdate, FindsALinearFeature) {
  FactoredUpdate update(1);
  EXPECT_LT(error_after(update, 600), 1e-2);
  Eigen::MatrixXd nothing = Eigen::MatrixXd::Zero(3, 6);
  update.forget();
  update.learn(ScaledMotion::Ones(), Eigen::VectorXd::Ones(3), false, nothing);
  EXPECT_TRUE(nothing.allFinite());
  EXPECT_THROW(FactoredUpdate(0), std::invalid_argument);
}

TEST(GradientUpdate, FindsALinearFeatureMoreSlowlyAndBearsNoise) {
  GradientUpdate quick({1.0, 1e-3}), slow({0.05, 1e-3});
  EXPECT_LT(error_after(quick, 400), 1e-3);
  EXPECT_LT(error_after(slow, 3000), 1e-2);
  BroydenUpdate broyden(1);
  const double noise = 0.5e-3;  // half a motion's size
  EXPECT_LT(error_after(slow, 3000, noise), 0.5 * error_after(broyden, 3000, noise));
  EXPECT_THROW(GradientUpdate({2, 0}), std::invalid_argument);
  EXPECT_THROW(GradientUpdate({1, -1}), std::invalid_argument);
}

TEST(WeightedLeastSquares, IsExactAfterOneWindowAndAveragesNoise) {
  WeightedLeastSquaresUpdate update({25, 1.0, 1e-6});
  EXPECT_LT(error_after(update, 25), 1e-9);
  BroydenUpdate broyden(1);
  EXPECT_LT(error_after(update, 200, 0.2e-3), 0.5 * error_after(broyden, 200, 0.2e-3));
}

TEST(WeightedLeastSquares, ChangesNothingAlongWhatHasNotBeenMoved) {
  math::Random random(5);
  Eigen::MatrixXd J = random_matrix(random, 3, 6);
  const Eigen::MatrixXd before = J;
  WeightedLeastSquaresUpdate update({25, 0.95, 0.05});
  update.resize(3);
  for (int i = 0; i < 40; ++i) {
    ScaledMotion motion = ScaledMotion::Zero();
    motion.head<2>() = 1e-3 * random_matrix(random, 2, 1);
    motion[5] = 1e-9;  // jitter
    update.learn(motion, random_matrix(random, 3, 1), false, J);
  }
  EXPECT_GT((J - before).leftCols<2>().norm(), 1);
  EXPECT_LT((J - before).rightCols<4>().norm(), 1e-2);
  EXPECT_THROW(WeightedLeastSquaresUpdate({5, 0.9, 0.1}), std::invalid_argument);
  EXPECT_THROW(WeightedLeastSquaresUpdate({25, 0, 0.1}), std::invalid_argument);
  EXPECT_THROW(WeightedLeastSquaresUpdate({25, 0.9, 1}), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::baselines

// Wrenches by a contact that may be open, compared with samples.
#include "core/estimation/consistency/uncertain_touch.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/unit/core/estimation/rigid_model.hpp"

namespace palpate::estimation {
namespace {

/// A model that presses on one obstacle, whose height and tilt are not known.
class TouchingModel : public support::RigidModel {
 public:
  explicit TouchingModel(double force)
      : RigidModel(support::held_bar({1, 1, 1}, mesh::ElementOrder::kLinear)) {
    elasticity::SurfaceContact contact;
    contact.force = {0.3 * force, 0, force};  // with friction
    contact.position = body().mesh.nodes.col(3);
    contacts_ = {contact};
    mutable_sensitivity().resize(body().mesh.node_count(), 2);
    mutable_sensitivity().dcontact_dobstacle[0] << 40, 3;
  }
  const std::vector<elasticity::SurfaceContact>& contacts() const noexcept override {
    return contacts_;
  }

  std::vector<elasticity::SurfaceContact> contacts_;
};

TEST(UncertainTouch, MeanRegressionAndVarianceAreThoseOfSamples) {
  const std::vector<collision::FreeDirection> directions{{0, 2, 0.01}, {0, 3, 0.1}};
  Eigen::Matrix2d known;
  known << 25e-6, 1e-5, 1e-5, 1e-4;
  const Eigen::Matrix2d root = known.llt().matrixL();
  math::Vector6d by_force;
  by_force << 0.1, 0, -0.6, 0, 0.05, 0;
  const double stiffness = 1.5;
  const Eigen::RowVector2d c = stiffness * Eigen::RowVector2d(40, 3);
  for (const double force : {0.01, 0.2, 1.0, 5.0}) {
    const TouchingModel model(force);
    UncertainTouch touch(directions);
    touch.take(model, stiffness);
    const UncertainTouch::Wrench wrench = touch.linearise(0, by_force * c, known, 1);
    ASSERT_EQ(wrench.by_direction.cols(), 2);

    constexpr int kSamples = 400000;
    std::mt19937_64 random(3);
    std::normal_distribution<double> normal;
    double sum = 0, square = 0;
    Eigen::Vector2d cross = Eigen::Vector2d::Zero();
    for (int i = 0; i < kSamples; ++i) {
      const double first = normal(random), second = normal(random);
      const Eigen::Vector2d d = root * Eigen::Vector2d(first, second);
      const double f = std::max(0.0, stiffness * force + c * d) / kSamples;
      sum += f;
      square += f * f * kSamples;
      cross += f * d;
    }
    const Eigen::RowVector2d regression = (known.inverse() * cross).transpose();
    const double variance = square - sum * sum;
    const double rest = variance - regression * known * regression.transpose();
    // a quarter of the wrench may be that of a force that acts elsewhere
    math::Matrix6d expected = rest * by_force * by_force.transpose();
    const double elsewhere = 0.0625 * variance;
    expected.diagonal().head<3>().array() += elsewhere * by_force.head<3>().squaredNorm();
    expected.diagonal().tail<3>().array() += elsewhere * by_force.tail<3>().squaredNorm();
    const double size = std::sqrt(c * known * c.transpose());
    EXPECT_LT((wrench.excess - by_force * (sum - stiffness * force)).norm(), 5e-3 * size) << force;
    EXPECT_LT((wrench.by_direction - by_force * regression).norm(), 0.02 * c.norm()) << force;
    EXPECT_LT((wrench.covariance - expected).norm(), 1e-2 * size * size) << force;
  }
}

TEST(UncertainTouch, OfAFirmContactIsLinear) {
  const TouchingModel model(10);
  UncertainTouch touch({{0, 2, 0.01}, {0, 3, 0.1}});
  touch.take(model, 1);
  elasticity::Sensitivity::ObstacleWrenches by_direction(6, 2);
  by_direction.setConstant(3);
  const UncertainTouch::Wrench wrench =
      touch.linearise(0, by_direction, Eigen::Vector2d(1e-6, 1e-6).asDiagonal().toDenseMatrix(), 1);
  EXPECT_LT((wrench.by_direction - by_direction).norm(), 1e-9);
  EXPECT_LT(wrench.excess.norm() + wrench.covariance.norm(), 1e-2);
}

TEST(UncertainTouch, OfAContactThatMayBeClosedInTruthIsAnUnknownForce) {
  TouchingModel model(0);
  model.hold(0, model.body().grasps[0].X_OG_rest);
  model.mutable_sensitivity().dx_dxi[0].middleRows<3>(9) << 0.4, 0, 0, 0, 0, 0,  //
      0, 0.4, 0, 0, 0, 0,                                                        //
      0, 0, 0.4, 0, -0.1, 0;
  const Eigen::Matrix2d known = Eigen::Vector2d(25e-6, 0).asDiagonal();
  math::Vector6d by_force;
  by_force << 0, 0, -0.4, 0, 0.1, 0;
  const double likely[] = {0.5, 0.1587, 0};
  const double gaps[] = {0, 5e-3, 15e-3};
  for (int i = 0; i < 3; ++i) {
    model.contacts_[0].gap = gaps[i];
    UncertainTouch touch({{0, 2, 0.01}, {0, 3, 0.1}});
    touch.take(model, 1);
    const elasticity::Sensitivity::ObstacleWrenches none =
        elasticity::Sensitivity::ObstacleWrenches::Zero(6, 2);
    const UncertainTouch::Wrench wrench = touch.linearise(0, none, known, 2);
    const double along = by_force.dot(wrench.covariance * by_force) / by_force.squaredNorm();
    EXPECT_NEAR(along, likely[i] * 64 * by_force.squaredNorm(), 0.07 * along);
    EXPECT_LT(wrench.covariance(0, 0), 0.1 * wrench.covariance(2, 2) + 1e-12) << "along the normal";
    EXPECT_TRUE(wrench.excess.isZero(0));
  }
}

}  // namespace
}  // namespace palpate::estimation

#include "core/control/marker_observer.hpp"

#include <gtest/gtest.h>

#include "core/shape/points_feature.hpp"
#include "rt/loop/allocation_counter.hpp"
#include "tests/unit/core/estimation/rigid_model.hpp"

namespace palpate::control {
namespace {

class Sight : public ::testing::Test {
 protected:
  Eigen::Matrix3Xd value(const MarkerObserver& sight) {
    Eigen::VectorXd v(9);
    feature_.evaluate(sight.positions(), v);
    return Eigen::Map<Eigen::Matrix3Xd>(v.data(), 3, 3);
  }

  elasticity::Body body_ = support::held_bar({6, 1, 1}, mesh::ElementOrder::kQuadratic);
  std::vector<Eigen::Vector3d> points_{{0.1, 0.01, 0.03}, {0.25, 0.03, 0.06}, {0.4, 0.05, 0.02}};
  shape::PointsFeature feature_{body_.mesh, {points_}};
  Eigen::Matrix3Xd model_ = body_.mesh.nodes;
  Eigen::Matrix3Xd seen_ =
      Eigen::Matrix3Xd::Random(3, 3) * 0.02 +
      (Eigen::Matrix3Xd(3, 3) << points_[0], points_[1], points_[2]).finished();
  const Eigen::Matrix3Xd nothing_ = Eigen::Matrix3Xd(3, 0);
};

TEST_F(Sight, FeaturesAreWhereTheirMarkersAreUntilSightIsLost) {
  MarkerObserver sight(body_.mesh, points_, {});
  EXPECT_FALSE(sight.sees());
  sight.look(false, 1e9, nothing_, model_);
  EXPECT_FALSE(sight.sees());
  sight.look(true, 0, seen_, model_);
  EXPECT_TRUE(sight.sees());
  EXPECT_TRUE(sight.fresh());
  EXPECT_LT((value(sight) - seen_).norm(), 1e-12);
  model_.array() += 0.01;  // the model's output meanwhile does not matter
  sight.look(false, 0.1, nothing_, model_);
  EXPECT_TRUE(sight.sees());
  EXPECT_FALSE(sight.fresh());
  EXPECT_LT((value(sight) - seen_).norm(), 1e-12);
  sight.look(false, 0.3, nothing_, model_);
  EXPECT_FALSE(sight.sees());
  sight.look(true, 0, seen_.leftCols(2), model_);
  EXPECT_FALSE(sight.fresh()) << "another number of markers";
}

TEST_F(Sight, WithTheModelItGoesOnFromWhereTheMarkersWere) {
  MarkerObserver sight(body_.mesh, points_, {MarkerObserver::Kind::kOffset, 0.2});
  sight.look(false, 1e9, nothing_, model_);
  EXPECT_TRUE(sight.sees()) << "the model alone";
  EXPECT_EQ(sight.positions(), model_);
  sight.look(true, 0, seen_, model_);
  EXPECT_LT((value(sight) - seen_).norm(), 1e-12);
  model_.array() += 0.01;
  sight.look(false, 5, nothing_, model_);
  EXPECT_TRUE(sight.sees());
  EXPECT_LT((value(sight) - (seen_.array() + 0.01).matrix()).norm(), 1e-12);
  sight.reset();
  sight.look(false, 5, nothing_, model_);
  EXPECT_EQ(sight.positions(), model_);
}

TEST_F(Sight, AllocatesNothing) {
  MarkerObserver sight(body_.mesh, points_, {});
  const loop::NoAllocationScope scope;
  for (int i = 0; i < 5; ++i) sight.look(i % 2 == 0, 0.01, seen_, model_);
  EXPECT_EQ(scope.count(), 0);
}

}  // namespace
}  // namespace palpate::control

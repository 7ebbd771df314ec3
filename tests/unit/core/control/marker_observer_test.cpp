#include "core/control/marker_observer.hpp"

#include <gtest/gtest.h>

#include "core/shape/point_features.hpp"
#include "rt/loop/allocation_counter.hpp"
#include "tests/unit/core/estimation/rigid_model.hpp"

namespace palpate::control {
namespace {

class MarkerObserverTest : public ::testing::Test {
 protected:
  Eigen::Matrix3Xd value(const MarkerObserver& observer) {
    Eigen::VectorXd v(9);
    feature_.evaluate(observer.positions(), v);
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

TEST_F(MarkerObserverTest, FeaturesFollowTheirMarkersUntilTheMarkersAreLost) {
  MarkerObserver observer(body_.mesh, points_, {});
  EXPECT_FALSE(observer.sees());
  observer.look(false, 1e9, nothing_, model_);
  EXPECT_FALSE(observer.sees());
  observer.look(true, 0, seen_, model_);
  EXPECT_TRUE(observer.sees());
  EXPECT_TRUE(observer.fresh());
  EXPECT_LT((value(observer) - seen_).norm(), 1e-12);
  model_.array() += 0.01;  // the model's output meanwhile does not matter
  observer.look(false, 0.1, nothing_, model_);
  EXPECT_TRUE(observer.sees());
  EXPECT_FALSE(observer.fresh());
  EXPECT_LT((value(observer) - seen_).norm(), 1e-12);
  observer.look(false, 0.3, nothing_, model_);
  EXPECT_FALSE(observer.sees());
  observer.look(true, 0, seen_.leftCols(2), model_);
  EXPECT_FALSE(observer.fresh()) << "another number of markers";
}

TEST_F(MarkerObserverTest, WithTheModelItContinuesFromTheLastMarkers) {
  MarkerObserver observer(body_.mesh, points_, {MarkerObserver::Kind::kOffset, 0.2});
  observer.look(false, 1e9, nothing_, model_);
  EXPECT_TRUE(observer.sees()) << "the model alone";
  EXPECT_EQ(observer.positions(), model_);
  observer.look(true, 0, seen_, model_);
  EXPECT_LT((value(observer) - seen_).norm(), 1e-12);
  model_.array() += 0.01;
  observer.look(false, 5, nothing_, model_);
  EXPECT_TRUE(observer.sees());
  EXPECT_LT((value(observer) - (seen_.array() + 0.01).matrix()).norm(), 1e-12);
  observer.reset();
  observer.look(false, 5, nothing_, model_);
  EXPECT_EQ(observer.positions(), model_);
}

TEST_F(MarkerObserverTest, AllocatesNothing) {
  MarkerObserver observer(body_.mesh, points_, {});
  const loop::NoAllocationScope scope;
  for (int i = 0; i < 5; ++i) observer.look(i % 2 == 0, 0.01, seen_, model_);
  EXPECT_EQ(scope.count(), 0);
}

}  // namespace
}  // namespace palpate::control

// A table whose height is configured wrongly: the filter corrects it by the wrenches of the hand.
#include <gtest/gtest.h>

#include <random>

#include "core/elasticity/corotational_model.hpp"
#include "core/estimation/pose_wrench_filter.hpp"
#include "rt/loop/allocation_counter.hpp"
#include "tests/support/refactor.hpp"
#include "tests/unit/core/estimation/rigid_model.hpp"

namespace palpate::estimation {
namespace {

constexpr double kTable = -0.02;  // m, configured height in O

collision::Obstacle table(double height) {
  collision::Obstacle obstacle;
  obstacle.name = "table";
  obstacle.X_OB.translation().z() = height;
  obstacle.pose_deviation[2] = 0.005;
  return obstacle;
}

elasticity::SolverOptions options(const collision::Obstacle& obstacle) {
  elasticity::SolverOptions options;
  options.contact.obstacles = {obstacle};
  options.contact.reach = 0.01;
  return options;
}

/// The bar and its hand above a table `above` m higher than the filter's.
class FreeObstacle : public ::testing::TestWithParam<double> {
 protected:
  FreeObstacle()
      : body_(support::held_bar({8, 1, 1}, mesh::ElementOrder::kQuadratic)),
        world_(body_, options(table(kTable + GetParam()))),
        model_(body_, options(table(kTable))),
        directions_(collision::free_directions({table(kTable)})) {
    for (elasticity::CorotationalModel* model : {&world_, &model_}) {
      model->prepare();
      model->set_gravity(body_.gravity_O);
    }
    PoseWrenchFilter::Options options;
    options.filter.position = 1.5e-3;  // what good set-up leaves
    options.filter.rotation = 3.5e-3;
    options.filter.log_young = 0.2;
    options.filter.obstacles = directions_;
    filter_ = std::make_unique<PoseWrenchFilter>(body_, mesh::extract_surface(body_.mesh), options);
    filter_->activate(model_);
    inputs_.grasp_count = 1;
  }

  void tick(const math::Pose& hand) {
    world_.hold(0, hand);
    support::refactor(world_);
    world_.step(1e-3);
    math::Vector6d wrench = world_.reaction(0).vector();
    lagged_ =
        is_first_ ? wrench : math::Vector6d(lagged_ + (1 - std::exp(-0.1)) * (wrench - lagged_));
    is_first_ = false;
    wrench = lagged_;
    for (int i = 0; i < 6; ++i) wrench[i] += (i < 3 ? 0.02 : 0.002) * normal_(random_);
    inputs_.grasps[0] = {Freshness::kNew, true, hand, true, math::Wrench::from(wrench)};
    support::refactor(model_);
    const loop::NoAllocationScope scope;
    placements_[0].X_OB = table(kTable).X_OB;
    collision::displace(directions_, estimate_.obstacle_motion, placements_);
    model_.place_obstacle(0, placements_[0]);
    result_ = filter_->update(inputs_, model_, estimate_);
    allocations_ += scope.count();
  }
  /// Lowers the hand along half a cosine, turns it, so that the middle of the bar comes first.
  void move(double from, double to, double seconds) {
    const int ticks = static_cast<int>(std::lround(1e3 * seconds));
    for (int i = 1; i <= ticks; ++i) {
      const double share = from + (to - from) * (0.5 - 0.5 * std::cos(M_PI * i / ticks));
      math::Pose hand = body_.grasps[0].X_OG_rest;
      hand.translation() += share * Eigen::Vector3d(-0.005, 0, -0.01);
      hand.linear() = math::exp_rotation(Eigen::Vector3d(0, -0.35 * share, 0));
      tick(hand);
    }
  }
  double mean_error() const {
    return (model_.positions() - world_.positions()).colwise().norm().mean();
  }

  elasticity::Body body_;
  elasticity::CorotationalQuasistatic world_, model_;
  std::vector<collision::FreeDirection> directions_;
  std::vector<collision::Placement> placements_{1};
  std::unique_ptr<PoseWrenchFilter> filter_;
  EstimationInputs inputs_;
  Estimate estimate_;
  UpdateResult result_;
  math::Vector6d lagged_;
  bool is_first_ = true;
  std::mt19937_64 random_{1};
  std::normal_distribution<double> normal_;
  std::int64_t allocations_ = 0;
};

TEST_P(FreeObstacle, ItsHeightIsFoundByTouchingIt) {
  move(0, 0, 1);
  EXPECT_EQ(estimate_.obstacle_motion[0], 0) << "nothing has touched the table";
  EXPECT_NEAR(estimate_.obstacle_deviation[0], 0.005, 1e-6);
  move(0, 1, 3);
  move(1, 1, 2);
  EXPECT_LT(world_.reaction(0).force.z(), -0.2) << "the bar lies on the table";
  EXPECT_NEAR(estimate_.obstacle_motion[0], GetParam(), 1e-3);
  EXPECT_NEAR(estimate_.obstacle_motion[0], GetParam(), 1.96 * estimate_.obstacle_deviation[0]);
  EXPECT_LT(estimate_.obstacle_deviation[0], 1.5e-3);
  EXPECT_LT(mean_error(), 2e-3);
  EXPECT_FALSE(filter_->consistency().is_inconsistent());
  move(1, 0, 3);
  EXPECT_LT(mean_error(), 1e-3) << "off the table";
  EXPECT_NEAR(estimate_.obstacle_motion[0], GetParam(), 1.96 * estimate_.obstacle_deviation[0]);
  EXPECT_EQ(allocations_, 0);
}

INSTANTIATE_TEST_SUITE_P(Heights, FreeObstacle, ::testing::Values(-5e-3, 0, 5e-3));

}  // namespace
}  // namespace palpate::estimation

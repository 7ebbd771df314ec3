// The law with limits, on a bar that bends: the model is both plant and estimate.
#include "core/control/quadratic_program.hpp"

#include "core/elasticity/element_stress.hpp"
#include "rt/loop/allocation_counter.hpp"
#include "tests/unit/core/control/bar_servo.hpp"

namespace palpate::control {
namespace {

using Eigen::Vector3d;

TEST_F(BarServo, WithoutActiveLimitsItMovesAsTheProportionalLaw) {
  QuadraticProgramLaw::Limited far;
  far.limits.linear_speed = far.limits.angular_speed = 1e3;
  far.limits.linear_acceleration = far.limits.angular_acceleration = 1e6;
  QuadraticProgramLaw law(servo(), far);
  ProportionalTwist proportional(servo());
  start(law, {0, 0, 0.01});
  proportional.configure_for(*feature_);
  LawOutput other;
  other.unreachable.setZero(3);
  for (int i = 0; i < 30; ++i) {
    ASSERT_TRUE(tick());
    proportional.compute(inputs(), other);
    law.compute(inputs(), output_);
    const math::Vector6d expected = other.V_O_G.vector();
    EXPECT_LT((output_.V_O_G.vector() - expected).norm(), 0.01 * expected.norm());
    EXPECT_STREQ(output_.remark, "");
  }
}

TEST_F(BarServo, ReachesAPointWithinSpeedAndAcceleration) {
  QuadraticProgramLaw::Limited limited;
  limited.limits.linear_speed = 0.05;
  limited.limits.linear_acceleration = 0.2;
  QuadraticProgramLaw law(servo(), limited);
  start(law, {0, 0.01, 0.03});
  Vector3d before = Vector3d::Zero();
  for (int i = 0; i < 800; ++i) {
    ASSERT_TRUE(tick());
    const Vector3d v = output_.V_O_G.linear;
    EXPECT_LE(v.cwiseAbs().maxCoeff(), 0.05 * (1 + 1e-9));
    if (error() > 2e-3) {
      EXPECT_LE((v - before).cwiseAbs().maxCoeff(), kPeriod * 0.2 * (1 + 1e-6)) << i;
    }
    before = v;
  }
  EXPECT_LT(error(), 1e-3);
}

TEST_F(BarServo, SlowsDownAndSaysSoBeforeTheBarBuckles) {
  QuadraticProgramLaw::Limited limited;
  limited.limits.pivot = 0.9;  // so early that a moderate force is close enough
  QuadraticProgramLaw law(servo(), limited);
  start(law, {-0.03, 0, 0});
  bool reported = false;
  for (int i = 0; i < 800; ++i) {
    tick();
    reported = reported || std::string(output_.remark).find("buckling") != std::string::npos;
  }
  EXPECT_TRUE(reported);
  EXPECT_TRUE(model_->positions().allFinite());
}

TEST_F(BarServo, KeepsTheStressOfTheWorstElements) {
  QuadraticProgramLaw free(servo(), {});
  start(free, {0, 0, 0.05});
  const auto peak = [&] {
    return elasticity::element_stress(body_, model_->positions()).von_mises.maxCoeff();
  };
  for (int i = 0; i < 600; ++i) tick();
  const double freely = peak();
  ASSERT_LT(error(), 2e-3);

  QuadraticProgramLaw::Limited limited;
  limited.limits.stress = 0.6 * freely;
  limited.body = &body_;
  QuadraticProgramLaw law(servo(), limited);
  start(law, {0, 0, 0.05});
  double largest = 0;
  for (int i = 0; i < 800; ++i) {
    tick();
    largest = std::max(largest, peak());
  }
  EXPECT_LE(largest, 1.02 * limited.limits.stress);
  EXPECT_GT(largest, 0.95 * limited.limits.stress) << "as near as it may";
  EXPECT_NEAR(law.limits().peak_stress(), peak(), 0.01 * peak());
  EXPECT_STREQ(output_.remark, "the target lies beyond the limit of stress");
  EXPECT_NEAR(output_.unreachable.norm(), error(), 0.1 * error()) << "all of what is left";
  EXPECT_GT(error(), 2e-3);
}

TEST_F(BarServo, KeepsTheStretchOfTheWorstElements) {
  QuadraticProgramLaw free(servo(), {});
  start(free, {0, 0, 0.05});
  elasticity::WorstElements worst(body_, elasticity::Strain::kStretch);
  const auto peak = [&] {
    for (int i = 0; i < 4; ++i) worst.look(model_->positions());
    return worst.peak();
  };
  for (int i = 0; i < 600; ++i) tick();
  const double freely = peak();
  ASSERT_GT(freely, 1.02);

  QuadraticProgramLaw::Limited limited;
  limited.limits.stretch = 1 + 0.6 * (freely - 1);
  limited.body = &body_;
  QuadraticProgramLaw law(servo(), limited);
  start(law, {0, 0, 0.05});
  double largest = 0;
  for (int i = 0; i < 800; ++i) {
    tick();
    largest = std::max(largest, peak());
  }
  EXPECT_LE(largest - 1, 1.02 * (limited.limits.stretch - 1));
  EXPECT_GT(largest - 1, 0.95 * (limited.limits.stretch - 1));
  EXPECT_STREQ(output_.remark, "the target lies beyond the limit of stretch");
}

// The hand in a position where the object is strained beyond its limit, which is also outside the
// workspace: the workspace limit is relaxed.
TEST_F(BarServo, TheWorkspaceGivesWayBeforeTheStress) {
  QuadraticProgramLaw free(servo(), {});
  start(free, {0, 0, 0.05});
  for (int i = 0; i < 600; ++i) tick();
  const auto peak = [&] {
    return elasticity::element_stress(body_, model_->positions()).von_mises.maxCoeff();
  };
  const double before = peak();
  QuadraticProgramLaw::Limited limited;
  limited.body = &body_;
  limited.limits.stress = 0.8 * before;
  limited.limits.workspace_lower = X_OG_.translation() - Vector3d::Constant(1e-3);
  limited.limits.workspace_upper = X_OG_.translation() + Vector3d::Constant(1e-3);
  limited.limits.angular_speed = 1e-3;  // no way round
  QuadraticProgramLaw law(servo(), limited);
  law.configure_for(*feature_);
  law_ = &law;
  target_.z() += 5e-3;
  bool reported = false;
  for (int i = 0; i < 600; ++i) {
    tick();
    reported = reported || std::string(output_.remark).find("workspace") != std::string::npos;
  }
  EXPECT_TRUE(reported);
  EXPECT_LT(peak(), 1.02 * limited.limits.stress);
}

TEST_F(BarServo, AllocatesNothingWithEveryLimit) {
  body_ = support::held_bar({8, 1, 1}, mesh::ElementOrder::kQuadratic);
  QuadraticProgramLaw::Limited limited;
  limited.body = &body_;
  limited.limits.stress = 500;
  limited.limits.stretch = 1.02;
  limited.limits.force = 1;
  limited.limits.slip.pinch = 1;
  LimitedObstacle ball;
  ball.body.shape = collision::Sphere{0.04};
  ball.body.X_OB.translation() << 0.2, 0.03, 0.14;
  ball.force = 1;
  limited.limits.obstacles.assign(collision::kMostObstacles, ball);
  limited.smoothness = 1e-3;
  QuadraticProgramLaw law(servo(), limited);
  start(law, {0, 0.01, 0.03});
  for (int i = 0; i < 100; ++i) {
    tick();
    feature_->error(value_, target_, error_);
    const LawInputs now = inputs();
    const loop::NoAllocationScope scope;
    law.compute(now, output_);
    ASSERT_EQ(scope.count(), 0);
  }
}

TEST(QuadraticProgramLaw, RefusesLimitsThatCannotBe) {
  const auto make = [](auto change) {
    QuadraticProgramLaw::Limited limited;
    change(limited);
    QuadraticProgramLaw law(servo(), limited);
  };
  using L = QuadraticProgramLaw::Limited;
  EXPECT_NO_THROW(make([](L&) {}));
  EXPECT_THROW(make([](L& l) { l.limits.force = 0; }), std::invalid_argument);
  EXPECT_THROW(make([](L& l) { l.limits.stress = -1; }), std::invalid_argument);
  EXPECT_THROW(make([](L& l) { l.limits.stress = 1e3; }), std::invalid_argument) << "no object";
  EXPECT_THROW(make([](L& l) { l.limits.stretch = 0.9; }), std::invalid_argument);
  EXPECT_THROW(make([](L& l) { l.limits.slip.normal_G.setZero(); }), std::invalid_argument);
  EXPECT_THROW(make([](L& l) { l.limits.slip.sticking = 1; }), std::invalid_argument);
  EXPECT_THROW(make([](L& l) { l.limits.slip.width = 0; }), std::invalid_argument);
  EXPECT_THROW(make([](L& l) { l.limits.workspace_lower.x() = 2e3; }), std::invalid_argument);
  EXPECT_THROW(make([](L& l) { l.limits.strain_margin = 1; }), std::invalid_argument);
  EXPECT_THROW(make([](L& l) {
                 l.limits.flange[0] = {Vector3d::Zero(), Vector3d::Zero()};
               }),
               std::invalid_argument);
  EXPECT_THROW(make([](L& l) { l.limits.obstacles.resize(9); }), std::invalid_argument);
  EXPECT_THROW(make([](L& l) { l.limits.obstacles.resize(1); }), std::invalid_argument)
      << "no object";
  const auto with_obstacle = [&](auto change) {
    make([&](L& l) {
      l.limits.obstacles.resize(1);
      l.limits.obstacles[0].may_touch = true;
      change(l.limits.obstacles[0]);
    });
  };
  EXPECT_NO_THROW(with_obstacle([](LimitedObstacle&) {}));
  EXPECT_THROW(with_obstacle([](LimitedObstacle& o) { o.force = 0; }), std::invalid_argument);
  EXPECT_THROW(with_obstacle([](LimitedObstacle& o) { o.clearance = -1; }), std::invalid_argument);
  EXPECT_THROW(with_obstacle([](LimitedObstacle& o) { o.body.shape = collision::Sphere{0}; }),
               std::invalid_argument);
  EXPECT_THROW(make([](L& l) { l.limits.clearance_deviations = -1; }), std::invalid_argument);
  EXPECT_THROW(make([](L& l) { l.limits.fallback_deviation = -1; }), std::invalid_argument);
  EXPECT_THROW(make([](L& l) { l.grasps = {0, 1}; }), std::invalid_argument);
  EXPECT_THROW(make([](L& l) { l.smoothness = -1; }), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::control

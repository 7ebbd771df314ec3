// The law that keeps limits, on a bar that bends: the model is both plant and estimate.
#include "core/control/quadratic_program.hpp"

#include <gtest/gtest.h>

#include "core/control/fem_jacobian.hpp"
#include "core/elasticity/corotational_model.hpp"
#include "core/elasticity/element_stress.hpp"
#include "core/shape/point_feature.hpp"
#include "rt/loop/allocation_counter.hpp"
#include "tests/unit/core/control/surface_distance.hpp"
#include "tests/unit/core/estimation/rigid_model.hpp"

namespace palpate::control {
namespace {

using Eigen::Vector3d;

TwistLawOptions servo() {
  TwistLawOptions options;
  options.gain = 2;
  options.linear_speed = 0.1;
  options.angular_speed = 0.5;
  options.dead_band = {1e-4, 1e-3, 1.2};
  return options;
}

/// The middle of the bar's upper side is steered by the hand at its end.
class BarServo : public ::testing::Test {
 protected:
  void start(ControlLaw& law, const Vector3d& target_offset) {
    body_ = testing::held_bar({8, 1, 1}, mesh::ElementOrder::kQuadratic);
    body_.gravity_O.setZero();
    model_ = std::make_unique<elasticity::CorotationalQuasistatic>(body_);
    model_->prepare();
    feature_ = std::make_unique<shape::PointFeature>(
        body_.mesh, shape::PointFeature::Options{{Vector3d(0.25, 0.03, 0.06)}});
    law_ = &law;
    law.configure_for(*feature_);
    value_.setZero(3);
    error_.setZero(3);
    output_.unreachable.setZero(3);
    jacobian_.setZero(3, 6);
    X_OG_ = body_.grasps[0].X_OG_rest;
    step();
    target_ = value_ + target_offset;
  }

  void step() {
    model_->hold(0, X_OG_);
    if (elasticity::Refactorisation* job = model_->wanted_refactorisation()) {
      job->run();
      model_->install(*job);
    }
    for (int i = 0; i < 3; ++i) model_->step(1e-3);
    feature_->evaluate(model_->positions(), value_);
  }

  LawInputs inputs() {
    LawInputs inputs;
    inputs.dt = kPeriod;
    inputs.value = &value_;
    inputs.target = &target_;
    inputs.error = &error_;
    inputs.jacobian = &jacobian_;
    inputs.model = model_.get();
    inputs.X_OG[0] = X_OG_;
    inputs.reaction[0] = model_->reaction(0);
    if (!node_deviation_.empty()) inputs.node_deviation = &node_deviation_;
    return inputs;
  }

  /// True where the law had a Jacobian to go by.
  bool tick() {
    feature_->error(value_, target_, error_);
    if (!provider_.update(*feature_, *model_, X_OG_, jacobian_)) return false;
    law_->compute(inputs(), output_);
    X_OG_.translation() += kPeriod * output_.V_O_G.linear;
    X_OG_.linear() = math::exp_rotation(kPeriod * output_.V_O_G.angular) * X_OG_.linear();
    step();
    return true;
  }
  double error() const { return (target_ - value_).norm(); }

  static constexpr double kPeriod = 5e-3;  // s
  elasticity::Body body_;
  std::unique_ptr<elasticity::CorotationalQuasistatic> model_;
  std::unique_ptr<shape::PointFeature> feature_;
  FemJacobian provider_{FemJacobian::Options{}};
  ControlLaw* law_ = nullptr;
  Eigen::VectorXd value_, target_, error_;
  Eigen::MatrixXd jacobian_;
  LawOutput output_;
  math::Pose X_OG_;
  std::vector<float> node_deviation_;  // m; empty: not told
};

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

TEST_F(BarServo, StopsAtTheLargestForceAndGoesNoFurther) {
  QuadraticProgramLaw free(servo(), {});
  start(free, {0, 0, 0.05});
  for (int i = 0; i < 600; ++i) tick();
  const double freely = model_->reaction(0).force.cwiseAbs().maxCoeff();
  ASSERT_LT(error(), 2e-3);

  QuadraticProgramLaw::Limited limited;
  limited.limits.force = 0.6 * freely;
  QuadraticProgramLaw law(servo(), limited);
  start(law, {0, 0, 0.05});
  double largest = 0;
  for (int i = 0; i < 800; ++i) {
    tick();
    largest = std::max(largest, model_->reaction(0).force.cwiseAbs().maxCoeff());
  }
  EXPECT_LE(largest, 1.02 * limited.limits.force);
  EXPECT_GT(largest, 0.9 * limited.limits.force) << "as near as it may";
}

TEST_F(BarServo, APinchDoesNotSlip) {
  QuadraticProgramLaw free(servo(), {});
  start(free, {0, 0, 0.05});
  for (int i = 0; i < 600; ++i) tick();
  const auto across = [&] {
    const Vector3d n = X_OG_.linear() * Vector3d::UnitY();
    const math::Wrench w = model_->reaction(0);
    return (w.force - n.dot(w.force) * n).norm() + std::abs(n.dot(w.torque)) / 0.02;
  };
  QuadraticProgramLaw::Limited limited;
  limited.limits.slip.pinch = 0.5 * across();
  limited.limits.slip.friction = 0.5;
  const double held = limited.limits.slip.pinch;  // two fingers, half of it each
  QuadraticProgramLaw law(servo(), limited);
  start(law, {0, 0, 0.05});
  double largest = 0;
  for (int i = 0; i < 800; ++i) {
    tick();
    largest = std::max(largest, across());
  }
  EXPECT_LE(largest, 1.02 * held);
  EXPECT_GT(largest, 0.5 * held);
}

TEST_F(BarServo, KeepsAwayFromAnObstacle) {
  // Above the bar's middle, in the way of what moves up.
  const Obstacle ball{{0.2, 0.03, 0.12}, 0.04};
  for (const double deviation : {0.0, 1e-3}) {
    QuadraticProgramLaw::Limited limited;
    limited.limits.obstacles.push_back(ball);
    limited.limits.clearance = 0.004;
    limited.limits.clearance_deviations = 3;
    limited.body = &body_;
    body_ = testing::held_bar({8, 1, 1}, mesh::ElementOrder::kQuadratic);
    QuadraticProgramLaw law(servo(), limited);
    start(law, {0, 0, 0.05});
    const mesh::Surface surface = mesh::extract_surface(body_.mesh);
    node_deviation_.assign(static_cast<std::size_t>(body_.mesh.node_count()),
                           static_cast<float>(deviation));
    double nearest = 1;
    for (int i = 0; i < 1000; ++i) {
      tick();
      const double gap =
          testing::distance_to_surface(surface, model_->positions(), ball.center_O) - ball.radius;
      nearest = std::min(nearest, gap);
    }
    const double kept = limited.limits.clearance + 3 * deviation;
    EXPECT_GT(nearest, 0.98 * kept);
    EXPECT_LT(nearest, kept + 0.004) << "it was in the way";
  }
}

TEST_F(BarServo, TheHandStaysInItsWorkspace) {
  QuadraticProgramLaw::Limited limited;
  QuadraticProgramLaw probe(servo(), limited);
  start(probe, {0, 0, 0.04});
  const double wall = X_OG_.translation().z() + 0.02;
  limited.limits.workspace_upper.z() = wall;
  QuadraticProgramLaw law(servo(), limited);
  start(law, {0, 0, 0.04});
  for (int i = 0; i < 600; ++i) {
    tick();
    EXPECT_LE(X_OG_.translation().z(), wall + 1e-4);
  }
  EXPECT_GT(X_OG_.translation().z(), wall - 2e-3);
}

// The flange stands off the grasp, in a cell turned against the object: what lifts it is the hand's
// turning as well.
TEST_F(BarServo, TheFlangeStaysInItsBox) {
  QuadraticProgramLaw::Limited limited;
  QuadraticProgramLaw probe(servo(), limited);
  start(probe, {0, 0, 0.04});
  FlangeBox box;
  box.X_WO.linear() = Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  box.X_WO.translation() = Vector3d(0.4, -0.2, 0.3);
  box.p_G_E = Vector3d(-0.05, 0.02, 0.15);
  const auto flange = [&] { return Vector3d(box.X_WO * X_OG_ * box.p_G_E); };
  box.lower = flange() - Vector3d::Constant(0.012);
  box.upper = flange() + Vector3d::Constant(0.012);
  limited.limits.flange[0] = box;
  QuadraticProgramLaw law(servo(), limited);
  start(law, {0, 0, 0.04});
  double nearest = 1;
  for (int i = 0; i < 600; ++i) {
    tick();
    const double left =
        std::min((box.upper - flange()).minCoeff(), (flange() - box.lower).minCoeff());
    EXPECT_GE(left, -1e-4);
    nearest = std::min(nearest, left);
  }
  EXPECT_LT(nearest, 2e-3) << "it was in the way";
  EXPECT_STREQ(output_.remark, "the target lies beyond the hand's workspace");
}

TEST_F(BarServo, SlowsDownAndSaysSoBeforeTheBarBuckles) {
  QuadraticProgramLaw::Limited limited;
  limited.limits.pivot = 0.9;  // so early that a moderate push is near enough
  QuadraticProgramLaw law(servo(), limited);
  start(law, {-0.03, 0, 0});
  bool told = false;
  for (int i = 0; i < 800; ++i) {
    tick();
    told = told || std::string(output_.remark) == "slows down near buckling";
  }
  EXPECT_TRUE(told);
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

// The hand in a place where the object is strained beyond its limit, which is also beyond the
// workspace: the workspace gives way.
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
  bool told = false;
  for (int i = 0; i < 600; ++i) {
    tick();
    told = told || std::string(output_.remark) == "the hand's workspace gives way";
  }
  EXPECT_TRUE(told);
  EXPECT_LT(peak(), 1.02 * limited.limits.stress);
}

TEST_F(BarServo, AllocatesNothingWithEveryLimit) {
  body_ = testing::held_bar({8, 1, 1}, mesh::ElementOrder::kQuadratic);
  QuadraticProgramLaw::Limited limited;
  limited.body = &body_;
  limited.limits.stress = 500;
  limited.limits.stretch = 1.02;
  limited.limits.force = 1;
  limited.limits.slip.pinch = 1;
  limited.limits.obstacles.assign(4, {{0.2, 0.03, 0.14}, 0.04});
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
  EXPECT_THROW(make([](L& l) { l.limits.workspace_lower.x() = 2e3; }), std::invalid_argument);
  EXPECT_THROW(make([](L& l) { l.limits.strain_margin = 1; }), std::invalid_argument);
  EXPECT_THROW(make([](L& l) {
                 l.limits.flange[0] = {Vector3d::Zero(), Vector3d::Zero()};
               }),
               std::invalid_argument);
  EXPECT_THROW(make([](L& l) { l.limits.obstacles.resize(5); }), std::invalid_argument);
  EXPECT_THROW(make([](L& l) { l.limits.obstacles.resize(1); }), std::invalid_argument)
      << "no object";
  EXPECT_THROW(make([](L& l) { l.limits.clearance_deviations = -1; }), std::invalid_argument);
  EXPECT_THROW(make([](L& l) { l.grasps = {0, 1}; }), std::invalid_argument);
  EXPECT_THROW(make([](L& l) { l.smoothness = -1; }), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::control

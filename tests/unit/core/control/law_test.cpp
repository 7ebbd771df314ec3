#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "core/control/jacobian_providers.hpp"
#include "core/control/twist_law.hpp"
#include "core/math/random.hpp"
#include "core/shape/point_features.hpp"
#include "core/shape/pose_feature.hpp"
#include "tests/unit/core/estimation/rigid_model.hpp"

namespace palpate::control {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kDegree = M_PI / 180;

shape::PoseFeature::Options law_pose_points() {
  return {{Vector3d(0.20, 0.01, 0.02), Vector3d(0.27, 0.03, 0.05), Vector3d(0.23, 0.055, 0.01)}};
}

/// Fast limits and no dead band: the bare law.
TwistLawOptions bare(double gain) {
  TwistLawOptions options;
  options.gain = gain;
  options.linear_speed = options.angular_speed = 1e3;
  options.dead_band = {0, 0, 1};
  return options;
}

/// A hand that follows its commands and an object that follows it rigidly.
class Loop {
 public:
  Loop(ControlLaw& law, shape::Feature& feature, support::RigidModel& model)
      : law_(law), feature_(feature), model_(model) {
    law.configure_for(feature);
    value.setZero(feature.value_count());
    target.setZero(feature.value_count());
    error.setZero(feature.dimension());
    output.unreachable.setZero(feature.dimension());
    jacobian_.setZero(feature.dimension(), 6);
    observe();
  }

  void observe() {
    model_.hold(0, X_OG);
    model_.step(1e-3);
    feature_.evaluate(model_.positions(), value);
    feature_.error(value, target, error);
  }

  void tick(double dt) {
    ASSERT_TRUE(provider_.update(feature_, model_, X_OG, jacobian_));
    LawInputs inputs;
    inputs.dt = dt;
    inputs.value = &value;
    inputs.target = &target;
    inputs.error = &error;
    inputs.jacobian = &jacobian_;
    law_.compute(inputs, output);
    X_OG.translation() += dt * output.V_O_G.linear;
    X_OG.linear() = math::exp_rotation(dt * output.V_O_G.angular) * X_OG.linear();
    observe();
  }

  math::Pose X_OG = math::make_pose(Eigen::Matrix3d::Identity(), Vector3d(0.5, 0.03, 0.03));
  VectorXd value, target, error;
  LawOutput output;

 private:
  ControlLaw& law_;
  shape::Feature& feature_;
  support::RigidModel& model_;
  KinematicJacobian provider_;
  MatrixXd jacobian_;
};

class LawTest : public ::testing::Test {
 protected:
  support::RigidModel model_{support::held_bar({4, 1, 1}, mesh::ElementOrder::kLinear)};
  shape::PoseFeature pose_{model_.body().mesh, law_pose_points()};

  /// Lets the law move to random poses up to 170 degrees away and checks that `size` of the error
  /// decays as exp(-gain t).
  template <class Size>
  void expect_exponential(ControlLaw& law, double gain, const Size& size) {
    math::Random random(11);
    for (int trial = 0; trial < 6; ++trial) {
      Loop loop(law, pose_, model_);
      const Vector3d axis(random.normal(), random.normal(), random.normal());
      const double angle = (trial == 0 ? 170 : random.uniform(5, 170)) * kDegree;
      const Eigen::Matrix3d turn = math::exp_rotation(angle * axis.normalized());
      loop.target = loop.value;
      for (int k = 0; k < 3; ++k) loop.target[k] += random.uniform(-0.3, 0.3);
      math::wxyz_from_rotation(turn * math::rotation_from_wxyz(loop.value.data() + 3),
                               loop.target.data() + 3);
      loop.observe();
      const double start = size(loop.value, loop.target);
      const double dt = 1e-3;
      for (double t = 0; t < 2 / gain; t += dt) loop.tick(dt);
      EXPECT_NEAR(std::log(start / size(loop.value, loop.target)), 2, 0.02) << angle / kDegree;
      for (double t = 0; t < 14 / gain; t += dt) loop.tick(dt);
      EXPECT_LT(loop.error.norm(), 1e-5);
    }
  }
};

TEST_F(LawTest, ProportionalTwistConvergesWithItsGain) {
  ProportionalTwist law(bare(2));
  VectorXd error(6);
  expect_exponential(law, 2, [&](const VectorXd& value, const VectorXd& target) {
    pose_.error(value, target, error);
    return error.tail<3>().norm();
  });
  expect_exponential(law, 2, [&](const VectorXd& value, const VectorXd& target) {
    pose_.error(value, target, error);
    return error.head<3>().norm();
  });
}

TEST_F(LawTest, DualQuaternionConvergesWithItsGain) {
  DualQuaternion law(bare(2));
  // The screw's angle, and its displacement at the origin of O.
  expect_exponential(law, 2, [&](const VectorXd& value, const VectorXd& target) {
    const Eigen::Matrix3d R = math::rotation_from_wxyz(value.data() + 3);
    const Eigen::Matrix3d R_target = math::rotation_from_wxyz(target.data() + 3);
    return math::log_rotation(R_target * R.transpose()).norm();
  });
}

TEST_F(LawTest, DualQuaternionKeepsItsScrewAxis) {
  DualQuaternion law(bare(1));
  Loop loop(law, pose_, model_);
  // A quarter turn about a line along z through (1, 2): every point stays on its circle about it.
  const math::Pose turn =
      Eigen::Translation3d(1, 2, 0) *
      math::make_pose(math::exp_rotation({0, 0, 90 * kDegree}), Vector3d::Zero()) *
      Eigen::Translation3d(-1, -2, 0);
  const Vector3d p = loop.value.head<3>();
  loop.target.head<3>() = turn * p;
  math::wxyz_from_rotation(turn.linear() * math::rotation_from_wxyz(loop.value.data() + 3),
                           loop.target.data() + 3);
  loop.observe();
  const double radius = (p.head<2>() - Eigen::Vector2d(1, 2)).norm();
  for (int i = 0; i < 3000; ++i) {
    loop.tick(1e-3);
    ASSERT_NEAR((loop.value.head<2>() - Eigen::Vector2d(1, 2)).norm(), radius, 2e-3 * radius);
    ASSERT_NEAR(loop.value[2], p.z(), 1e-9);
  }
  EXPECT_LT(loop.error.norm(), 0.06 * radius * 90 * kDegree);
}

TEST_F(LawTest, ProportionalTwistSteersAPoint) {
  shape::PointFeature point(model_.body().mesh, {{0.25, 0.03, 0.06}, {0, 2}});
  ProportionalTwist law(bare(1));
  Loop loop(law, point, model_);
  loop.target << 0.30, 0, 0.20;
  loop.observe();
  const double start = loop.error.norm();
  for (int i = 0; i < 2000; ++i) loop.tick(1e-3);
  EXPECT_NEAR(std::log(start / loop.error.norm()), 2, 0.02);
  EXPECT_LT(loop.output.unreachable.norm(), 1e-9);
}

/// The optimal rigid motion for displaced points is Kabsch's: the rotation and translation with the
/// least sum of squares.
TEST_F(LawTest, ProportionalTwistBringsASetOfPointsAsNearAsItCan) {
  shape::PointsFeature::Options options;
  for (double x : {0.1, 0.25, 0.4})
    for (double y : {0.0, 0.06}) options.rest_points.insert(options.rest_points.end(), {{x, y, 0}});
  options.rest_points.emplace_back(0.3, 0.03, 0.06);
  shape::PointsFeature points(model_.body().mesh, options);
  ProportionalTwist law(bare(2));
  Loop loop(law, points, model_);
  const int n = static_cast<int>(options.rest_points.size());
  const Eigen::Matrix3Xd rest = loop.value.reshaped(3, n);
  math::Random random(5);
  Eigen::Matrix3Xd target(3, n);
  for (int i = 0; i < n; ++i) {
    target.col(i) = math::exp_rotation({0.3, -0.4, 0.2}) * rest.col(i) + Vector3d(0.05, 0, 0.1);
    for (int k = 0; k < 3; ++k) target(k, i) += random.uniform(-2e-3, 2e-3);
  }
  loop.target = target.reshaped();
  loop.observe();
  for (int i = 0; i < 8000; ++i) loop.tick(1e-3);
  const Eigen::Matrix4d best = Eigen::umeyama(rest, target, false);
  const Eigen::Matrix3Xd left = target - ((best.topLeftCorner<3, 3>() * rest).colwise() +
                                          Vector3d(best.topRightCorner<3, 1>()));
  ASSERT_GT(left.norm(), 1e-3);
  EXPECT_LT((loop.error - left.reshaped()).norm(), 1e-6);
  EXPECT_LT((loop.output.unreachable - left.reshaped()).norm(), 1e-6);
}

TEST_F(LawTest, DeadBandOfASetOfPointsIsItsRootMeanSquare) {
  shape::PointsFeature::Options options;
  for (int i = 0; i < 8; ++i) options.rest_points.emplace_back(0.05 * (i + 1), 0.03, 0.03);
  shape::PointsFeature points(model_.body().mesh, options);
  TwistLawOptions with_band = bare(1);
  with_band.dead_band.position = 1e-3;
  ProportionalTwist law(with_band);
  for (const double displacement : {0.9e-3, 1.1e-3}) {
    Loop loop(law, points, model_);
    loop.target = loop.value;
    for (int i = 0; i < 8; ++i) loop.target[3 * i] += displacement;
    loop.observe();
    loop.tick(1e-3);
    EXPECT_EQ(loop.output.V_O_G.linear.norm() == 0, displacement < 1e-3);
  }
}

TEST_F(LawTest, SaturationKeepsTheDirection) {
  TwistLawOptions options = bare(1);
  ProportionalTwist free(options);
  options.linear_speed = 0.02;
  options.angular_speed = 0.05;
  ProportionalTwist slow(options);
  Loop a(free, pose_, model_), b(slow, pose_, model_);
  for (Loop* loop : {&a, &b}) {
    loop->target = loop->value;
    loop->target.head<3>() += Vector3d(0.3, -0.2, 0.1);
    math::wxyz_from_rotation(math::exp_rotation({0, 1, 1}), loop->target.data() + 3);
    loop->observe();
    loop->tick(1e-3);
  }
  EXPECT_LE(b.output.V_O_G.linear.norm(), 0.02 * (1 + 1e-12));
  EXPECT_LE(b.output.V_O_G.angular.norm(), 0.05 * (1 + 1e-12));
  const math::Vector6d u = a.output.V_O_G.vector().normalized();
  EXPECT_LT((b.output.V_O_G.vector().normalized() - u).norm(), 1e-12);
}

TEST_F(LawTest, ThesisPresetStopsInItsDeadBand) {
  ProportionalTwist law(TwistLawOptions::thesis());
  Loop loop(law, pose_, model_);
  loop.target = loop.value;
  loop.target[0] += 0.1;
  loop.observe();
  double time = 0;
  while (loop.error.norm() > 0 && time < 60) {
    loop.tick(0.01);
    time += 0.01;
    if (loop.output.V_O_G.linear.norm() == 0) break;
  }
  // ln(100 mm / 5 mm) / 0.25 = 12 s.
  EXPECT_NEAR(time, std::log(20) / 0.25, 0.1);
  EXPECT_LE(loop.error.head<3>().norm(), 5e-3);
  EXPECT_GT(loop.error.head<3>().norm(), 4.9e-3);
}

TEST(DeadBand, ResumesOnlyOutsideALargerBand) {
  DeadBand band({1.0, 0.1, 1.5});
  EXPECT_FALSE(band.rests(1.2, 0));
  EXPECT_TRUE(band.rests(0.9, 0));
  EXPECT_TRUE(band.rests(1.2, 0));
  EXPECT_FALSE(band.rests(1.6, 0));
  EXPECT_FALSE(band.rests(1.2, 0));
  EXPECT_FALSE(band.rests(0.5, 0.12));
  EXPECT_TRUE(band.rests(0.5, 0.1));
  EXPECT_FALSE(band.rests(0.5, 0.16));
}

TEST_F(LawTest, ReportsTheUnreachablePartAndStillSteersTheRest) {
  ProportionalTwist law(bare(2));
  law.configure_for(pose_);
  MatrixXd J = MatrixXd::Zero(6, 6);
  J(0, 0) = 0.8;
  J(2, 4) = 0.1;
  VectorXd value = VectorXd::Zero(7), target = VectorXd::Zero(7), error(6);
  error << 0.1, 0.2, 0.3, 0, 0, 0;
  LawInputs inputs;
  inputs.value = &value;
  inputs.target = &target;
  inputs.error = &error;
  inputs.jacobian = &J;
  LawOutput output;
  output.unreachable.setZero(6);
  law.compute(inputs, output);
  VectorXd expected = VectorXd::Zero(6);
  expected[1] = 0.2;
  EXPECT_LT((output.unreachable - expected).norm(), 1e-9);
  EXPECT_LT((J * output.V_O_G.vector() - 2 * (error - expected)).norm(), 1e-9);
}

TEST_F(LawTest, NonsenseGivesNoMotion) {
  ProportionalTwist law(bare(2));
  law.configure_for(pose_);
  MatrixXd J = MatrixXd::Identity(6, 6);
  VectorXd value = VectorXd::Zero(7), target = VectorXd::Zero(7), error = VectorXd::Ones(6);
  LawInputs inputs;
  inputs.value = &value;
  inputs.target = &target;
  inputs.error = &error;
  inputs.jacobian = &J;
  LawOutput output;
  output.unreachable.setZero(6);
  output.V_O_G.linear.setOnes();
  error[4] = std::numeric_limits<double>::quiet_NaN();
  law.compute(inputs, output);
  EXPECT_EQ(output.V_O_G.vector().norm(), 0);
  EXPECT_TRUE(output.unreachable.allFinite());
  error.setOnes();
  J(3, 3) = std::numeric_limits<double>::infinity();
  law.compute(inputs, output);
  EXPECT_EQ(output.V_O_G.vector().norm(), 0);
  EXPECT_EQ(output.unreachable, error);
}

TEST_F(LawTest, RefusesWhatItCannotDo) {
  shape::PointFeature point(model_.body().mesh, {{0.25, 0.03, 0.06}, {0, 1, 2}});
  DualQuaternion law(bare(1));
  EXPECT_THROW(law.configure_for(point), std::invalid_argument);
  TwistLawOptions options;
  options.gain = 0;
  EXPECT_THROW(ProportionalTwist{options}, std::invalid_argument);
  options = TwistLawOptions();
  options.dead_band.release = 0.9;
  EXPECT_THROW(ProportionalTwist{options}, std::invalid_argument);
}

}  // namespace
}  // namespace palpate::control

// Limits of grasp and position, enforced by the law.
#include "tests/unit/core/control/bar_servo.hpp"
#include "tests/unit/core/control/surface_distance.hpp"

namespace palpate::control {
namespace {

using Eigen::Vector3d;

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

/// Friction utilisation of the more loaded of two fingers, from their forces on the object.
double load_of_fingers(const math::Wrench& w, const Vector3d& n, const SlipCone& slip) {
  const Vector3d torque_across = w.torque - n.dot(w.torque) * n;
  const Vector3d couple = torque_across.cross(n) / slip.width;
  EXPECT_LT((slip.width * n.cross(couple) - torque_across).norm(), 1e-12);
  double worst = 0;
  for (const int finger : {1, -1}) {
    const Vector3d force = 0.5 * w.force + finger * couple;
    const double press = slip.pinch - finger * n.dot(force);
    const double turn = 0.5 * n.dot(w.torque) / slip.lever;
    worst = std::max(worst, std::hypot(force.cross(n).norm(), turn) / (slip.friction * press));
  }
  return worst;
}

TEST_F(BarServo, APinchDoesNotSlip) {
  QuadraticProgramLaw free(servo(), {});
  // A target that requires a pull, a couple and a rotation of the fingers.
  const Vector3d offset(0.002, 0.02, 0.04);
  start(free, offset);
  for (int i = 0; i < 600; ++i) tick();
  SlipCone slip;
  slip.width = 0.05;
  slip.normal_G = Vector3d(0.2, 1, 0.1).normalized();
  slip.pinch = 10;
  const auto load = [&] {
    return load_of_fingers(model_->reaction(0), X_OG_.linear() * slip.normal_G, slip);
  };
  for (int i = 0; i < 20; ++i) slip.pinch *= load() / 2;  // that freely bears twice its limit
  ASSERT_NEAR(load(), 2, 1e-3);
  for (const double sticking : {0.0, 0.4}) {
    QuadraticProgramLaw::Limited limited;
    limited.limits.slip = slip;
    limited.limits.slip.sticking = sticking;
    QuadraticProgramLaw law(servo(), limited);
    start(law, offset);
    double largest = 0;
    for (int i = 0; i < 800; ++i) {
      tick();
      largest = std::max(largest, load());
    }
    EXPECT_LE(largest, 1.02 * (1 - sticking));
    EXPECT_GT(largest, 0.9 * (1 - sticking)) << "as near as it may";
  }
}

TEST_F(BarServo, KeepsAwayFromAnObstacle) {
  // Above the bar's middle, in the way of an upward motion.
  const Obstacle ball{{0.2, 0.03, 0.12}, 0.04};
  for (const double deviation : {0.0, 1e-3}) {
    QuadraticProgramLaw::Limited limited;
    limited.limits.obstacles.push_back(ball);
    limited.limits.clearance = 0.004;
    limited.limits.clearance_deviations = 3;
    limited.limits.fallback_deviation = 0.1;  // but they are given
    limited.body = &body_;
    body_ = support::held_bar({8, 1, 1}, mesh::ElementOrder::kQuadratic);
    QuadraticProgramLaw law(servo(), limited);
    start(law, {0, 0, 0.05});
    const mesh::Surface surface = mesh::extract_surface(body_.mesh);
    node_deviation_.assign(static_cast<std::size_t>(body_.mesh.node_count()),
                           static_cast<float>(deviation));
    double nearest = 1;
    for (int i = 0; i < 1000; ++i) {
      tick();
      const double gap =
          support::distance_to_surface(surface, model_->positions(), ball.center_O) - ball.radius;
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

// The flange is offset from the grasp, in a workcell rotated relative to the object: a rotation of
// the hand lifts it as well.
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

}  // namespace
}  // namespace palpate::control

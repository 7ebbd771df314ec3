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

/// Bodies above the bar's middle, in the way of an upward motion.
std::vector<collision::Obstacle> in_the_way() {
  const auto placed = [](const Vector3d& rotation, const Vector3d& position) {
    return math::make_pose(math::exp_rotation(rotation), position);
  };
  return {{"ball", collision::Sphere{0.04}, placed({0, 0, 0}, {0.2, 0.03, 0.12})},
          {"crate", collision::Box{{0.03, 0.05, 0.02}}, placed({0.1, 0.5, 0.2}, {0.2, 0.03, 0.12})},
          {"rod", collision::Cylinder{0.02}, placed({M_PI / 2, 0, 0.3}, {0.22, 0.03, 0.1})},
          {"lid", collision::HalfSpace{}, placed({M_PI, 0, 0}, {0, 0, 0.08})}};
}

TEST_F(BarServo, KeepsAwayFromObstacles) {
  for (const collision::Obstacle& obstacle : in_the_way()) {
    for (const double deviation : {0.0, 1e-3}) {
      SCOPED_TRACE(obstacle.name);
      QuadraticProgramLaw::Limited limited;
      LimitedObstacle& kept_off = limited.limits.obstacles.emplace_back();
      kept_off.body = obstacle;
      kept_off.clearance = 0.004;
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
        if (i % 5 != 0) continue;
        const double gap = support::least_on_surface(
            surface, model_->positions(),
            [&](const Vector3d& p) { return collision::distance(obstacle, p); });
        nearest = std::min(nearest, gap);
      }
      const double kept = 0.004 + 3 * deviation;
      // edges and planes are harder to pass by: the limit, which is soft, is exceeded a little
      EXPECT_GT(nearest, (obstacle.name == "ball" ? 0.98 : 0.95) * kept);
      EXPECT_LT(nearest, kept + 0.004) << "it was in the way";
    }
  }
}

/// A lid that sinks while the target lies above it: its velocity is known, so that the bar does not
/// lag behind by velocity / damper.
TEST_F(BarServo, GivesWayToAnObstacleThatMoves) {
  constexpr double kClearance = 0.004, kSinking = 0.01;  // m, m/s
  QuadraticProgramLaw::Limited limited;
  LimitedObstacle& lid = limited.limits.obstacles.emplace_back();
  lid.body = in_the_way().back();
  lid.clearance = kClearance;
  limited.limits.fallback_deviation = 0;
  limited.body = &body_;
  body_ = support::held_bar({8, 1, 1}, mesh::ElementOrder::kQuadratic);
  QuadraticProgramLaw law(servo(), limited);
  start(law, {0, 0, 0.05});
  placements_.resize(1);
  placements_[0].X_OB = lid.body.X_OB;
  const mesh::Surface surface = mesh::extract_surface(body_.mesh);
  double nearest = 1, farthest = 0;
  for (int i = 0; i < 780; ++i) {  // until it is 6 mm above the clamp, which cannot move
    if (i > 500) {
      placements_[0].V_O_B.linear.z() = -kSinking;
      placements_[0].X_OB.translation().z() -= kSinking * kPeriod;
    }
    tick();
    if (i < 480) continue;
    const double top = placements_[0].X_OB.translation().z();
    const double gap = support::least_on_surface(surface, model_->positions(),
                                                 [&](const Vector3d& p) { return top - p.z(); });
    nearest = std::min(nearest, gap);
    farthest = std::max(farthest, gap);
  }
  EXPECT_GT(nearest, 0.9 * kClearance);
  EXPECT_LT(farthest, kClearance + 0.004) << "it stays in the way";
}

/// What the hand itself carries comes no nearer when the hand moves, and does not hold it back;
/// what is fixed at the same place makes the hand reach the target in another way.
TEST_F(BarServo, IsNotHeldBackByWhatItsHandCarries) {
  for (const bool is_carried : {true, false}) {
    QuadraticProgramLaw::Limited limited;
    LimitedObstacle& palm = limited.limits.obstacles.emplace_back();
    palm.body.shape = collision::Sphere{0.03};
    palm.body.X_OB.translation() << 0.49, 0.03, 0.093;  // within the clearance
    if (is_carried) palm.body.hand = 0;
    limited.limits.fallback_deviation = 0;
    limited.body = &body_;
    body_ = support::held_bar({8, 1, 1}, mesh::ElementOrder::kQuadratic);
    QuadraticProgramLaw law(servo(), limited);
    start(law, {0, 0, 0.04});
    placements_.assign(1, {});
    for (int i = 0; i < 600; ++i) {
      placements_[0].X_OB = palm.body.X_OB;
      if (is_carried)
        placements_[0].X_OB = X_OG_ * body_.grasps[0].X_OG_rest.inverse() * palm.body.X_OB;
      tick();
    }
    EXPECT_LT(error(), 2e-3);
    const double gap = support::least_on_surface(
        mesh::extract_surface(body_.mesh), model_->positions(),
        [&](const Vector3d& p) { return (p - placements_[0].X_OB.translation()).norm() - 0.03; });
    if (is_carried)
      EXPECT_LT(gap, 0.9 * palm.clearance);
    else
      EXPECT_GT(gap, 0.97 * palm.clearance);
  }
}

TEST_F(BarServo, PressesATableWithTheLargestForceAndNoMore) {
  LimitedObstacle table;
  table.body.shape = collision::HalfSpace{};
  table.body.X_OB.translation().z() = -0.004;
  table.body.friction = 0.3;
  table.may_touch = true;
  options_.contact.obstacles = {table.body};
  const auto force = [&] {
    double sum = 0;
    for (const elasticity::SurfaceContact& contact : model_->contacts())
      sum += contact.normal_force();
    return sum;
  };
  QuadraticProgramLaw free(servo(), {});
  start(free, {0, 0, -0.012});
  for (int i = 0; i < 600; ++i) tick();
  const double freely = force();
  ASSERT_GT(freely, 0.1);
  QuadraticProgramLaw::Limited limited;
  table.force = 0.5 * freely;
  limited.limits.obstacles = {table};
  limited.body = &body_;
  QuadraticProgramLaw law(servo(), limited);
  start(law, {0, 0, -0.012});
  double largest = 0;
  int remarked = 0;
  constexpr int kTicks = 800, kLast = 200;
  for (int i = 0; i < kTicks; ++i) {
    tick();
    largest = std::max(largest, force());
    const bool says = std::string(output_.remark) ==
                      "the target lies beyond the limit of the force on an obstacle";
    remarked += says && i >= kTicks - kLast ? 1 : 0;
  }
  EXPECT_LE(largest, 1.1 * table.force);  // while the bar slides, a sensitivity lags behind
  EXPECT_NEAR(force(), table.force, 0.1 * table.force) << "as near as it may";
  EXPECT_GE(remarked, 0.5 * kLast) << "of the last ticks";
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

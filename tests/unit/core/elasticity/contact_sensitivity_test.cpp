// Derivatives of the equilibrium in contact, against central differences of equilibria.
#include <gtest/gtest.h>

#include "tests/unit/core/elasticity/obstacles.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

struct World {
  const char* name;
  collision::Obstacle obstacle;
};

std::ostream& operator<<(std::ostream& out, const World& world) { return out << world.name; }

/// A bar between its fixed end and a hand that presses it down onto an obstacle, converged far
/// beyond what a loop needs.
class Pressed {
 public:
  explicit Pressed(const collision::Obstacle& obstacle, double scale = 1)
      : body_(make_bar({0.2, 0.03, 0.03}, {6, 1, 1}, mesh::ElementOrder::kQuadratic,
                       {scale * 3e4, 0.3, 100})),
        obstacle_(obstacle),
        model_(body_, options(obstacle)) {
    body_.gravity_O = {0, 0, -kGravity};
    model_.prepare();
    model_.set_gravity({0, 0, -kGravity});
    const bool lifts = obstacle.hand == 0;  // what it carries presses from below
    for (int i = 0; i <= 40; ++i) {
      hand_ = body_.grasps[0].X_OG_rest;
      hand_.translation() += i / 40.0 * Vector3d(-0.002, 0.001, lifts ? 0.008 : -0.008);
      hand_.linear() = rotation(lifts ? 0 : 0.1 * i / 40, Vector3d::UnitY());
      move(hand_);
    }
  }

  const math::Pose& hand() const { return hand_; }
  CorotationalModel& model() { return model_; }

  /// Positions, stacked, with the hand at `pose` and the obstacle displaced in its frame.
  VectorXd move(const math::Pose& pose,
                const math::Vector6d& displacement = math::Vector6d::Zero()) {
    model_.hold(0, pose);
    std::vector<collision::Placement> placements(1);
    placements[0].X_OB = obstacle_.X_OB;
    if (obstacle_.hand == 0)
      placements[0].X_OB = pose * body_.grasps[0].X_OG_rest.inverse() * obstacle_.X_OB;
    collision::FreeMotion motion;
    std::copy_n(displacement.data(), 6, motion.begin());
    collision::displace(collision::free_directions({obstacle_}), motion, placements);
    model_.place_obstacle(0, placements[0]);
    for (int i = 0; i < 60; ++i) {
      const StepReport report = model_.step(kDt);
      refactor(model_);
      if (i > 2 && report.status == StepStatus::kConverged) break;
    }
    return Eigen::Map<const VectorXd>(model_.positions().data(), model_.positions().size());
  }

  /// Pressing points: sample, and whether it slips.
  std::vector<std::pair<int, bool>> states() const {
    std::vector<std::pair<int, bool>> pressing;
    for (const SurfaceContact& contact : model_.contacts()) {
      if (contact.presses()) pressing.emplace_back(contact.sample, contact.slips);
    }
    return pressing;
  }

 private:
  static SolverOptions options(const collision::Obstacle& obstacle) {
    SolverOptions options = with_obstacles({obstacle});
    options.iterations = 30;
    options.tolerance = 1e-10;
    options.accuracy = 0;
    options.contact.sweeps = 300;
    options.contact.tolerance = 1e-12;
    return options;
  }

  Body body_;
  collision::Obstacle obstacle_;
  CorotationalQuasistatic model_;
  math::Pose hand_;
};

/// N, sum of the normal forces.
double normal_force(const CorotationalModel& model) {
  double sum = 0;
  for (const SurfaceContact& contact : model.contacts()) sum += contact.normal_force();
  return sum;
}

/// The node of the bar's upper side next to its middle.
int top_middle(const mesh::ElementMesh& mesh) {
  int nearest = 0;
  const Vector3d middle(0.1, 0.015, 0.03);
  for (int n = 0; n < mesh.node_count(); ++n) {
    if ((mesh.nodes.col(n) - middle).norm() < (mesh.nodes.col(nearest) - middle).norm())
      nearest = n;
  }
  return nearest;
}

collision::Obstacle of_hand(collision::Obstacle obstacle) {
  obstacle.hand = 0;
  return obstacle;
}

class ContactSensitivity : public ::testing::TestWithParam<World> {};

double relative(const VectorXd& got, const VectorXd& expected) {
  return (got - expected).norm() / expected.norm();
}

TEST_P(ContactSensitivity, OfHandMotionAndForceEqualsCentralDifferences) {
  Pressed pressed(GetParam().obstacle);
  const auto states = pressed.states();
  ASSERT_GE(states.size(), 2u) << "in contact";
  for (const auto& [sample, slips] : states) EXPECT_EQ(slips, GetParam().obstacle.friction == 0);

  CorotationalModel& model = pressed.model();
  const int loaded = top_middle(model.body().mesh);
  mesh::PointWeights point;
  point.count = 1;
  point.nodes[0] = loaded;
  point.weights[0] = 1;
  model.watch_contact(0, point);
  pressed.move(pressed.hand());
  refactor(model);
  model.step(kDt);
  const Sensitivity sensitivity = model.sensitivity();
  ASSERT_TRUE(sensitivity.valid);

  const double h = 2e-6;
  for (int k = 0; k < 6; ++k) {
    math::Pose forward = pressed.hand(), backward = forward;
    const double step = k < 3 ? h : h / 0.1;
    if (k < 3) {
      forward.translation()[k] += step;
      backward.translation()[k] -= step;
    } else {
      forward.linear() = rotation(step, Vector3d::Unit(k - 3)) * forward.linear();
      backward.linear() = rotation(-step, Vector3d::Unit(k - 3)) * backward.linear();
    }
    const VectorXd ahead = pressed.move(forward);
    const math::Vector6d w_ahead = model.reaction(0).vector();
    const double force_ahead = normal_force(model);
    EXPECT_EQ(pressed.states(), states) << "the state has changed";
    const VectorXd behind = pressed.move(backward);
    const math::Vector6d w_behind = model.reaction(0).vector();
    const double force_change = (force_ahead - normal_force(model)) / (2 * step);
    EXPECT_EQ(pressed.states(), states) << "the state has changed";
    EXPECT_LT(relative(sensitivity.dx_dxi[0].col(k), (ahead - behind) / (2 * step)), 1e-4) << k;
    EXPECT_LT(relative(sensitivity.dw_dxi[0][0].col(k), (w_ahead - w_behind) / (2 * step)), 1e-3)
        << k;
    const auto& by_motion = sensitivity.dcontact_dxi[0][0];
    EXPECT_NEAR(by_motion[k], force_change, 1e-3 * by_motion.norm()) << k;
  }
  EXPECT_GT(sensitivity.dcontact_dxi[0][0].norm(), 1);
  for (int axis = 0; axis < 3; ++axis) {
    const double force = 4e-5;  // N, so that what the settled positions lack is below 1e-4
    model.loads()(axis, loaded) = force;
    const VectorXd ahead = pressed.move(pressed.hand());
    model.loads()(axis, loaded) = -force;
    const VectorXd behind = pressed.move(pressed.hand());
    model.loads()(axis, loaded) = 0;
    EXPECT_LT(relative(sensitivity.dx_dforce[0].col(axis), (ahead - behind) / (2 * force)), 1e-4)
        << axis;
  }
}

TEST_P(ContactSensitivity, OfMotionOfTheObstacleEqualsCentralDifferences) {
  collision::Obstacle obstacle = GetParam().obstacle;
  obstacle.pose_deviation.setOnes();
  Pressed pressed(obstacle);
  const auto states = pressed.states();
  CorotationalModel& model = pressed.model();
  pressed.move(pressed.hand());
  model.watch_contact(0, {});  // a fresh factor
  refactor(model);
  model.step(kDt);
  const Sensitivity sensitivity = model.sensitivity();
  ASSERT_EQ(sensitivity.dx_dobstacle.cols(), 6);
  const double largest = sensitivity.dx_dobstacle.colwise().norm().maxCoeff();
  ASSERT_GT(largest, 0.1);
  for (int k = 0; k < 6; ++k) {
    const double step = k < 3 ? 2e-6 : 2e-5;
    const VectorXd ahead = pressed.move(pressed.hand(), step * math::Vector6d::Unit(k));
    const math::Vector6d w_ahead = model.reaction(0).vector();
    const double force_ahead = normal_force(model);
    EXPECT_EQ(pressed.states(), states) << "the state has changed";
    const VectorXd behind = pressed.move(pressed.hand(), -step * math::Vector6d::Unit(k));
    const math::Vector6d w_behind = model.reaction(0).vector();
    const double force_change = (force_ahead - normal_force(model)) / (2 * step);
    EXPECT_NEAR(sensitivity.dcontact_dobstacle[0][k], force_change,
                1e-3 * sensitivity.dcontact_dobstacle[0].norm())
        << k;
    EXPECT_EQ(pressed.states(), states) << "the state has changed";
    pressed.move(pressed.hand());
    const VectorXd difference = (ahead - behind) / (2 * step);
    EXPECT_LT((sensitivity.dx_dobstacle.col(k) - difference).norm(), 2e-4 * largest) << k;
    EXPECT_LT((sensitivity.dw_dobstacle[0].col(k) - (w_ahead - w_behind) / (2 * step)).norm(),
              1e-3 * sensitivity.dw_dobstacle[0].norm())
        << k;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Worlds, ContactSensitivity,
    ::testing::Values(World{"smooth_table", plane({0, 0, -0.004}, {0, 0, 1}, 0)},
                      World{"sticking_table", plane({0, 0, -0.004}, {0, 0, 1}, 5)},
                      World{"smooth_rod", rod({0.12, 0.015, -0.024}, 0.02, 0)},
                      World{"smooth_rod_of_the_hand",
                            of_hand(rod({0.14, 0.015, -0.0215}, 0.02, 0))}));

TEST(ContactSensitivityOfModulus, EqualsCentralDifferencesOnASmoothRod) {
  const collision::Obstacle obstacle = rod({0.12, 0.015, -0.024}, 0.02, 0);
  const double h = 1e-3;
  Pressed present(obstacle), stiffer(obstacle, std::exp(h)), softer(obstacle, std::exp(-h));
  refactor(present.model());
  present.model().step(kDt);
  const VectorXd difference = (stiffer.move(stiffer.hand()) - softer.move(softer.hand())) / (2 * h);
  ASSERT_GT(difference.norm(), 1e-4);
  EXPECT_LT(
      relative(present.model().sensitivity().dx_dparameter.col(Sensitivity::kLogYoung), difference),
      1e-3);
}

}  // namespace
}  // namespace palpate::elasticity

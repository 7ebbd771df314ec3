#include "sim/object/compliant_grasp.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/sim/object/plant_rig.hpp"

namespace palpate::object {
namespace {

constexpr double kGrip = 2, kFriction = 0.5;  // N: it bears 1 N

PlantOptions pinched_block() {
  PlantOptions options = small_free_block();
  options.young_modulus = 300e3;
  options.poisson_ratio = 0;
  options.mass_damping = 20;
  GraspOptions grasp = hold({{0, 0, 0}, {0.10, 0.06, 0.05}});
  grasp.pinch_axis = 1;
  grasp.grip = kGrip;
  grasp.friction = kFriction;
  grasp.damping = 5;
  options.grasps = {grasp};
  return options;
}

/// Pulls the whole object uniformly with a force that ramps from one value to another.
void ramp(HyperelasticPlant& plant, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
          int milliseconds) {
  const Eigen::VectorXd shares = plant.nodal_masses() / plant.nodal_masses().sum();
  for (int i = 1; i <= milliseconds; ++i) {
    const Eigen::Vector3d force = from + (to - from) * i / milliseconds;
    plant.clear_forces();
    for (int n = 0; n < shares.size(); ++n)
      plant.add_force(plant.locate(plant.rest_positions().col(n)), shares[n] * force);
    plant.step(1e-3);
  }
}

TEST(CompliantGrasp, SlipsWhenOverloadedAndNotBefore) {
  for (const Eigen::Vector3d& along :
       {Eigen::Vector3d(-1, 0, 0), Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(-0.6, 0, 0.8)}) {
    HyperelasticPlant plant(pinched_block());
    ramp(plant, Eigen::Vector3d::Zero(), 0.97 * along, 1000);
    ramp(plant, 0.97 * along, 0.97 * along, 300);
    EXPECT_LT(plant.grasp().slip().share, 1);
    EXPECT_NEAR(plant.hand_wrench().force.dot(along), -0.97, 1e-3);
    const double held = plant.grasp().slip().distance;
    EXPECT_LT(held, 2e-4);  // a little, near the load
    ramp(plant, 0.97 * along, 0.97 * along, 300);
    EXPECT_NEAR(plant.grasp().slip().distance, held, 1e-6);

    ramp(plant, 0.97 * along, 1.05 * along, 80);
    ramp(plant, 1.05 * along, 1.05 * along, 400);
    EXPECT_EQ(plant.grasp().slip().share, 1);
    EXPECT_GT(plant.grasp().slip().distance, 0.02);
    EXPECT_NEAR(plant.hand_wrench().force.norm(), kGrip * kFriction, 0.002);
  }
}

TEST(CompliantGrasp, SlippedDistanceIsTheWayTheObjectWent) {
  HyperelasticPlant plant(pinched_block());
  const Eigen::VectorXd shares = plant.nodal_masses() / plant.nodal_masses().sum();
  math::Pose X = math::Pose::Identity();
  // The hand is pulled off along x; inertia holds the block back.
  for (int i = 0; i < 200; ++i) {
    X.translation().x() += 2e-3;
    plant.step(1e-3, X, {{2, 0, 0}, Eigen::Vector3d::Zero()});
  }
  const double moved =
      plant.positions().row(0).dot(shares) - plant.rest_positions().row(0).dot(shares);
  EXPECT_EQ(plant.grasp().slip().share, 0);  // it has caught up
  // Except for the elongation of the springs before they slipped.
  EXPECT_NEAR(plant.grasp().slip().distance, X.translation().x() - moved, 2e-3);
  EXPECT_GT(plant.grasp().slip().distance, 0.01);
}

TEST(CompliantGrasp, EveryPadStaysWithinItsCone) {
  HyperelasticPlant plant(pinched_block());
  math::Pose X = math::Pose::Identity();
  bool slipped = false;
  for (int i = 0; i < 300; ++i) {
    const math::Twist V{{0.3 * std::cos(0.05 * i), 0.05, 0.2 * std::sin(0.03 * i)}, {1, 0, 2}};
    X.translation() += 1e-3 * V.linear;
    X.linear() = math::exp_rotation(1e-3 * V.angular) * X.linear();
    plant.step(1e-3, X, V);
    for (const auto& pad : plant.grasp().pads()) {
      const Eigen::Vector3d n = X.linear() * pad.normal_G;
      const double pull = n.dot(pad.force_O);
      const double along = (pad.force_O - pull * n).norm();
      EXPECT_LE(pull, pad.grip * (1 + 1e-9));
      EXPECT_LE(along, kFriction * std::max(0.0, pad.grip - pull) + 1e-9);
      slipped = slipped || pad.slipping;
    }
  }
  EXPECT_TRUE(slipped);
}

TEST(CompliantGrasp, SlippingHandsImpulseIsTheMomentumOfAFreeBody) {
  PlantOptions options = pinched_block();
  options.mass_damping = 0;
  HyperelasticPlant plant(options);
  Eigen::Vector3d impulse = Eigen::Vector3d::Zero();
  math::Pose X = math::Pose::Identity();
  double most_slipped = 0;
  for (int i = 0; i < 100; ++i) {
    X.translation().x() += 1e-3;
    plant.step(1e-3, X, {{1, 0, 0}, Eigen::Vector3d::Zero()});
    impulse += 1e-3 * plant.hand_wrench().force;
    most_slipped = plant.grasp().slip().greatest;
  }
  EXPECT_GT(most_slipped, 1e-4);
  EXPECT_LT((linear_momentum(plant) - impulse).norm(), 1e-9 * impulse.norm());
}

TEST(CompliantGrasp, TwoHandsPullAgainstEachOther) {
  PlantOptions options = small_free_block();
  options.mass_damping = 20;
  options.grasps = {hold(face_x(0)), hold(face_x(0.10))};
  HyperelasticPlant plant(options);
  math::Pose X = math::Pose::Identity();
  for (int i = 0; i < 500; ++i) {
    X.translation().x() += 1e-5;
    plant.move_hand(1, X, {{1e-2, 0, 0}, Eigen::Vector3d::Zero()});
    plant.step(1e-3);
  }
  EXPECT_TRUE(plant.settle(10, 1e-6).converged);
  const double force = plant.hand_wrench(1).force.x();
  EXPECT_NEAR(plant.hand_wrench(0).force.x(), -force, 1e-5 * force);
  // Between uniaxial stress and uniaxial strain, as the pads also constrain the sides of the ends.
  const double strain = 0.05, area = 0.06 * 0.05;
  EXPECT_GT(force, 0.9 * 30e3 * strain * area);
  EXPECT_LT(force, 1.35 * 30e3 * strain * area);
}

TEST(CompliantGrasp, RefusesNonsense) {
  const auto refuses = [](auto change) {
    PlantOptions options = pinched_block();
    change(options);
    EXPECT_THROW(HyperelasticPlant{options}, std::invalid_argument);
  };
  refuses([](PlantOptions& o) { o.grasps[0].stiffness = 0; });
  refuses([](PlantOptions& o) { o.grasps[0].damping = -1; });
  refuses([](PlantOptions& o) { o.grasps[0].grip = -1; });
  refuses([](PlantOptions& o) { o.grasps[0].friction = std::nan(""); });
  refuses([](PlantOptions& o) { o.grasps[0].pinch_axis = 3; });
  refuses([](PlantOptions& o) { o.grasps.resize(3, o.grasps[0]); });
}

/// A bar without lateral strain, clamped at x = 0 and held at its other end.
PlantOptions held_bar() {
  PlantOptions options;
  options.size = {0.3, 0.04, 0.04};
  options.elements = {6, 1, 1};
  options.poisson_ratio = 0;
  options.mass_damping = 20;
  options.clamp = face_x(0);
  options.grasps = {
      hold(face_x(0.3), math::make_pose(Eigen::Matrix3d::Identity(), {0.3, 0.02, 0.02}))};
  return options;
}

TEST(CompliantGrasp, SlideShortensTheBarByItsLength) {
  const PlantOptions options = held_bar();
  HyperelasticPlant plant(options);
  constexpr double kSlide = 3e-4;
  for (int i = 1; i <= 100; ++i) {
    plant.slide_hand(0, {kSlide * i / 100, 0, 0}, {kSlide / 0.1, 0, 0});
    plant.step(1e-3);
  }
  EXPECT_TRUE(plant.settle(20, 1e-6).converged);
  plant.step(1e-3);
  EXPECT_NEAR(plant.grasp().slip().distance, kSlide, 1e-12);
  EXPECT_EQ(plant.grasp().slip().share, 0);  // no sensor of the hand reports it
  // Bar and pads in series; the hand, which slid outwards along the bar, stands still.
  const double bar = 0.3 / (options.young_modulus * 0.04 * 0.04);
  const double force = kSlide / (bar + 1 / options.grasps[0].stiffness);
  EXPECT_NEAR(plant.hand_wrench().force.x(), -force, 3e-3 * force);
}

TEST(CompliantGrasp, AfterASlideTheGraspIsThatOfAHandThatBeganThere) {
  const Eigen::Vector3d slide(4e-3, 1e-3, -2e-3);
  const math::Pose X_start =
      math::make_pose(math::exp_rotation({0.1, 0.3, -0.2}), {0.3, 0.02, 0.02});
  const math::Pose X_end = math::make_pose(math::exp_rotation({0.3, 0.2, 0}), {0.29, 0.03, 0.05});
  PlantOptions options = held_bar();
  const auto go_to_the_end = [&](HyperelasticPlant& plant) {
    plant.move_hand(0, X_end, {});
    plant.step(0.2);
    EXPECT_TRUE(plant.settle(20, 1e-7).converged);
    plant.step(1e-3);
  };
  options.grasps[0].X_OG_rest = X_start;
  HyperelasticPlant slid(options);
  slid.slide_hand(0, slide, Eigen::Vector3d::Zero());
  go_to_the_end(slid);
  options.grasps[0].X_OG_rest.translation() += X_start.linear() * slide;
  HyperelasticPlant fresh(options);
  go_to_the_end(fresh);
  const math::Wrench a = slid.hand_wrench(), b = fresh.hand_wrench();
  EXPECT_GT(b.force.norm(), 0.1);
  EXPECT_LT((a.force - b.force).norm(), 1e-4 * b.force.norm());
  EXPECT_LT((a.torque - b.torque).norm(), 1e-4 * b.torque.norm());
  EXPECT_LT((slid.positions() - fresh.positions()).colwise().norm().maxCoeff(), 1e-6);
}

TEST(ClampPads, YieldByForceOverStiffness) {
  PlantOptions options = held_bar();
  options.grasps.clear();
  options.clamp_pads = ClampPads{250, 1};
  HyperelasticPlant plant(options);
  PlantOptions rigid = options;
  rigid.clamp_pads.reset();
  EXPECT_EQ(plant.clamped_nodes(), HyperelasticPlant(rigid).clamped_nodes());
  EXPECT_FALSE(plant.grasped());
  const Eigen::Vector3d force(0.02, 0, 0);  // N, uniform over the free end
  const HexahedralGrid grid = even_grid(options.origin, options.size, options.elements);
  const Eigen::VectorXd end = grid.patch_areas(face_x(0.3)) / (0.04 * 0.04);
  for (int n = 0; n < end.size(); ++n)
    if (end[n] > 0) plant.add_force(plant.locate(grid.nodes().col(n)), end[n] * force);
  EXPECT_TRUE(plant.settle(30, 1e-6).converged);
  const Eigen::VectorXd near = grid.patch_areas(face_x(0)) / (0.04 * 0.04);
  EXPECT_NEAR(plant.positions().row(0).dot(near), force.x() / 250, 1e-3 * force.x() / 250);
  EXPECT_LT((plant.clamp_wrench().force + force).norm(), 1e-3 * force.norm());
  EXPECT_NEAR(plant.clamp_wrench().torque.z(), 0.02 * force.x(), 1e-3 * 0.02 * force.x());
}

TEST(ClampPads, NeedAClampAndPositiveStiffness) {
  PlantOptions options = held_bar();
  options.clamp_pads = ClampPads{0, 1};
  EXPECT_THROW(HyperelasticPlant{options}, std::invalid_argument);
  options.clamp_pads = ClampPads{100, -1};
  EXPECT_THROW(HyperelasticPlant{options}, std::invalid_argument);
  options.clamp_pads = ClampPads{100, 1};
  options.clamp.reset();
  EXPECT_THROW(HyperelasticPlant{options}, std::invalid_argument);
}

/// A free block whose hand can open; it holds the end at x = 0.
PlantOptions block_with_jaws() {
  PlantOptions options = small_free_block();
  options.elements = {10, 1, 1};
  options.mass_damping = 20;
  GraspOptions grasp = hold({{0, 0, 0}, {0.03, 0.06, 0.05}});
  grasp.damping = 5;
  grasp.jaws = Box{{-0.001, -0.001, -0.001}, {0.031, 0.061, 0.051}};
  options.grasps = {grasp};
  return options;
}

void move(HyperelasticPlant& plant, const Eigen::Vector3d& to, int milliseconds) {
  const Eigen::Vector3d from = plant.grasp().hand().X_OG().translation();
  for (int i = 1; i <= milliseconds; ++i) {
    const Eigen::Vector3d p = from + (to - from) * i / milliseconds;
    plant.step(1e-3, math::make_pose(Eigen::Matrix3d::Identity(), p), math::Twist());
  }
}

TEST(CompliantGrasp, AnOpenHandLeavesTheObjectWhereItIs) {
  HyperelasticPlant plant(block_with_jaws());
  EXPECT_TRUE(plant.grasped());
  plant.open_hand(0);
  EXPECT_FALSE(plant.grasped());
  move(plant, {0.02, 0, 0}, 100);
  EXPECT_TRUE(plant.positions().isApprox(plant.rest_positions(), 1e-12));
  EXPECT_EQ(plant.hand_wrench().force.norm(), 0);
  EXPECT_EQ(plant.slipping_share(0), 0);
}

TEST(CompliantGrasp, AHandThatClosesHoldsWhatIsBetweenItsJaws) {
  HyperelasticPlant plant(block_with_jaws());
  std::vector<int> before;
  for (const auto& pad : plant.grasp().pads()) before.push_back(pad.node);
  plant.open_hand(0);
  move(plant, {0.03, 0, 0}, 100);
  plant.close_hand(0);
  ASSERT_TRUE(plant.grasped());
  double stiffness = 0;
  for (const auto& pad : plant.grasp().pads()) {
    const double x = plant.rest_positions()(0, pad.node);
    EXPECT_GE(x, 0.03 - 1e-3 - 1e-9);
    EXPECT_LE(x, 0.061 + 1e-9);
    stiffness += pad.stiffness;
  }
  const double all = block_with_jaws().grasps[0].stiffness;
  EXPECT_NEAR(stiffness, all, 1e-9 * all);
  plant.step(1e-3);
  EXPECT_LT(plant.hand_wrench().force.norm(), 1e-9) << "without spring force";
  move(plant, {0.03, 0, 0.02}, 1000);
  move(plant, {0.03, 0, 0.02}, 1000);
  const Eigen::Vector3d moved = (plant.positions() - plant.rest_positions()).rowwise().mean();
  EXPECT_LT((moved - Eigen::Vector3d(0, 0, 0.02)).norm(), 1e-4) << "it carries the block";

  plant.open_hand(0);
  move(plant, {0, 0, 0.02}, 100);
  plant.close_hand(0);
  std::vector<int> after;
  for (const auto& pad : plant.grasp().pads()) after.push_back(pad.node);
  EXPECT_EQ(after, before) << "the same place";
}

TEST(CompliantGrasp, AHandThatClosesOnNothingRemainsOpen) {
  HyperelasticPlant plant(block_with_jaws());
  plant.open_hand(0);
  move(plant, {0, 0, 1}, 10);
  plant.close_hand(0);
  EXPECT_FALSE(plant.grasped());
}

TEST(CompliantGrasp, WithoutJawsItNeverOpens) {
  PlantOptions options = block_with_jaws();
  options.grasps[0].jaws.reset();
  HyperelasticPlant plant(options);
  plant.open_hand(0);
  EXPECT_TRUE(plant.grasped());
}

}  // namespace
}  // namespace palpate::object

// The filter with the co-rotational model beneath it, in worlds that another such model makes.
#include "core/estimation/pose_wrench_filter.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "core/elasticity/corotational_model.hpp"
#include "core/estimation/pose_driven.hpp"
#include "rt/loop/allocation_counter.hpp"
#include "tests/unit/core/estimation/rigid_model.hpp"

namespace palpate::estimation {
namespace {

using Eigen::Vector3d;
using elasticity::CorotationalQuasistatic;
using sensing::Freshness;

elasticity::Body bar() { return support::held_bar({8, 1, 1}, mesh::ElementOrder::kQuadratic); }

void refactor(CorotationalQuasistatic& model) {
  if (elasticity::Refactorisation* job = model.wanted_refactorisation()) {
    job->run();
    model.install(*job);
  }
}

/// The true object with a hand of its own, and sensors that tell of both.
class World {
 public:
  explicit World(const elasticity::Body& body, int seed = 1) : model_(body), random_(seed) {
    model_.prepare();
    hand_ = body.grasps[0].X_OG_rest;
    model_.set_gravity(body.gravity_O);
  }

  void tick(EstimationInputs& inputs) {
    const math::Pose X_OG = hand_ * shift_;
    model_.hold(0, X_OG);
    refactor(model_);
    model_.step(1e-3);
    GraspInput& grasp = inputs.grasps[0];
    grasp.pose_freshness = Freshness::kNew;
    grasp.holding = true;
    grasp.X_OG = hand_;
    // As late as the filter takes it to be.
    lagged_ += (1 - std::exp(-0.1)) * (model_.reaction(0).vector() - lagged_);
    if (ticks_++ == 0) lagged_ = model_.reaction(0).vector();
    math::Vector6d wrench = lagged_;
    wrench.head<3>() += X_OG.linear() * bias_.head<3>();
    wrench.tail<3>() += X_OG.linear() * bias_.tail<3>();
    for (int i = 0; i < 6; ++i) wrench[i] += (i < 3 ? 0.02 : 0.002) * normal_(random_);
    grasp.wrench_valid = true;
    grasp.F_G_O = math::Wrench::from(wrench);
  }

  CorotationalQuasistatic& model() { return model_; }
  math::Pose hand_ = math::Pose::Identity(), shift_ = math::Pose::Identity();
  math::Vector6d bias_ = math::Vector6d::Zero();

 private:
  CorotationalQuasistatic model_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  math::Vector6d lagged_ = math::Vector6d::Zero();
  int ticks_ = 0;
};

class PoseWrenchFilterTest : public ::testing::Test {
 protected:
  void start(const elasticity::Body& body, PoseWrenchFilter::Options options = {}) {
    options.contacts = true;
    model_ = std::make_unique<CorotationalQuasistatic>(body);
    model_->prepare();
    const mesh::Surface surface = mesh::extract_surface(body.mesh);
    filter_ = std::make_unique<PoseWrenchFilter>(body, surface, options);
    filter_->activate(*model_);
    inputs_.grasp_count = 1;
  }
  void run(World& world, double seconds, const std::function<void(double)>& move = {}) {
    for (int i = 0; i < std::lround(seconds * 1000); ++i) {
      if (move) move(1e-3 * i);
      world.tick(inputs_);
      refactor(*model_);
      result_ = filter_->update(inputs_, *model_, estimate_);
    }
  }
  double worst_error(World& world) const {
    return (model_->positions() - world.model().positions()).colwise().norm().maxCoeff();
  }
  /// Up, aside and turned by way of half a sine, 60 mm and 0.4 rad.
  static std::function<void(double)> path(World& world, double seconds) {
    const math::Pose from = world.hand_;
    return [&world, from, seconds](double t) {
      const double share = 0.5 - 0.5 * std::cos(M_PI * t / seconds);
      world.hand_ = from;
      world.hand_.translation() += share * Vector3d(-0.01, 0.03, 0.05);
      world.hand_.linear() = math::exp_rotation(share * Vector3d(0.3, -0.2, 0.2)) * from.linear();
    };
  }

  std::unique_ptr<CorotationalQuasistatic> model_;
  std::unique_ptr<PoseWrenchFilter> filter_;
  EstimationInputs inputs_;
  Estimate estimate_;
  sensing::UpdateResult result_;
};

TEST_F(PoseWrenchFilterTest, ResponseToAForceIsThatOfTheModelsFactor) {
  const elasticity::Body body = bar();
  CorotationalQuasistatic model(body);
  model.prepare();
  model.hold(0, body.grasps[0].X_OG_rest);
  const mesh::PointLocator locator(body.mesh);
  const mesh::PointWeights point = locator.locate({0.1, 0.02, 0.06});
  model.watch_contact(0, point);
  for (int i = 0; i < 300; ++i) {
    math::Pose X_OG = body.grasps[0].X_OG_rest;
    X_OG.translation() += Vector3d(0, 0, 1e-4 * i);
    model.hold(0, X_OG);
    refactor(model);
    model.step(1e-3);
  }
  ASSERT_TRUE(model.sensitivity().valid);
  const Eigen::Matrix<double, 6, 3> expected = model.sensitivity().dw_dforce[0][0];
  ASSERT_GT(expected.norm(), 0.1);
  const PatchMotion firm(0);
  EXPECT_LT((ContactSearch::response(point, model.sensitivity(), firm, 0) - expected).norm(),
            1e-3 * expected.norm());
}

TEST_F(PoseWrenchFilterTest, FindsStiffnessInThreeSecondsOfMotion) {
  for (const double factor : {0.6, 1.0, 1.5}) {
    elasticity::Body truth = bar();
    truth.material.young_modulus *= factor;
    World world(truth);
    world.bias_ << 0.03, 0.02, -0.03, 0.001, 0, -0.002;
    start(bar());
    run(world, 3, path(world, 3));
    const math::Vector6d true_reaction = world.model().reaction(0).vector();
    for (int i = 0; i < 6; ++i) {
      EXPECT_GT(estimate_.reaction_deviation[0][i], 0);
      EXPECT_LT(std::abs(estimate_.reaction[0].vector()[i] - true_reaction[i]),
                3 * estimate_.reaction_deviation[0][i]);
    }
    EXPECT_NEAR(estimate_.log_young_modulus, std::log(truth.material.young_modulus), 0.14)
        << factor;
    EXPECT_GT(estimate_.log_young_modulus_deviation, 0);
    EXPECT_LT(std::abs(estimate_.log_young_modulus - std::log(truth.material.young_modulus)),
              3 * estimate_.log_young_modulus_deviation);
    EXPECT_LT(worst_error(world), 1e-3);
    EXPECT_FALSE(estimate_.unknown_contact.found);
    EXPECT_EQ(result_.status, sensing::Status::kOk);
  }
}

TEST_F(PoseWrenchFilterTest, DoesNotGuessAStiffnessThatNothingTellsOf) {
  elasticity::Body truth = bar();
  truth.gravity_O.setZero();
  truth.material.young_modulus *= 1.5;
  elasticity::Body nominal = bar();
  nominal.gravity_O.setZero();
  World world(truth);
  start(nominal);
  run(world, 1);  // at rest nothing is stretched
  EXPECT_LT(estimate_.log_young_modulus_deviation, 0) << "not observable";
  EXPECT_NEAR(estimate_.log_young_modulus, std::log(nominal.material.young_modulus), 0.05);
}

TEST_F(PoseWrenchFilterTest, FindsWhereSomethingPushesWhileTheHandRests) {
  const elasticity::Body body = bar();
  World world(body);
  start(body);
  run(world, 1, path(world, 1));
  run(world, 1.5);
  ASSERT_FALSE(estimate_.unknown_contact.found);
  const mesh::PointLocator locator(body.mesh);
  const Vector3d rest(0.25, 0.03, 0.06);
  const mesh::PointWeights place = locator.locate(rest);
  const Vector3d force(0, 0, -0.5);
  for (int i = 0; i < place.count; ++i)
    world.model().loads().col(place.nodes[i]) += place.weights[i] * force;
  run(world, 0.12);
  ASSERT_TRUE(estimate_.unknown_contact.found);
  run(world, 0.6);
  EXPECT_LT(
      (estimate_.unknown_contact.location_O - place.interpolate(world.model().positions())).norm(),
      0.04);
  EXPECT_LT((estimate_.unknown_contact.force_O - force).norm(), 0.25);
  EXPECT_LT(worst_error(world), 5e-3);

  world.model().loads().setZero();
  run(world, 1.5);
  EXPECT_FALSE(estimate_.unknown_contact.found) << "gone with the push";
  EXPECT_LT(worst_error(world), 2e-3);
}

TEST_F(PoseWrenchFilterTest, AStiffGraspTellsOfItsOffset) {
  // A short thick piece: a millimetre of offset is newtons there, and the wrench wins over the
  // pose.
  elasticity::Body body = bar();
  body.mesh.nodes.row(0) *= 0.2;
  for (elasticity::GraspRegion& grasp : body.grasps) grasp.X_OG_rest.translation().x() *= 0.2;
  World world(body);
  world.shift_.translation() = Vector3d(0.6e-3, -0.8e-3, 0.5e-3);
  PoseWrenchFilter::Options options;
  options.filter.log_young = 0.01;
  options.filter.bias_force = 0.1;  // zeroed where the hand is
  options.filter.bias_torque = 0.01;
  start(body, options);
  run(world, 2, path(world, 40));
  const double without = world.shift_.translation().norm();
  const Vector3d found = filter_->filter().mean().segment<3>(0);
  EXPECT_LT((found - world.shift_.translation()).norm(), 0.5 * without);
  EXPECT_LT(estimate_.pose_deviation[0].head<3>().maxCoeff(), 0.7e-3);
}

TEST_F(PoseWrenchFilterTest, WithoutAWrenchThePoseAloneDrives) {
  const elasticity::Body body = bar();
  World world(body);
  start(body);
  CorotationalQuasistatic other(body);
  other.prepare();
  PoseDriven alone{PoseDriven::Options{}};
  alone.activate(other);
  Estimate estimate;
  const auto move = path(world, 0.3);
  for (int i = 0; i < 400; ++i) {
    move(1e-3 * std::min(i, 300));
    world.tick(inputs_);
    inputs_.grasps[0].wrench_valid = i % 2 == 0;
    inputs_.grasps[0].F_G_O.force.x() = i % 2 == 0 ? std::nan("") : 0;
    refactor(*model_);
    filter_->update(inputs_, *model_, estimate_);
    refactor(other);
    alone.update(inputs_, other, estimate);
  }
  EXPECT_EQ((model_->positions() - other.positions()).cwiseAbs().maxCoeff(), 0);
  EXPECT_LT(estimate_.innovation_test, 0);
  // What is not known of the pose shows in the shape: most at the hand, none at the clamp.
  ASSERT_NE(estimate_.node_deviation, nullptr);
  const std::vector<float>& deviation = *estimate_.node_deviation;
  EXPECT_NEAR(deviation[static_cast<std::size_t>(body.grasps[0].nodes[0])], 1e-3, 0.3e-3);
  EXPECT_NEAR(deviation[static_cast<std::size_t>(body.fixed_nodes[0])], 0.5e-3, 1e-9)
      << "the model's own error, as everywhere";
}

TEST_F(PoseWrenchFilterTest, AllocatesNothing) {
  const elasticity::Body body = bar();
  World world(body);
  start(body);
  run(world, 0.3, path(world, 0.3));
  run(world, 1.5);
  const mesh::PointWeights place = mesh::PointLocator(body.mesh).locate({0.2, 0.03, 0.06});
  for (int i = 0; i < place.count; ++i)
    world.model().loads().col(place.nodes[i]) += place.weights[i] * Vector3d(0, 0, -1);
  for (int i = 0; i < 300; ++i) {
    world.tick(inputs_);
    refactor(*model_);
    const loop::NoAllocationScope scope;
    filter_->update(inputs_, *model_, estimate_);
    ASSERT_EQ(scope.count(), 0) << i;
  }
  EXPECT_TRUE(estimate_.unknown_contact.found);
}

}  // namespace
}  // namespace palpate::estimation

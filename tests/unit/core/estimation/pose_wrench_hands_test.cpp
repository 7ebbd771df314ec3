// The filter when it takes over from another estimator, and between two hands of which only one has
// a force sensor.
#include <gtest/gtest.h>

#include <random>

#include "core/elasticity/corotational_model.hpp"
#include "core/estimation/pose_driven.hpp"
#include "core/estimation/pose_wrench_filter.hpp"
#include "tests/support/refactor.hpp"
#include "tests/unit/core/estimation/rigid_model.hpp"

namespace palpate::estimation {
namespace {

using Eigen::Vector3d;
using elasticity::CorotationalQuasistatic;
using math::Vector6d;

/// A true object in one or two hands, and their measurements.
class PoseWrenchHandsWorld {
 public:
  explicit PoseWrenchHandsWorld(const elasticity::Body& body) : model_(body) {
    model_.prepare();
    for (std::size_t g = 0; g < body.grasps.size(); ++g) hands_[g] = body.grasps[g].X_OG_rest;
  }
  void tick(EstimationInputs& inputs) {
    inputs.grasp_count = static_cast<int>(model_.body().grasps.size());
    for (int g = 0; g < inputs.grasp_count; ++g) model_.hold(g, hands_[g] * shift_);
    support::refactor(model_);
    model_.step(1e-3);
    for (int g = 0; g < inputs.grasp_count; ++g) {
      const Vector6d reaction = model_.reaction(g).vector();
      if (ticks_ == 0) lagged_[g] = reaction;
      lagged_[g] += (1 - std::exp(-0.1)) * (reaction - lagged_[g]);
      Vector6d wrench = lagged_[g];
      for (int i = 0; i < 6; ++i) wrench[i] += (i < 3 ? 0.02 : 0.002) * normal_(random_);
      wrench.head<3>() += hands_[g].linear() * bias_;
      inputs.grasps[g] = {Freshness::kNew, true, hands_[g], feels_[g], math::Wrench::from(wrench)};
    }
    ++ticks_;
  }
  CorotationalQuasistatic& model() { return model_; }

  std::array<math::Pose, 2> hands_{math::Pose::Identity(), math::Pose::Identity()};
  std::array<bool, 2> feels_{true, true};
  math::Pose shift_ = math::Pose::Identity();
  Vector3d bias_ = Vector3d::Zero();

 private:
  CorotationalQuasistatic model_;
  std::array<Vector6d, 2> lagged_{Vector6d::Zero(), Vector6d::Zero()};
  std::mt19937_64 random_{1};
  std::normal_distribution<double> normal_;
  int ticks_ = 0;
};

class PoseWrenchHands : public ::testing::Test {
 protected:
  PoseWrenchFilter make(const elasticity::Body& body) const {
    PoseWrenchFilter::Options options;
    options.contacts = true;
    return {body, mesh::extract_surface(body.mesh), options};
  }
  void tick(PoseWrenchHandsWorld& world, Estimator& estimator, CorotationalQuasistatic& model) {
    world.tick(inputs_);
    support::refactor(model);
    static_cast<void>(estimator.update(inputs_, model, estimate_));
  }
  EstimationInputs inputs_;
  Estimate estimate_;
};

TEST_F(PoseWrenchHands, AFilterThatFollowsAnotherGoesOnWhereItWas) {
  const elasticity::Body body = support::held_bar({8, 1, 1}, mesh::ElementOrder::kQuadratic);
  elasticity::Body truth = body;
  truth.material.young_modulus *= 1.5;
  PoseWrenchHandsWorld world(truth);
  world.bias_ = Vector3d(0.03, 0.02, -0.03);
  world.shift_.translation() = Vector3d(0.5e-3, -0.5e-3, 0.4e-3);
  CorotationalQuasistatic model(body), other(body);
  model.prepare();
  other.prepare();
  PoseWrenchFilter filter = make(body), next = make(body);
  filter.activate(model);
  for (int i = 0; i < 2500; ++i) {
    if (i < 2000) {
      world.hands_[0].translation() += Vector3d(-1e-5, 2e-5, 3e-5);
      world.hands_[0].linear() = math::exp_rotation({1e-4, 0, 1e-4}) * world.hands_[0].linear();
    }
    tick(world, filter, model);
  }
  const Estimate last = estimate_;
  ASSERT_GT(last.log_young_modulus_deviation, 0);
  ASSERT_NEAR(last.log_young_modulus, std::log(truth.material.young_modulus), 0.15);
  ASSERT_GT(last.pose_offset[0].norm(), 1e-5);

  const Eigen::Matrix3Xd before = model.positions();
  ASSERT_TRUE(other.restore(before, model.velocities()));
  next.take_over(last, other);
  EXPECT_LT((next.filter().mean() - filter.filter().mean()).head(13).norm(),
            1e-6 + 1e-9 * filter.filter().mean().norm());
  double jump = 0;
  for (int i = 0; i < 30; ++i) {
    tick(world, next, other);
    jump = std::max(jump, (other.positions() - before).colwise().norm().maxCoeff());
    EXPECT_NEAR(estimate_.log_young_modulus, last.log_young_modulus, 0.02);
  }
  EXPECT_LT(jump, 1e-4) << "an offset that was forgotten is some tenths of a millimetre";
  EXPECT_NEAR(estimate_.log_young_modulus_deviation, last.log_young_modulus_deviation,
              0.1 * last.log_young_modulus_deviation);
  EXPECT_LT((estimate_.bias[0] - last.bias[0]).norm(), 5e-3);
}

TEST_F(PoseWrenchHands, FromAnEstimatorThatKnowsNoStiffnessNoneIsTaken) {
  const elasticity::Body body = support::held_bar({8, 1, 1}, mesh::ElementOrder::kQuadratic);
  CorotationalQuasistatic model(body);
  model.prepare();
  Estimate last;
  last.X_OG[0] = body.grasps[0].X_OG_rest;
  last.log_young_modulus = std::log(2 * body.material.young_modulus);
  PoseWrenchFilter filter = make(body);
  filter.take_over(last, model);
  EXPECT_EQ(filter.filter().mean().norm(), 0);
  EXPECT_FALSE(filter.filter().is_observed(filter.filter().log_young()));
}

TEST_F(PoseWrenchHands, APushIsFollowedByWhicheverHandFeels) {
  const elasticity::Body body = support::bar_between_hands(mesh::ElementOrder::kQuadratic);
  const mesh::PointWeights place = mesh::PointLocator(body.mesh).locate({0.2, 0.03, 0.06});
  for (const std::array<bool, 2> feels :
       {std::array{true, false}, std::array{false, true}, std::array{true, true}}) {
    PoseWrenchHandsWorld world(body);
    world.feels_ = feels;
    CorotationalQuasistatic model(body);
    model.prepare();
    PoseWrenchFilter filter = make(body);
    filter.activate(model);
    for (int i = 0; i < 1500; ++i) tick(world, filter, model);
    ASSERT_FALSE(estimate_.unknown_contact.found);
    const Vector3d force(0, 0, -0.6);
    for (int i = 0; i < place.count; ++i)
      world.model().loads().col(place.nodes[i]) += place.weights[i] * force;
    int found = 0;
    for (int i = 0; i < 600; ++i) {
      tick(world, filter, model);
      found += estimate_.unknown_contact.found;
    }
    EXPECT_GT(found, 500) << feels[0] << feels[1] << ": and never lost";
    EXPECT_LT((estimate_.unknown_contact.force_O - force).norm(), 0.1) << feels[0] << feels[1];
    const Vector3d there = place.interpolate(world.model().positions());
    EXPECT_LT((estimate_.unknown_contact.location_O - there).norm(), 0.02) << feels[0] << feels[1];
  }
}

}  // namespace
}  // namespace palpate::estimation

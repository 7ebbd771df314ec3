// The filter with observed surface points, in worlds of the same model with other parameters.
#include <gtest/gtest.h>

#include <deque>
#include <functional>
#include <random>

#include "core/elasticity/corotational_model.hpp"
#include "core/estimation/pose_wrench_filter.hpp"
#include "rt/loop/allocation_counter.hpp"
#include "tests/support/refactor.hpp"
#include "tests/unit/core/estimation/rigid_model.hpp"

namespace palpate::estimation {
namespace {

using Eigen::Vector3d;
using elasticity::CorotationalQuasistatic;

constexpr int kLate = 60;    // ms, of the observations
constexpr int kPeriod = 33;  // ms, between two messages
constexpr double kNoise = 3e-4;

/// The true object, held by a hand that is slightly off its reported pose, and observed from above
/// and from one side: noisy surface nodes.
class SeenWorld {
 public:
  SeenWorld(const elasticity::Body& body, int seed) : model_(body), random_(seed) {
    model_.prepare();
    model_.set_gravity(body.gravity_O);
    hand_ = body.grasps[0].X_OG_rest;
    for (const int node : mesh::extract_surface(body.mesh).nodes) {
      const Vector3d p = body.mesh.nodes.col(node);
      if (p.z() > 0.0599 || p.y() < 1e-4) seen_nodes_.push_back(node);
    }
  }

  void tick(EstimationInputs& inputs) {
    const math::Pose X_OG = hand_ * shift_;
    model_.hold(0, X_OG);
    support::refactor(model_);
    model_.step(1e-3);
    GraspInput& grasp = inputs.grasps[0];
    grasp.pose_freshness = Freshness::kNew;
    grasp.holding = true;
    grasp.X_OG = hand_;
    lagged_ += (1 - std::exp(-0.1)) * (model_.reaction(0).vector() - lagged_);
    if (ticks_ == 0) lagged_ = model_.reaction(0).vector();
    math::Vector6d wrench = lagged_;
    for (int i = 0; i < 6; ++i) wrench[i] += (i < 3 ? 0.02 : 0.002) * normal_(random_);
    grasp.wrench_valid = true;
    grasp.F_G_O = math::Wrench::from(wrench);
    look(inputs.observation);
    ++ticks_;
  }

  CorotationalQuasistatic& model() { return model_; }
  math::Pose hand_ = math::Pose::Identity(), shift_ = math::Pose::Identity();
  bool sees_ = true;
  /// From now on only points at the middle of a face: next to an edge the noise decides which face
  /// a point is assigned to, so that its errors have a mean.
  void look_at_faces_only() {
    const Eigen::Matrix3Xd& rest = model_.body().mesh.nodes;
    const auto is_near_edge = [&](int node) {
      const Vector3d p = rest.col(node);
      return std::abs(p.y() - 0.03) > 0.02 && std::abs(p.z() - 0.03) > 0.02;
    };
    seen_nodes_.erase(std::remove_if(seen_nodes_.begin(), seen_nodes_.end(), is_near_edge),
                      seen_nodes_.end());
  }
  std::function<void(ObservationInput::Points&)> spoil_;

 private:
  void look(ObservationInput& out) {
    out.freshness = ticks_ < kLate ? Freshness::kNoData : Freshness::kOld;
    if (sees_ && ticks_ % kPeriod == 0) {
      ObservationInput::Points points(3, 128);
      std::uniform_int_distribution<std::size_t> any(0, seen_nodes_.size() - 1);
      for (Eigen::Index i = 0; i < points.cols(); ++i) {
        points.col(i) = model_.positions().col(seen_nodes_[any(random_)]);
        for (double& x : points.col(i)) x += kNoise * normal_(random_);
      }
      if (spoil_) spoil_(points);
      under_way_.emplace_back(ticks_ + kLate, points);
    }
    if (under_way_.empty() || under_way_.front().first > ticks_) return;
    out.freshness = Freshness::kNew;
    out.deviation = kNoise;
    out.points_O = under_way_.front().second;
    under_way_.pop_front();
  }

  CorotationalQuasistatic model_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::vector<int> seen_nodes_;
  std::deque<std::pair<int, ObservationInput::Points>> under_way_;
  math::Vector6d lagged_ = math::Vector6d::Zero();
  int ticks_ = 0;
};

elasticity::Body nominal() { return support::held_bar({8, 1, 1}, mesh::ElementOrder::kQuadratic); }

/// Another mesh, stiffness and Poisson's ratio.
elasticity::Body other() {
  elasticity::Body body = support::held_bar({10, 2, 2}, mesh::ElementOrder::kQuadratic);
  body.material.young_modulus *= 1.3;
  body.material.poisson_ratio = 0.45;
  return body;
}

class PoseWrenchObservationTest : public ::testing::Test {
 protected:
  void start(const elasticity::Body& body, PoseWrenchFilter::Options options = {}) {
    options.observation.lag = 1e-3 * kLate;
    model_ = std::make_unique<CorotationalQuasistatic>(body);
    model_->prepare();
    filter_ = std::make_unique<PoseWrenchFilter>(body, mesh::extract_surface(body.mesh), options);
    filter_->activate(*model_);
    inputs_ = EstimationInputs();
    inputs_.grasp_count = 1;
    locator_ = std::make_unique<mesh::PointLocator>(model_->body().mesh);
  }
  /// Bends the bar within a second and then waits.
  void run(SeenWorld& world, double seconds, bool bends = false,
           const std::function<void()>& each = {}) {
    const math::Pose from = world.hand_;
    for (int i = 0; i < std::lround(1000 * seconds); ++i) {
      if (bends) {
        const double share = 0.5 - 0.5 * std::cos(M_PI * std::min(1.0, 1e-3 * i));
        world.hand_.translation() = from.translation() + share * Vector3d(-0.01, 0.03, 0.05);
        world.hand_.linear() = math::exp_rotation(share * Vector3d(0.2, -0.3, 0.2)) * from.linear();
      }
      world.tick(inputs_);
      support::refactor(*model_);
      static_cast<void>(filter_->update(inputs_, *model_, estimate_));
      if (each) each();
    }
  }
  double covered(bool faces_only);
  /// m, over points distributed over the bar, whose meshes may differ.
  double worst_error(SeenWorld& world) const {
    const mesh::PointLocator theirs(world.model().body().mesh);
    double worst = 0;
    for (double x = 0.05; x < 0.46; x += 0.05) {
      for (const Vector3d& p : {Vector3d(x, 0.03, 0.06), Vector3d(x, 0.03, 0.0)}) {
        worst = std::max(worst, (locator_->locate(p).interpolate(model_->positions()) -
                                 theirs.locate(p).interpolate(world.model().positions()))
                                    .norm());
      }
    }
    return worst;
  }

  std::unique_ptr<CorotationalQuasistatic> model_;
  std::unique_ptr<PoseWrenchFilter> filter_;
  std::unique_ptr<mesh::PointLocator> locator_;
  EstimationInputs inputs_;
  Estimate estimate_;
};

TEST_F(PoseWrenchObservationTest, SeesHowTheGraspIsShifted) {
  SeenWorld world(nominal(), 1);
  world.shift_ = math::make_pose(math::exp_rotation({0.01, -0.012, 0.008}), {1e-3, -1.2e-3, 8e-4});
  PoseWrenchFilter::Options options;
  options.filter.bias_force = 0.1;  // tared at the hand's pose
  options.filter.bias_torque = 0.01;
  start(nominal(), options);
  run(world, 4, true);
  const double found = worst_error(world);
  EXPECT_LT(found, 3e-4);
  const math::Vector6d error =
      filter_->filter().mean().head<6>() -
      (math::Vector6d() << world.shift_.translation(), 0.01, -0.012, 0.008).finished();
  for (int i = 0; i < 6; ++i)
    EXPECT_LT(std::abs(error[i]), 3 * estimate_.pose_deviation[0][i]) << i;
  EXPECT_LT(estimate_.pose_deviation[0].head<3>().maxCoeff(), 0.7e-3);
  std::printf("shifted grasp: worst of the shape %.2f mm\n", 1e3 * found);
}

TEST_F(PoseWrenchObservationTest, MeetsAShapeThatItsModelWouldNotHave) {
  double blind = 0;
  for (const bool sees : {false, true}) {
    SeenWorld world(other(), 1);
    world.sees_ = sees;
    const mesh::PointWeights place =
        mesh::PointLocator(world.model().body().mesh).locate({0.25, 0.03, 0.03});
    for (int i = 0; i < place.count; ++i)  // an effect unknown to the model
      world.model().loads().col(place.nodes[i]) += place.weights[i] * Vector3d(0.1, 0.2, -0.4);
    start(nominal());
    run(world, 3, true);
    const double worst = worst_error(world);
    std::printf("unlike model, %s: worst of the shape %.2f mm\n", sees ? "seen" : "blind",
                1e3 * worst);
    if (!sees) blind = worst;
    if (!sees) continue;
    EXPECT_LT(worst, 0.2 * blind);
    EXPECT_LT(worst, 1e-3);
  }
}

TEST_F(PoseWrenchObservationTest, WhatIsNotTheObjectDoesNotMoveIt) {
  SeenWorld world(nominal(), 1);
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> along(0, 0.6), across(-0.05, 0.1), above(0.01, 0.1);
  world.spoil_ = [&](ObservationInput::Points& points) {
    for (Eigen::Index i = 0; i < points.cols(); i += 3) {
      // A table beneath, and a hand above the bar's end.
      points.col(i) = i % 2 == 0 ? Vector3d(along(random), across(random), -0.06)
                                 : Vector3d(0.42, across(random), 0.06 + above(random));
    }
  };
  start(nominal());
  run(world, 3, true);
  const double worst = worst_error(world);
  std::printf("a third of the points of something else: %.2f mm\n", 1e3 * worst);
  EXPECT_LT(worst, 5e-4);

  world.spoil_ = [&](ObservationInput::Points& points) {  // nothing of the object any more
    for (Eigen::Index i = 0; i < points.cols(); ++i)
      points.col(i) = Vector3d(along(random), across(random), -0.06);
  };
  run(world, 1);
  EXPECT_LT(worst_error(world), 7e-4);
}

TEST_F(PoseWrenchObservationTest, NothingJumpsWhenObservationsStopAndResume) {
  SeenWorld world(other(), 1);
  // A grasp that slips at rest may be attributed to an external contact, whose end moves the shape
  // at once.
  PoseWrenchFilter::Options options;
  options.contacts = false;
  start(nominal(), options);
  run(world, 2, true);
  Eigen::Matrix3Xd before = model_->positions();
  double step = 0;
  const auto watch = [&] {
    step = std::max(step, (model_->positions() - before).colwise().norm().maxCoeff());
    before = model_->positions();
  };
  const double seen = worst_error(world);
  const std::vector<float> sure = *estimate_.node_deviation;
  world.sees_ = false;
  run(world, 5, false, watch);
  EXPECT_LT(step, 2e-5) << "m in a tick, blind";
  EXPECT_LT(worst_error(world), seen + 3e-4) << "what was learnt holds";
  const std::vector<float>& unsure = *estimate_.node_deviation;
  int grown = 0;
  for (std::size_t i = 0; i < sure.size(); ++i) grown += unsure[i] > sure[i] ? 1 : 0;
  EXPECT_GT(grown, static_cast<int>(0.7 * static_cast<double>(sure.size())));

  // Meanwhile the grasp has slipped a little.
  world.shift_.translation() = Vector3d(0, 2e-3, -2e-3);
  run(world, 0.5);
  const double slipped = worst_error(world);
  before = model_->positions();
  step = 0;
  world.sees_ = true;
  run(world, 1.5, false, watch);
  EXPECT_LT(step, 1e-4) << "m in a tick, observed again";
  EXPECT_GT(step, 1e-6) << "or nothing was corrected";
  EXPECT_LT(worst_error(world), 0.5 * slipped);
}

TEST_F(PoseWrenchObservationTest, AllocatesNothing) {
  SeenWorld world(nominal(), 1);
  start(nominal());
  for (int i = 0; i < 400; ++i) {
    world.tick(inputs_);
    support::refactor(*model_);
    const loop::NoAllocationScope scope;
    static_cast<void>(filter_->update(inputs_, *model_, estimate_));
    ASSERT_EQ(scope.count(), 0) << i;
  }
  EXPECT_TRUE(filter_->filter().has_loads());
}

/// Fraction of coordinates within the 95 % intervals, in worlds generated by the filter's own
/// assumptions.
double PoseWrenchObservationTest::covered(bool faces_only) {
  constexpr int kSeeds = 20;
  PoseWrenchFilter::Options options;
  options.observation.surface = 0;  // its own mesh
  options.relative = 0;
  const elasticity::Body body = support::held_bar({5, 1, 1}, mesh::ElementOrder::kQuadratic);
  double covered = 0, asked = 0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    std::mt19937_64 random(100 + seed);
    std::normal_distribution<double> normal;
    elasticity::Body truth = body;
    truth.material.young_modulus *= std::exp(0.2 * normal(random));
    SeenWorld world(truth, seed);
    const auto draw = [&](double deviation) -> Vector3d {
      return Vector3d(normal(random), normal(random), normal(random)) * deviation;
    };
    const Vector3d shifted = draw(options.filter.position);
    world.shift_ = math::make_pose(math::exp_rotation(draw(options.filter.rotation)), shifted);
    if (faces_only) world.look_at_faces_only();
    start(body, options);
    run(world, 1.5, true);
    const std::vector<float>& deviation = *estimate_.node_deviation;
    for (int node = 0; node < body.mesh.node_count(); ++node) {
      const double s = deviation[static_cast<std::size_t>(node)];
      if (!(s > 0)) continue;
      const Vector3d off = model_->positions().col(node) - world.model().positions().col(node);
      covered += (off.cwiseAbs().array() < 1.96 * s).count();
      asked += 3;
    }
  }
  return covered / asked;
}

TEST_F(PoseWrenchObservationTest, IntervalsOfTheShapeCoverIt) {
  const double on_faces = covered(true), everywhere = covered(false);
  std::printf("95 %% intervals cover %.1f %%, seen on faces only %.1f %%\n", 100 * everywhere,
              100 * on_faces);
  for (const double share : {on_faces, everywhere}) {
    EXPECT_GT(share, 0.90);
    EXPECT_LT(share, 0.99);
  }
}

}  // namespace
}  // namespace palpate::estimation

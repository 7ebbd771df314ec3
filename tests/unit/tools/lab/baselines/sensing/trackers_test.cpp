// Methods that track a cloud, on a bar that bends in both planes: without information about the
// hand they must approach the observed shape, without an allocation.
#include <gtest/gtest.h>

#include "core/elasticity/comparison/mass_spring_model.hpp"
#include "tests/unit/tools/lab/baselines/seen_bar.hpp"
#include "tools/lab/baselines/sensing/cloud_driven_fem.hpp"
#include "tools/lab/baselines/sensing/deformation_graph_fit.hpp"
#include "tools/lab/baselines/sensing/euler_bernoulli_fit.hpp"
#include "tools/lab/baselines/sensing/evolved_mass_spring.hpp"
#include "tools/lab/baselines/sensing/mass_spring_em.hpp"
#include "tools/lab/baselines/sensing/probed_cloud_fem.hpp"
#include "tools/lab/baselines/sensing/shape_matching_fit.hpp"
#include "tools/lab/baselines/sensing/spline_fit.hpp"
#include "tools/lab/baselines/sensing/voxel_mass_spring.hpp"

namespace palpate::baselines {
namespace {

using Eigen::Vector3d;

const Vector3d kWay(-0.01, 0.06, -0.08), kTurn(0, 0.15, 0.2);

elasticity::Body truth() {
  elasticity::Body body = support::held_bar({10, 2, 2}, mesh::ElementOrder::kQuadratic);
  body.material.young_modulus = 33e3;
  return body;
}

elasticity::Body known() { return support::held_bar({8, 1, 1}, mesh::ElementOrder::kQuadratic); }

class TrackersTest : public ::testing::Test {
 protected:
  const elasticity::Body body_ = known();
  const mesh::Surface surface_ = mesh::extract_surface(body_.mesh);

  /// Mean and largest error in m after the motion.
  std::pair<double, double> follow(estimation::Estimator& method,
                                   std::unique_ptr<elasticity::DeformationModel> model,
                                   double noise = 3e-4) {
    support::Watcher watcher(truth(), noise, std::move(model), method);
    EXPECT_EQ(watcher.run(3, 1.5, kWay, kTurn), 0);
    EXPECT_EQ(watcher.last.status, Status::kOk) << watcher.last.reason;
    const auto error = watcher.error();
    std::printf("mean %.2f mm, largest %.2f mm\n", error.first * 1e3, error.second * 1e3);
    // Without observations it reports so, and its state stays finite.
    watcher.world.sees = false;
    watcher.run(0.8, 1e-3, kWay, kTurn);
    EXPECT_EQ(watcher.last.status, Status::kDegraded);
    EXPECT_TRUE(watcher.model->positions().allFinite());
    return error;
  }
};

TEST_F(TrackersTest, CloudDrivenFiniteElements) {
  CloudDrivenFem method(body_, surface_, {});
  const auto [mean, largest] =
      follow(method, std::make_unique<elasticity::CorotationalDynamic>(body_));
  EXPECT_LT(mean, 4e-3);
  EXPECT_LT(largest, 15e-3);
}

TEST_F(TrackersTest, VoxelsOfMassesAndSprings) {
  VoxelMassSpring method(body_, surface_, {});
  EXPECT_EQ(method.lattice_size(), 18 * 3 * 3);
  const auto [mean, largest] = follow(method, support::carrier(body_));
  EXPECT_LT(mean, 5e-3);
  EXPECT_LT(largest, 20e-3);
}

TEST_F(TrackersTest, MassesAndSpringsWithCorrespondence) {
  MassSpringEm method(body_, surface_, {});
  const auto [mean, largest] = follow(method, std::make_unique<elasticity::MassSpringModel>(body_));
  EXPECT_LT(mean, 8e-3);
  EXPECT_LT(largest, 25e-3);
}

TEST_F(TrackersTest, ShapeMatchingWithAFit) {
  ShapeMatchingFit method(body_, surface_, {});
  const auto [mean, largest] = follow(method, support::carrier(body_));
  EXPECT_LT(mean, 6e-3);
  EXPECT_LT(largest, 20e-3);
}

// Arriola-Rios and Wyatt 2017: evolved parameters predict better than the initial ones of the
// search.
TEST_F(TrackersTest, MassesAndSpringsThatEvolve) {
  EvolvedMassSpring::Options options;
  EvolvedMassSpring method(body_, surface_, options);
  const auto [mean, largest] = follow(method, support::carrier(body_));
  EXPECT_GE(method.generations(), 5);
  options.generation = 1e3;  // never
  EvolvedMassSpring still(body_, surface_, options);
  const auto before = follow(still, support::carrier(body_));
  EXPECT_LT(mean, before.first + 1e-4);
  EXPECT_LT(largest, 30e-3);
}

TEST_F(TrackersTest, ABeamOfEulerAndBernoulli) {
  EulerBernoulliFit method(body_, surface_, {});
  const auto [mean, largest] = follow(method, support::carrier(body_));
  EXPECT_LT(mean, 3e-3);
  EXPECT_LT(largest, 10e-3);
}

TEST_F(TrackersTest, ASpline) {
  SplineFit method(body_, surface_, {});
  const auto [mean, largest] = follow(method, support::carrier(body_));
  EXPECT_LT(mean, 3e-3);
  EXPECT_LT(largest, 10e-3);
}

TEST_F(TrackersTest, ADeformationGraph) {
  DeformationGraphFit method(body_, surface_, {});
  const auto [mean, largest] = follow(method, support::carrier(body_));
  EXPECT_LT(mean, 6e-3);
  EXPECT_LT(largest, 20e-3);
}

// Under a rigid rotation of the graph the mesh rotates with it; a shift of one node moves its
// neighbourhood.
TEST_F(TrackersTest, AGraphCarriesTheMesh) {
  DeformationGraph graph(body_, 12);
  const Vector3d turn(0.3, -0.2, 0.5), shift(0.01, 0.02, -0.03);
  const Eigen::Matrix3d R = math::exp_rotation(turn);
  for (int node = 0; node < graph.size(); ++node)
    graph.move(node, turn, R * graph.place(node) + shift - graph.place(node));
  Eigen::Matrix3Xd shape = 0 * body_.mesh.nodes;
  graph.draw(shape);
  const Eigen::Matrix3Xd expected = (R * body_.mesh.nodes).colwise() + shift;
  EXPECT_LT((shape - expected).cwiseAbs().maxCoeff(), 1e-12);
  graph.reset();
  graph.move(0, Vector3d::Zero(), shift);
  graph.draw(shape);
  const Eigen::Matrix3Xd moved = shape - body_.mesh.nodes;
  EXPECT_GT(moved.colwise().norm().maxCoeff(), 0.7 * shift.norm());
  EXPECT_LE(moved.colwise().norm().maxCoeff(), shift.norm());
  EXPECT_LT(moved.colwise().norm().minCoeff(), 1e-6);
  EXPECT_THROW(DeformationGraph(body_, 3), std::invalid_argument);
}

// Petit et al. 2017: a measured force identifies the stiffness, with which finite elements track
// the cloud.
TEST_F(TrackersTest, FiniteElementsWithAProbedStiffness) {
  elasticity::Body soft = body_;
  soft.material.young_modulus = 20e3;  // the truth's is 33 kPa
  ProbedCloudFem::Options options;
  options.probing = 2.5;
  ProbedCloudFem method(soft, surface_, options);
  const auto [mean, largest] =
      follow(method, std::make_unique<elasticity::CorotationalDynamic>(soft));
  EXPECT_NEAR(method.found(), 33.0 / 20, 0.15 * 33.0 / 20);
  EXPECT_LT(mean, 2e-3);
  EXPECT_LT(largest, 8e-3);
  options.hand = false;
  EXPECT_THROW(ProbedCloudFem(soft, surface_, options), std::invalid_argument);
}

// A hand with a known pose fixes its nodes, regardless of the cloud near them.
TEST_F(TrackersTest, WithTheHandsPoseItsNodesAreWhereItIs) {
  CloudDrivenFem::Options options;
  options.hand = true;
  CloudDrivenFem method(body_, surface_, options);
  support::Watcher watcher(truth(), 3e-4, std::make_unique<elasticity::CorotationalDynamic>(body_),
                           method);
  watcher.run(2, 1, kWay, kTurn);
  for (const int node : body_.grasps[0].nodes) {
    const Vector3d expected = watcher.world.hand * body_.grasps[0].X_OG_rest.inverse() *
                              Vector3d(body_.mesh.nodes.col(node));
    EXPECT_LT((watcher.model->positions().col(node) - expected).norm(), 1e-6);
  }
  EXPECT_LT(watcher.error().first, 2e-3);
}

TEST_F(TrackersTest, WhatIsNoBarIsRefusedByModelsOfBeams) {
  elasticity::Body block = body_;
  block.mesh.nodes.row(1) *= 5;
  EXPECT_THROW(EulerBernoulliFit(block, surface_, {}), std::invalid_argument);
  elasticity::Body loose = body_;
  loose.fixed_nodes.clear();
  EXPECT_THROW(SplineFit(loose, surface_, {}), std::invalid_argument);
  SplineFit::Options options;
  options.controls = 30;
  EXPECT_THROW(SplineFit(body_, surface_, options), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::baselines

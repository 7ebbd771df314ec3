#include "core/estimation/grasp_compliance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/elasticity/corotational_model.hpp"
#include "core/elasticity/pad_compliance.hpp"
#include "core/elasticity/static_solver.hpp"
#include "core/estimation/pose_driven.hpp"
#include "core/mesh/point_locator.hpp"
#include "tests/unit/core/estimation/rigid_model.hpp"

namespace palpate::estimation {
namespace {

using Eigen::Vector3d;

/// A bar whose last 50 mm are in the hand: all of their nodes, or those on the surface alone.
elasticity::Body gripped_bar(const std::array<int, 3>& cells, bool whole) {
  elasticity::Body body = support::held_bar(cells, mesh::ElementOrder::kQuadratic);
  body.gravity_O.setZero();
  elasticity::GraspRegion& grasp = body.grasps[0];
  grasp.nodes = mesh::nodes_in_box(body.mesh, {0.45, 0, 0}, {0.5, 0.06, 0.06});
  grasp.X_OG_rest.translation() << 0.47, 0.03, 0.03;
  if (!whole) {
    const std::vector<int> surface = mesh::extract_surface(body.mesh).nodes;
    std::vector<int> both;
    std::set_intersection(grasp.nodes.begin(), grasp.nodes.end(), surface.begin(), surface.end(),
                          std::back_inserter(both));
    grasp.nodes = both;
  }
  return body;
}

math::Matrix6d pads_of(const elasticity::Body& body, double stiffness) {
  return elasticity::pad_compliance(body, body.grasps[0], mesh::extract_surface(body.mesh),
                                    stiffness);
}

/// Mean distance, m, between the coarse bar's nodes under the hand's pose and those of a fine bar
/// whose surface alone is held.
double mean_error(const elasticity::Body& coarse, const math::Pose& X_OG) {
  const elasticity::Body fine = gripped_bar({20, 4, 4}, false);
  const elasticity::StaticSolution truth = elasticity::solve_static(
      fine, Eigen::Matrix3Xd::Zero(3, fine.mesh.node_count()), {X_OG, std::nullopt});
  EXPECT_TRUE(truth.converged);
  const mesh::PointLocator places(fine.mesh);

  elasticity::CorotationalQuasistatic model(coarse);
  model.prepare();
  PoseDriven estimator{PoseDriven::Options{}};
  estimator.activate(model);
  EstimationInputs inputs;
  inputs.grasp_count = 1;
  inputs.grasps[0].pose_freshness = Freshness::kNew;
  inputs.grasps[0].holding = true;
  inputs.grasps[0].X_OG = X_OG;
  Estimate estimate;
  for (int i = 0; i < 600; ++i) {
    if (elasticity::Refactorisation* job = model.wanted_refactorisation()) {
      job->run();
      model.install(*job);
    }
    static_cast<void>(estimator.update(inputs, model, estimate));
  }
  double sum = 0;
  for (int node = 0; node < coarse.mesh.node_count(); ++node)
    sum += (places.locate(coarse.mesh.nodes.col(node)).interpolate(truth.positions) -
            model.positions().col(node))
               .norm();
  return sum / coarse.mesh.node_count();
}

/// A coarse mesh with a compliant grasp is closer to the truth than without, and than a mesh with
/// edges half as long whose patch is rigid.
TEST(GraspComplianceTest, ACoarseMeshIsWhereAFineOneHasIt) {
  constexpr double kFirm = 1e7;  // N/m
  elasticity::Body body = gripped_bar({10, 1, 1}, true), half = gripped_bar({20, 2, 2}, true);
  elasticity::GraspRegion& grasp = body.grasps[0];
  grasp.compliance = pads_of(body, kFirm);
  half.grasps[0].compliance = pads_of(half, kFirm);
  math::Pose bent = grasp.X_OG_rest, twisted = grasp.X_OG_rest;
  bent.translation() += Vector3d(0, 0.02, 0.06);
  twisted.linear() = math::exp_rotation({0.7, 0, 0});
  for (const math::Pose& X_OG : {bent, twisted}) {
    grasp.object_compliance.setZero();
    const double without = mean_error(body, X_OG), of_half = mean_error(half, X_OG);
    grasp.object_compliance = grasp_compliance(body, 0, grasp.compliance) - grasp.compliance;
    const double with = mean_error(body, X_OG);
    std::printf("mean error %.3f mm, without %.3f mm, edges half as long %.3f mm\n", 1e3 * with,
                1e3 * without, 1e3 * of_half);
    EXPECT_LT(with, without);
    EXPECT_LT(with, of_half);
  }
}

TEST(GraspComplianceTest, DoesNotDependOnHowStiffTheObjectIsUnderFirmPads) {
  elasticity::Body body = gripped_bar({10, 1, 1}, true);
  const math::Matrix6d pads = pads_of(body, 1e9);
  const math::Matrix6d soft = grasp_compliance(body, 0, pads);
  body.material.young_modulus *= 3;
  const math::Matrix6d stiff = grasp_compliance(body, 0, pads);
  EXPECT_LT((soft - 3 * stiff).norm(), 1e-3 * soft.norm());
  EXPECT_GT(soft(4, 4), 0.05);  // rad/(N m): it bends into the hand
}

TEST(GraspComplianceTest, IsThatOfThePadsWithoutInformation) {
  const elasticity::Body body = gripped_bar({10, 1, 1}, true);
  const math::Matrix6d pads = pads_of(body, 1e5);
  EXPECT_TRUE(grasp_compliance(body, 0, math::Matrix6d::Zero()).isZero(0));
  elasticity::Body carried = body;
  carried.fixed_nodes.clear();
  EXPECT_EQ(grasp_compliance(carried, 0, pads), pads);
  elasticity::Body linear = support::held_bar({10, 1, 1}, mesh::ElementOrder::kLinear);
  EXPECT_EQ(grasp_compliance(linear, 0, pads), pads);
}

}  // namespace
}  // namespace palpate::estimation

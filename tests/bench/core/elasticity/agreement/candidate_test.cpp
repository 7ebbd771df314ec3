#include <gtest/gtest.h>

#include "tests/bench/core/elasticity/candidate_statics.hpp"
#include "tests/bench/core/elasticity/curved_pass.hpp"
#include "tests/bench/core/elasticity/round_bodies.hpp"
#include "tests/unit/core/elasticity/bodies.hpp"

namespace palpate::bench {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using mesh::ElementOrder;

elasticity::Body bar(ElementOrder order) {
  return elasticity::make_bar({0.2, 0.05, 0.05}, {4, 2, 2}, order);
}

class Candidate : public testing::TestWithParam<ElementOrder> {};
INSTANTIATE_TEST_SUITE_P(Order, Candidate,
                         testing::Values(ElementOrder::kLinear, ElementOrder::kQuadratic));

// With straight sides and separate pressures they are the elements of the product.
TEST_P(Candidate, IsTheElementOfTheProductWhereNothingIsChanged) {
  const elasticity::Body body = bar(GetParam());
  const Matrix3Xd loads = elasticity::face_load(body.mesh, 0.2, {0, 0.1, -0.4});
  const elasticity::StaticSolution product = elasticity::solve_static(body, loads);
  const CandidateSolution candidate = solve_candidate(body, Volumetric::kAtPoints, loads);
  ASSERT_TRUE(product.converged && candidate.converged);
  EXPECT_LT((product.positions - candidate.positions).colwise().norm().maxCoeff(), 1e-9);
}

/// Forces against differences of the energy, the tangent against differences of forces.
void expect_derivatives(const elasticity::Body& body, Volumetric volumetric) {
  CandidateElements elements(body, volumetric);
  const int n = body.mesh.node_count();
  std::srand(4);
  const Matrix3Xd x = body.mesh.nodes + 2e-3 * Matrix3Xd::Random(3, n);
  Matrix3Xd direction = Matrix3Xd::Random(3, n), f, after, before;
  const double step = 1e-7;
  const double difference = elements.evaluate(x + step * direction, after) -
                            elements.evaluate(x - step * direction, before);
  elements.evaluate(x, f);
  const double slope = f.cwiseProduct(direction).sum();
  EXPECT_NEAR(difference / (2 * step), slope, 1e-6 * std::abs(slope));

  const factor::BlockPattern pattern(elements.stencils(), n, {});
  factor::BlockMatrix matrix(pattern);
  elements.add_tangent(true, matrix);
  Matrix3Xd change(3, n);
  matrix.multiply(direction, change);
  EXPECT_LT(((after - before) / (2 * step) - change).norm(), 1e-5 * change.norm());
}

TEST_P(Candidate, HasForcesAndTangentOfItsEnergy) {
  expect_derivatives(bar(GetParam()), Volumetric::kAtPoints);
}

TEST(AveragedCandidate, HasForcesAndTangentOfItsEnergy) {
  elasticity::Body body = bar(ElementOrder::kLinear);
  body.material.poisson_ratio = 0.49;
  expect_derivatives(body, Volumetric::kAveraged);
  // Of two materials, which do not share pressure.
  body.element_materials.assign(body.mesh.element_count(), body.material);
  for (int e = 0; e < body.mesh.element_count() / 2; ++e) {
    body.element_materials[e].young_modulus *= 20;
  }
  expect_derivatives(body, Volumetric::kAveraged);
}

TEST(AveragedCandidate, IsThePlainElementWhereTheStrainIsTheSameEverywhere) {
  const elasticity::Body body = bar(ElementOrder::kLinear);
  Eigen::Matrix3d F;
  F << 1.2, 0.1, 0, -0.05, 0.9, 0.2, 0, 0.1, 1.1;
  Matrix3Xd plain_forces, forces;
  CandidateElements plain(body, Volumetric::kAtPoints), averaged(body, Volumetric::kAveraged);
  const double energy = plain.evaluate(F * body.mesh.nodes, plain_forces);
  EXPECT_NEAR(averaged.evaluate(F * body.mesh.nodes, forces), energy, 1e-12 * energy);
  EXPECT_LT((forces - plain_forces).norm(), 1e-12 * plain_forces.norm());
}

TEST(CurvedCandidate, HasForcesAndTangentOfItsEnergy) {
  expect_derivatives(make_ellipsoid(1, ElementOrder::kQuadratic, Sides::kCurved).body,
                     Volumetric::kAtPoints);
}

// The timed pass computes the same as the scored elements.
TEST(CurvedPass, GivesTheForcesOfTheCandidate) {
  const elasticity::Body body = make_ellipsoid(1, ElementOrder::kQuadratic, Sides::kCurved).body;
  const int n = body.mesh.node_count();
  std::srand(6);
  const Matrix3Xd x = body.mesh.nodes + 1e-3 * Matrix3Xd::Random(3, n);
  Matrix3Xd expected;
  const double energy = CandidateElements(body, Volumetric::kAtPoints).evaluate(x, expected);
  elasticity::NodalField padded = elasticity::NodalField::Zero(4, n), forces = padded;
  padded.topRows<3>() = x;
  EXPECT_NEAR(CurvedPass(body).add(padded, forces), energy, 1e-9 * energy);
  EXPECT_LT((forces.topRows<3>() - expected).norm(), 1e-9 * expected.norm());
}

TEST(RoundBodies, HaveTheVolumeThatTheirSidesAllow) {
  const auto volume = [](const RoundBody& round) {
    return CandidateElements(round.body, Volumetric::kAtPoints).volume();
  };
  const double cylinder = M_PI * 0.025 * 0.025 * 0.2;
  const double ellipsoid = 4 * M_PI / 3 * 0.05 * 0.03 * 0.03;
  const auto order = ElementOrder::kQuadratic;
  // A regular polygon of 12 corners: 6 sin(30 degrees) = 3 instead of pi.
  EXPECT_NEAR(volume(make_cylinder(2, 4, order, Sides::kStraight)), cylinder * 3 / M_PI,
              1e-9 * cylinder);
  EXPECT_NEAR(volume(make_cylinder(2, 4, order, Sides::kInflated)), cylinder, 1e-9 * cylinder);
  EXPECT_NEAR(volume(make_cylinder(2, 4, order, Sides::kCurved)), cylinder, 1e-3 * cylinder);
  EXPECT_LT(volume(make_ellipsoid(2, order, Sides::kStraight)), 0.9 * ellipsoid);
  EXPECT_NEAR(volume(make_ellipsoid(2, order, Sides::kInflated)), ellipsoid, 1e-9 * ellipsoid);
  EXPECT_NEAR(volume(make_ellipsoid(2, order, Sides::kCurved)), ellipsoid, 1e-2 * ellipsoid);
}

TEST(RoundBodies, BearTheWholeLoadOnNodesThatAreNotClamped) {
  for (const auto sides : {Sides::kStraight, Sides::kCurved}) {
    const RoundBody round = make_ellipsoid(2, ElementOrder::kQuadratic, sides);
    EXPECT_LT((round.loads.rowwise().sum() - Vector3d(-3, 0, 2)).norm(), 1e-9);
    for (const int node : round.body.fixed_nodes) EXPECT_EQ(round.loads.col(node).norm(), 0);
  }
}

}  // namespace
}  // namespace palpate::bench

#include "tools/export/shape_fields.hpp"

#include <gtest/gtest.h>

#include "core/elasticity/element_stress.hpp"
#include "core/elasticity/static_solver.hpp"
#include "tests/unit/tools/export/two_shapes.hpp"

namespace palpate::exporting {
namespace {

const Eigen::Vector3d kSize(0.2, 0.04, 0.06);
constexpr Stiffness kFoam{30e3, 0.3};

/// At the free end.
bool is_end(const log::MeshMessage& mesh, Eigen::Index node) {
  return mesh.nodes(0, node) > kSize.x() - 1e-9;
}

class ShapeFieldsTest : public testing::TestWithParam<bool> {
 protected:
  static log::MeshMessage box() {
    return GetParam() ? hexahedral_box(kSize, {3, 2, 1}) : tetrahedral_box(kSize, {3, 2, 2});
  }
  static Law law() { return GetParam() ? Law::kNeoHookean : Law::kCorotational; }
};

TEST_P(ShapeFieldsTest, ATurnedBodyIsNotStrained) {
  const ShapeEvaluator evaluator(box(), law());
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.2, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  const Eigen::Matrix3Xd x = (turn * evaluator.mesh().nodes).colwise() + Eigen::Vector3d(1, 2, 3);
  const ShapeFields fields = evaluator.at(x, kFoam);
  EXPECT_LT(fields.strain.cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT(fields.von_mises.maxCoeff(), 1e-7);
  EXPECT_LT(fields.force.cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_NEAR(fields.displacement(0, 0), 1 + (turn * evaluator.mesh().nodes.col(0)).x(), 1e-12);
}

TEST_P(ShapeFieldsTest, AStretchIsTheSameEverywhere) {
  const ShapeEvaluator evaluator(box(), law());
  Eigen::Matrix3Xd x = evaluator.mesh().nodes;
  x.row(0) *= 1.2;
  x.row(1) *= 0.9;
  const ShapeFields fields = evaluator.at(x, kFoam);
  for (int e = 0; e < fields.strain.cols(); ++e) {
    EXPECT_NEAR(fields.strain(0, e), 0.5 * (1.2 * 1.2 - 1), 1e-12);
    EXPECT_NEAR(fields.strain(1, e), 0.5 * (0.9 * 0.9 - 1), 1e-12);
    EXPECT_LT(fields.strain.col(e).tail<4>().cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_NEAR(fields.stress(0, e), fields.stress(0, 0), 1e-6);
  }
  // The pull at the end is stress times area; only the boundary is loaded.
  double pull = 0;
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    if (is_end(evaluator.mesh(), i)) pull += fields.force(0, i);
  EXPECT_NEAR(pull, fields.stress(0, 0) * 0.9 * kSize.y() * kSize.z(), 1e-9);
  EXPECT_LT(fields.force.rowwise().sum().norm(), 1e-9);
  const Eigen::VectorXd at_nodes = evaluator.at_nodes(fields.von_mises);
  EXPECT_NEAR(at_nodes.minCoeff(), fields.von_mises(0), 1e-6);
  EXPECT_NEAR(at_nodes.maxCoeff(), fields.von_mises(0), 1e-6);
}

INSTANTIATE_TEST_SUITE_P(TetrahedraAndHexahedra, ShapeFieldsTest, testing::Bool());

/// With linear and with quadratic elements.
class TetrahedralShapeFields : public testing::TestWithParam<mesh::ElementOrder> {};

TEST_P(TetrahedralShapeFields, StressAndForcesAreThoseOfTheModelThatPalpatedRuns) {
  const log::MeshMessage box = tetrahedral_box(kSize, {6, 2, 2}, GetParam());
  elasticity::Body body;
  body.mesh = mesh::make_element_mesh(mesh::make_box(kSize, {6, 2, 2}), GetParam());
  body.material.young_modulus = kFoam.young_modulus;
  body.material.poisson_ratio = kFoam.poisson_ratio;
  body.fixed_nodes = box.constrained;
  Eigen::Matrix3Xd loads = Eigen::Matrix3Xd::Zero(3, box.nodes.cols());
  for (Eigen::Index i = 0; i < loads.cols(); ++i)
    if (is_end(box, i)) loads.col(i) << 0.02, 0.01, -0.03;
  const elasticity::StaticSolution solution = elasticity::solve_static(body, loads);
  ASSERT_TRUE(solution.converged);
  const ShapeFields fields = ShapeEvaluator(box, Law::kCorotational).at(solution.positions, kFoam);
  const elasticity::ElementStress expected = elasticity::element_stress(body, solution.positions);
  EXPECT_GT(expected.von_mises.maxCoeff(), 100);
  EXPECT_LT((fields.stress - expected.cauchy).norm(), 1e-8 * expected.cauchy.norm());
  EXPECT_LT((fields.von_mises - expected.von_mises).norm(), 1e-8 * expected.von_mises.norm());
  EXPECT_LT((fields.force - loads - solution.reactions).cwiseAbs().maxCoeff(), 1e-8);
}

INSTANTIATE_TEST_SUITE_P(Orders, TetrahedralShapeFields,
                         testing::Values(mesh::ElementOrder::kLinear,
                                         mesh::ElementOrder::kQuadratic));

TEST(ShapeFields, FormerLogsOfQuadraticElementsAreReadByTheirCorners) {
  log::MeshMessage corners = tetrahedral_box(kSize, {4, 1, 1});
  const log::MeshMessage linear = corners;
  corners.element_kind = shape_mesh_t::QUADRATIC_TETRAHEDRA;
  Eigen::Matrix3Xd x = linear.nodes;
  for (Eigen::Index i = 0; i < x.cols(); ++i) x(2, i) += 3 * x(0, i) * x(0, i);
  const ShapeFields fields = ShapeEvaluator(corners, Law::kCorotational).at(x, kFoam);
  const ShapeFields expected = ShapeEvaluator(linear, Law::kCorotational).at(x, kFoam);
  EXPECT_EQ(fields.von_mises, expected.von_mises);
  EXPECT_EQ(fields.force, expected.force);
}

TEST(SurfaceEdges, AreThoseOfTheElementsFaces) {
  const Eigen::Index linear = surface_edges(tetrahedral_box(kSize, {2, 1, 1}), Edges::kAll).cols();
  log::MeshMessage box = tetrahedral_box(kSize, {2, 1, 1}, mesh::ElementOrder::kQuadratic);
  const mesh::Surface surface = mesh::extract_surface(
      mesh::make_element_mesh(mesh::make_box(kSize, {2, 1, 1}), mesh::ElementOrder::kQuadratic));
  std::vector<int> triangles;
  for (const std::vector<int>& face : surface.triangle_nodes)
    for (const int i : {0, 3, 5, 3, 1, 4, 5, 4, 2, 3, 4, 5})
      triangles.push_back(face[static_cast<std::size_t>(i)]);
  box.triangles =
      Eigen::Matrix3Xi::Map(triangles.data(), 3, static_cast<Eigen::Index>(triangles.size() / 3));
  EXPECT_EQ(surface_edges(box, Edges::kAll).cols(), 2 * linear) << "two halves each";
}

TEST(ShapeFields, NodesInAnyOrderMakeTheSameHexahedron) {
  log::MeshMessage box = hexahedral_box(kSize, {1, 1, 1});
  const ShapeEvaluator straight(box, Law::kNeoHookean);
  box.elements.col(0).reverseInPlace();
  box.elements.col(0).segment(3, 9).reverseInPlace();
  const ShapeEvaluator mixed(box, Law::kNeoHookean);
  Eigen::Matrix3Xd x = box.nodes;
  for (Eigen::Index i = 0; i < x.cols(); ++i) x(2, i) += 3 * x(0, i) * x(0, i) + x(1, i);
  const ShapeFields one = straight.at(x, kFoam), other = mixed.at(x, kFoam);
  EXPECT_GT(one.von_mises(0), 100);
  EXPECT_NEAR(one.von_mises(0), other.von_mises(0), 1e-6);
  EXPECT_LT((one.force - other.force).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(ShapeFields, AnElementInsideOutStaysANumber) {
  const log::MeshMessage box = tetrahedral_box(kSize, {1, 1, 1});
  Eigen::Matrix3Xd x = box.nodes;
  x.row(0) *= -1;
  for (const Law law : {Law::kCorotational, Law::kNeoHookean}) {
    const ShapeFields fields = ShapeEvaluator(box, law).at(x, kFoam);
    EXPECT_TRUE(fields.von_mises.allFinite());
    EXPECT_TRUE(fields.force.allFinite());
  }
}

TEST(ShapeFields, OtherElementsAreRefused) {
  log::MeshMessage box = tetrahedral_box(kSize, {1, 1, 1});
  box.elements.conservativeResize(3, box.elements.cols());
  EXPECT_THROW(ShapeEvaluator(box, Law::kCorotational), std::runtime_error);
  box = tetrahedral_box(kSize, {1, 1, 1});
  box.nodes.row(2).setZero();
  EXPECT_THROW(ShapeEvaluator(box, Law::kCorotational), std::runtime_error);
  box = hexahedral_box(kSize, {1, 1, 1});
  box.nodes.col(1) = box.nodes.col(0);
  EXPECT_THROW(ShapeEvaluator(box, Law::kNeoHookean), std::runtime_error);
}

}  // namespace
}  // namespace palpate::exporting

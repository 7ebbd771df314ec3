#include "tools/view/field.hpp"

#include <gtest/gtest.h>

#include "tests/unit/tools/view/shapes.hpp"

namespace palpate::view {
namespace {

std::vector<float> placed(const shape_mesh_t& mesh, const Eigen::Matrix3f& F) {
  return shape_of(mesh, [&](const Eigen::Vector3f& x) -> Eigen::Vector3f { return F * x; }).xyz;
}

Eigen::Matrix3f turn() {
  return Eigen::AngleAxisf(1.1F, Eigen::Vector3f(1, 2, -1).normalized()).toRotationMatrix();
}

TEST(Field, StrainIsTheLargestStretchHoweverTheObjectIsTurned) {
  FieldEvaluator evaluator(box_mesh({4, 2, 2}));
  std::vector<float> values;
  const Eigen::Matrix3f stretch = Eigen::Vector3f(1.05F, 0.98F, 1.0F).asDiagonal();
  evaluator.strain(placed(evaluator.mesh(), turn() * stretch), values);
  ASSERT_EQ(values.size(), static_cast<std::size_t>(evaluator.mesh().node_count));
  for (const float v : values) EXPECT_NEAR(v, 0.05, 1e-4);
  evaluator.strain(placed(evaluator.mesh(), turn()), values);
  for (const float v : values) EXPECT_NEAR(v, 0, 1e-4);
  evaluator.strain(placed(evaluator.mesh(), Eigen::Vector3f(1, 1, 0.9F).asDiagonal()), values);
  for (const float v : values) EXPECT_NEAR(v, 0.1, 1e-4) << "pressed counts as well";
}

TEST(Field, StressIsThatOfTheMaterial) {
  FieldEvaluator evaluator(box_mesh({4, 2, 2}));
  std::vector<float> values;
  // Stretched slightly along x, the sides contracting according to nu: sigma = E eps is the only
  // stress.
  constexpr float kStrain = 1e-3F, kRatio = 0.3F;
  const Eigen::Matrix3f F =
      Eigen::Vector3f(1 + kStrain, 1 - kRatio * kStrain, 1 - kRatio * kStrain).asDiagonal();
  evaluator.stress(placed(evaluator.mesh(), turn() * F), 30e3, kRatio, values);
  for (const float v : values) EXPECT_NEAR(v, 30, 0.3);
  evaluator.stress(placed(evaluator.mesh(), turn() * F), 60e3, kRatio, values);
  for (const float v : values) EXPECT_NEAR(v, 60, 0.6);
}

TEST(Field, DisplacementIsTheDistanceFromRest) {
  FieldEvaluator evaluator(box_mesh({2, 1, 1}));
  std::vector<float> values;
  const shape_t shape = shape_of(evaluator.mesh(), [](const Eigen::Vector3f& x) -> Eigen::Vector3f {
    return x + Eigen::Vector3f(0.03F, 0, -0.04F) * x.x();
  });
  evaluator.displacement(shape.xyz, values);
  for (std::size_t n = 0; n < values.size(); ++n)
    EXPECT_NEAR(values[n], 0.05F * evaluator.mesh().rest_xyz[3 * n], 1e-7);
}

TEST(Field, UsesTheMiddlesOfEdgesAsWell) {
  FieldEvaluator evaluator(box_mesh({2, 1, 1}, mesh::ElementOrder::kQuadratic));
  ASSERT_TRUE(evaluator.has_elements());
  const shape_mesh_t& mesh = evaluator.mesh();
  ASSERT_EQ(mesh.element_size, 10);
  std::vector<float> values;
  evaluator.strain(placed(mesh, turn() * Eigen::Matrix3f(Eigen::Vector3f(1, 1.2F, 1).asDiagonal())),
                   values);
  ASSERT_EQ(values.size(), static_cast<std::size_t>(mesh.node_count));
  for (const float v : values) EXPECT_NEAR(v, 0.2, 1e-4);
  // one node between two corners moves, they do not
  std::vector<float> xyz = mesh.rest_xyz;
  xyz[static_cast<std::size_t>(3 * mesh.elements[4])] += 0.01F;
  evaluator.strain(xyz, values);
  EXPECT_GT(values[static_cast<std::size_t>(mesh.elements[4])], 0.02);
  evaluator.stress(xyz, 30e3, 0.3, values);
  EXPECT_GT(values[static_cast<std::size_t>(mesh.elements[4])], 100);
}

/// One hexahedron of 27 nodes, like those of the simulator's plant.
TEST(Field, CutsHexahedraIntoTetrahedra) {
  auto mesh = std::make_shared<shape_mesh_t>();
  mesh->element_size = mesh->node_count = 27;
  for (int n = 0; n < 27; ++n) {
    mesh->elements.push_back(n);
    for (const int i : {n % 3, n / 3 % 3, n / 9})
      mesh->rest_xyz.push_back(0.5F * static_cast<float>(i));
  }
  FieldEvaluator evaluator(mesh);
  ASSERT_TRUE(evaluator.has_elements());
  std::vector<float> values;
  evaluator.strain(
      placed(*mesh, turn() * Eigen::Matrix3f(Eigen::Vector3f(1, 1.2F, 1).asDiagonal())), values);
  for (const float v : values) EXPECT_NEAR(v, 0.2, 1e-4);
}

TEST(Field, NamesAreThoseOfThePage) {
  Field field = Field::kDisplacement;
  EXPECT_TRUE(field_from("stress", field));
  EXPECT_EQ(field, Field::kStress);
  EXPECT_STREQ(name(field), "stress");
  EXPECT_FALSE(field_from("temperature", field));
}

}  // namespace
}  // namespace palpate::view

#include "core/elasticity/comparison/lumped_body.hpp"

#include <gtest/gtest.h>

#include <map>

#include "tests/unit/core/elasticity/bodies.hpp"

namespace palpate::elasticity {
namespace {

TEST(LumpedBody, PiecesFillTheMesh) {
  for (auto order : {mesh::ElementOrder::kLinear, mesh::ElementOrder::kQuadratic}) {
    const Body body = make_bar({0.2, 0.05, 0.03}, {4, 2, 1}, order, {1e5, 0.3, 100});
    const std::vector<LinearPiece> pieces = linear_pieces(body.mesh);
    const int per_element = order == mesh::ElementOrder::kLinear ? 1 : 8;
    ASSERT_EQ(pieces.size(), static_cast<std::size_t>(per_element * body.mesh.element_count()));
    std::map<int, double> volumes;
    for (const LinearPiece& piece : pieces) volumes[piece.element] += piece.volume;
    for (const auto& [element, volume] : volumes) {
      Eigen::Matrix<double, 3, 3> edges;
      const auto nodes = body.mesh.elements.col(element);
      for (int k = 0; k < 3; ++k) {
        edges.col(k) = body.mesh.nodes.col(nodes(k + 1)) - body.mesh.nodes.col(nodes(0));
      }
      EXPECT_NEAR(volume, edges.determinant() / 6, 1e-12 * volume);
    }
  }
}

// Every internal face between pieces of an element is shared by two: they do not overlap.
TEST(LumpedBody, PiecesOfAnElementFitTogether) {
  const Body body = make_bar({0.3, 0.05, 0.02}, {1, 1, 1}, mesh::ElementOrder::kQuadratic);
  std::map<std::pair<int, std::array<int, 3>>, int> faces;
  for (const LinearPiece& piece : linear_pieces(body.mesh)) {
    for (int out = 0; out < 4; ++out) {
      std::array<int, 3> face;
      for (int k = 0; k < 3; ++k) face[k] = piece.nodes[(out + k + 1) % 4];
      std::sort(face.begin(), face.end());
      ++faces[{piece.element, face}];
    }
  }
  std::map<int, int> outside;
  for (const auto& [face, count] : faces) {
    EXPECT_LE(count, 2);
    outside[face.first] += count == 1;
  }
  for (const auto& [element, count] : outside) EXPECT_EQ(count, 16) << element;
}

TEST(LumpedBody, MassAndItsCentreAreThoseOfTheBody) {
  for (auto order : {mesh::ElementOrder::kLinear, mesh::ElementOrder::kQuadratic}) {
    Body body = make_bar({0.2, 0.05, 0.03}, {2, 1, 1}, order);
    body.element_materials.assign(body.mesh.element_count(), {1e5, 0.3, 100});
    double mass = 0;
    Eigen::Vector3d moment = Eigen::Vector3d::Zero();
    for (int e = 0; e < body.mesh.element_count(); ++e) {
      body.element_materials[e].density = 100 + 10 * e;
      Eigen::Matrix<double, 3, 4> x;
      for (int k = 0; k < 4; ++k) x.col(k) = body.mesh.nodes.col(body.mesh.elements(k, e));
      const double m = (100 + 10 * e) * 0.2 * 0.05 * 0.03 / body.mesh.element_count();
      mass += m;
      moment += m * x.rowwise().mean();
    }
    const Eigen::VectorXd masses = lumped_masses(body, linear_pieces(body.mesh));
    EXPECT_NEAR(masses.sum(), mass, 1e-12 * mass);
    EXPECT_LT((body.mesh.nodes * masses - moment).norm(), 1e-12 * moment.norm());
  }
}

TEST(LumpedBody, NodesWithoutElementAreRefused) {
  Body body = make_bar({0.2, 0.05, 0.03}, {1, 1, 1}, mesh::ElementOrder::kLinear);
  body.mesh.nodes.conservativeResize(3, body.mesh.node_count() + 1);
  body.mesh.nodes.rightCols<1>().setConstant(1);
  EXPECT_THROW(lumped_masses(body, linear_pieces(body.mesh)), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::elasticity

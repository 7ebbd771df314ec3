#include "core/elasticity/element_tangents.hpp"

#include <gtest/gtest.h>

#include "tests/unit/core/factor/block_systems.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Matrix3Xd;

/// A heterogeneous bar with a number of elements that is not a multiple of four.
class TangentsOfEveryOrder : public testing::TestWithParam<mesh::ElementOrder> {
 protected:
  TangentsOfEveryOrder() {
    for (int e = 0; e < body_.mesh.element_count(); ++e) {
      body_.element_materials.push_back({1e4 * (1 + e % 7), 0.05 + 0.08 * (e % 5), 100.0 + e});
    }
  }

  /// Sum of the elements, one by one.
  factor::BlockMatrix sum(const ElementSet& elements, const factor::BlockPattern& pattern,
                          const Matrix3Xd& x, Tangent kind) const {
    factor::BlockMatrix K(pattern);
    Eigen::MatrixXd element;
    for (int e = 0; e < elements.element_count(); ++e) {
      elements.stiffness(e, x, kind, 0, element);
      K.add(e, element);
    }
    return K;
  }

  static void expect_near(const factor::BlockMatrix& a, const factor::BlockMatrix& b,
                          double share) {
    double largest = 0, off = 0;
    for (std::size_t k = 0; k < a.pattern().row().size(); ++k) {
      const int block = static_cast<int>(k);
      largest = std::max(largest, b.block(block).norm());
      off = std::max(off, (a.block(block) - b.block(block)).norm());
    }
    EXPECT_GT(largest, 0);
    EXPECT_LT(off, share * largest);
  }

  Body body_ = make_bar({0.2, 0.05, 0.04}, {3, 1, 1}, GetParam());
};
INSTANTIATE_TEST_SUITE_P(Order, TangentsOfEveryOrder,
                         testing::Values(mesh::ElementOrder::kLinear,
                                         mesh::ElementOrder::kQuadratic));

TEST_P(TangentsOfEveryOrder, AreTheSumsOfThoseOfSingleElements) {
  const ElementSet elements(body_);
  const factor::BlockPattern pattern(body_.mesh.elements, body_.mesh.node_count(),
                                     body_.fixed_nodes, patches(body_));
  const auto tangents = make_element_tangents(elements, pattern);
  factor::BlockMatrix K(pattern), warped(pattern);
  std::srand(21);
  const Eigen::Matrix3d R = rotation(1.2, {1, -2, 0.5});
  // The last one compresses and rotates elements until some are unstable or inverted.
  for (double size : {0.0, 5e-4, 3e-3, 2e-2}) {
    const Matrix3Xd x =
        R * (body_.mesh.nodes + size * Matrix3Xd::Random(3, body_.mesh.node_count()));
    for (Tangent kind : {Tangent::kExact, Tangent::kSemidefinite, Tangent::kWarped}) {
      tangents->assemble(x, kind, K, &warped);
      expect_near(K, sum(elements, pattern, x, kind), 1e-8);
      expect_near(warped, sum(elements, pattern, x, Tangent::kWarped), 1e-8);
      tangents->assemble(x, kind, K, nullptr);
      expect_near(K, sum(elements, pattern, x, kind), 1e-8);
    }
  }
}

TEST_P(TangentsOfEveryOrder, AddUpToTheMatrixOfAStep) {
  const ElementSet elements(body_);
  const factor::BlockPattern pattern(body_.mesh.elements, body_.mesh.node_count(),
                                     body_.fixed_nodes, patches(body_));
  std::srand(22);
  const Matrix3Xd x = body_.mesh.nodes + 2e-3 * Matrix3Xd::Random(3, body_.mesh.node_count());
  const double viscous = 10, inertia = 1e6;
  factor::BlockMatrix K(pattern), warped(pattern), expected(pattern);
  make_element_tangents(elements, pattern)->assemble(x, Tangent::kExact, K, &warped);
  K.add(viscous, warped);
  K.add_scalar(inertia, mass_blocks(elements, pattern));
  Eigen::MatrixXd element;
  for (int e = 0; e < elements.element_count(); ++e) {
    elements.stiffness(e, x, Tangent::kExact, viscous, element);
    expected.add(e, element);
    elements.mass(e, element);
    expected.add_scalar(e, inertia, element);
  }
  expect_near(K, expected, 1e-8);
}

TEST_P(TangentsOfEveryOrder, MultiplyManyVectorsAsTheyDoOne) {
  factor::BlockSystem system(body_.mesh, body_.fixed_nodes, patches(body_));
  system.add_random();
  const int n = body_.mesh.node_count();
  const factor::NodalColumns u = factor::NodalColumns::Random(3 * n, 8);
  factor::NodalColumns y = u;
  system.matrix.multiply(u, y);
  Matrix3Xd expected(3, n);
  for (int j = 0; j < u.cols(); ++j) {
    const Eigen::VectorXd column = u.col(j);
    system.matrix.multiply(Matrix3Xd(Eigen::Map<const Matrix3Xd>(column.data(), 3, n)), expected);
    const Eigen::VectorXd off =
        y.col(j) - Eigen::Map<const Eigen::VectorXd>(expected.data(), 3 * n);
    EXPECT_LT(off.norm(), 1e-12 * expected.norm());
  }
}

}  // namespace
}  // namespace palpate::elasticity

#include "core/elasticity/block_ldl.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "core/elasticity/element_set.hpp"
#include "tests/unit/core/elasticity/bodies.hpp"

namespace palpate::elasticity {
namespace {

class BlockLdlOfABar : public testing::Test {
 protected:
  BlockLdlOfABar() {
    Eigen::MatrixXd K;
    for (int e = 0; e < elements_.element_count(); ++e) {
      elements_.stiffness(e, body_.mesh.nodes, Tangent::kExact, 0, K);
      matrix_.add(e, K);
      const Eigen::VectorXi nodes = body_.mesh.elements.col(e);
      for (int a = 0; a < nodes.size(); ++a) {
        for (int b = 0; b < nodes.size(); ++b) {
          const int i = pattern_.unknown(nodes(a)), k = pattern_.unknown(nodes(b));
          if (i >= 0 && k >= 0) dense_.block<3, 3>(3 * i, 3 * k) += K.block<3, 3>(3 * a, 3 * b);
        }
      }
    }
  }

  const Body body_ = make_bar({0.2, 0.05, 0.05}, {4, 2, 1}, mesh::ElementOrder::kQuadratic);
  const ElementSet elements_{body_.mesh, body_.material};
  const BlockPattern pattern_{body_.mesh.elements, body_.mesh.node_count(), body_.fixed_nodes};
  BlockMatrix matrix_{pattern_};
  Eigen::MatrixXd dense_ = Eigen::MatrixXd::Zero(3 * pattern_.size(), 3 * pattern_.size());
};

TEST_F(BlockLdlOfABar, SolvesAsADenseFactorDoes) {
  ASSERT_EQ(pattern_.size() + static_cast<int>(body_.fixed_nodes.size()), body_.mesh.node_count());
  BlockLdl ldl(pattern_);
  std::vector<char> held(pattern_.size(), 0);
  for (bool with_held : {false, true}) {
    if (with_held) {
      for (int node : body_.grasps[0].nodes) {
        const int k = pattern_.unknown(node);
        held[k] = 1;
        dense_.middleRows<3>(3 * k).setZero();
        dense_.middleCols<3>(3 * k).setZero();
        dense_.block<3, 3>(3 * k, 3 * k).setIdentity();
      }
    }
    ASSERT_TRUE(ldl.factorise(matrix_, held, 0));
    Eigen::Matrix4Xd b = Eigen::Matrix4Xd::Random(4, pattern_.size());
    b.row(3).setZero();
    Eigen::VectorXd rhs = Eigen::Map<const Eigen::VectorXd>(
        Eigen::Matrix3Xd(b.topRows<3>()).eval().data(), 3 * pattern_.size());
    const Eigen::VectorXd expected = dense_.llt().solve(rhs);
    ldl.solve(b);
    for (int k = 0; k < pattern_.size(); ++k) {
      EXPECT_LT((b.col(k).head<3>() - expected.segment<3>(3 * k)).norm(), 1e-9 * expected.norm());
    }
  }
}

TEST_F(BlockLdlOfABar, MultipliesAsTheDenseMatrixDoes) {
  Eigen::Matrix3Xd u = Eigen::Matrix3Xd::Random(3, body_.mesh.node_count()), y = u;
  Eigen::VectorXd v(3 * pattern_.size());
  for (int node : body_.fixed_nodes) u.col(node).setZero();
  for (int k = 0; k < pattern_.size(); ++k) v.segment<3>(3 * k) = u.col(pattern_.node(k));
  // Columns of fixed nodes are not kept.
  matrix_.multiply(u, y);
  const Eigen::VectorXd expected = dense_ * v;
  for (int k = 0; k < pattern_.size(); ++k) {
    EXPECT_LT((y.col(pattern_.node(k)) - expected.segment<3>(3 * k)).norm(),
              1e-12 * expected.norm());
  }
}

TEST_F(BlockLdlOfABar, RefusesIndefiniteAndSingularMatrices) {
  BlockLdl ldl(pattern_);
  const std::vector<char> held(pattern_.size(), 0);
  EXPECT_FALSE(ldl.factorise(matrix_, held, -dense_.diagonal().maxCoeff()));
  EXPECT_TRUE(ldl.factorise(matrix_, held, 0)) << "a failure leaves the work space clean";

  const BlockPattern free(body_.mesh.elements, body_.mesh.node_count(), {});
  BlockMatrix singular(free);
  Eigen::MatrixXd K;
  for (int e = 0; e < elements_.element_count(); ++e) {
    elements_.stiffness(e, body_.mesh.nodes, Tangent::kExact, 0, K);
    singular.add(e, K);
  }
  BlockLdl of_singular(free);
  const std::vector<char> none(free.size(), 0);
  EXPECT_FALSE(of_singular.factorise(singular, none, 0));
  EXPECT_TRUE(of_singular.factorise(singular, none, 1e-4 * dense_.diagonal().maxCoeff()));
}

}  // namespace
}  // namespace palpate::elasticity

#include <gtest/gtest.h>

#include <limits>
#include <string_view>

#include "core/control/pseudo_inverse.hpp"
#include "core/math/random.hpp"

namespace palpate::control {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A feature of which only the size and kind matter.
class BareFeature : public shape::Feature {
 public:
  BareFeature(const char* kind, int dimension) : kind_(kind), dimension_(dimension) {}
  const char* kind() const noexcept override { return kind_; }
  int dimension() const noexcept override { return dimension_; }
  int value_count() const noexcept override { return dimension_; }
  shape::Unit unit(int row) const noexcept override {
    return std::string_view(kind_) == "pose" && row >= 3 ? shape::Unit::kRadian
                                                         : shape::Unit::kMetre;
  }
  const std::vector<Eigen::Vector3d>& rest_points() const noexcept override { return points_; }
  void evaluate(const Eigen::Matrix3Xd&, Eigen::Ref<VectorXd>) noexcept override {}
  void error(const Eigen::Ref<const VectorXd>&, const Eigen::Ref<const VectorXd>&,
             Eigen::Ref<VectorXd>) const noexcept override {}
  const std::vector<int>& support() const noexcept override { return support_; }
  const Eigen::SparseMatrix<double>& jacobian() const noexcept override { return jacobian_; }
  bool is_valid_target(const double*, int) const noexcept override { return true; }

 private:
  const char* kind_;
  int dimension_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<int> support_;
  Eigen::SparseMatrix<double> jacobian_;
};

MatrixXd random_matrix(math::Random& random, int rows, int columns) {
  return MatrixXd::NullaryExpr(rows, columns, [&](auto, auto) { return random.normal(); });
}

/// The same by Eigen's complete orthogonal decomposition, on scaled rows and columns.
VectorXd reference(const MatrixXd& J, const VectorXd& rows, double length, const VectorXd& s) {
  MatrixXd scaled = rows.asDiagonal() * J;
  scaled.rightCols<3>() /= length;
  VectorXd u = scaled.completeOrthogonalDecomposition().solve(VectorXd(rows.cwiseProduct(s)));
  u.tail<3>() /= length;
  return u;
}

class PseudoInverseTest : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Rows, PseudoInverseTest, ::testing::Values(1, 2, 3, 6, 9, 24));

TEST_P(PseudoInverseTest, EqualsAnOrthogonalDecomposition) {
  math::Random random(GetParam());
  const BareFeature feature("points", GetParam());
  PseudoInverse inverse({0.1, 0.0, 1e-4});
  inverse.set_up(feature);
  VectorXd rest(GetParam());
  for (int trial = 0; trial < 50; ++trial) {
    const MatrixXd J = random_matrix(random, GetParam(), 6);
    const VectorXd s = random_matrix(random, GetParam(), 1);
    ASSERT_TRUE(inverse.decompose(J));
    const VectorXd u = inverse.solve(s);
    const VectorXd expected = reference(J, VectorXd::Ones(GetParam()), 0.1, s);
    EXPECT_LT((u - expected).norm(), 1e-6 * (1 + expected.norm()));
    inverse.unreachable(s, rest);
    EXPECT_LT((s - J * expected - rest).norm(), 1e-6 * s.norm());
  }
}

TEST(PseudoInverse, ScalesTheRotationRowsOfAPose) {
  math::Random random(3);
  const BareFeature feature("pose", 6);
  PseudoInverse inverse({0.2, 0.0, 1e-4});
  inverse.set_up(feature);
  VectorXd rows(6);
  rows << 1, 1, 1, 0.2, 0.2, 0.2;
  // Two columns only: least squares, so that the weights of the rows matter.
  MatrixXd J = random_matrix(random, 6, 6);
  J.middleCols<4>(1).setZero();
  const VectorXd s = random_matrix(random, 6, 1);
  ASSERT_TRUE(inverse.decompose(J));
  EXPECT_LT((inverse.solve(s) - reference(J, rows, 0.2, s)).norm(), 1e-8);
}

TEST(PseudoInverse, FadesNearASingularity) {
  const BareFeature feature("point", 2);
  const double damping = 0.05;
  PseudoInverse inverse({1.0, damping, 1e-3});
  inverse.set_up(feature);
  const VectorXd s = VectorXd::Ones(2);
  double last = 1 / damping + 1e-6;
  for (double sigma : {0.05, 0.02, 0.01, 1e-4, 0.0}) {
    MatrixXd J = MatrixXd::Zero(2, 6);
    J(0, 0) = 1;
    J(1, 1) = sigma;
    ASSERT_TRUE(inverse.decompose(J));
    const math::Twist u = math::Twist::from(inverse.solve(s));
    EXPECT_NEAR(u.linear.x(), 1, 1e-9);
    EXPECT_NEAR(u.linear.y(), sigma / (damping * damping), 1e-6);
    EXPECT_LE(u.linear.y(), last);
    last = u.linear.y();
  }
}

TEST(PseudoInverse, ReportsWhatCannotBeReached) {
  const BareFeature feature("point", 3);
  PseudoInverse inverse({1.0, 0.02, 5e-3});
  inverse.set_up(feature);
  MatrixXd J = MatrixXd::Zero(3, 6);
  J(0, 0) = 1;
  J(1, 4) = 0.5;
  J(2, 5) = 1e-3;  // below the rank tolerance
  ASSERT_TRUE(inverse.decompose(J));
  VectorXd rest(3);
  inverse.unreachable(Eigen::Vector3d(1, 2, 3), rest);
  EXPECT_LT((rest - Eigen::Vector3d(0, 0, 3)).norm(), 1e-9);
}

TEST(PseudoInverse, RefusesNothingAndNonsense) {
  const BareFeature feature("point", 3);
  PseudoInverse inverse(PseudoInverse::Options{});
  inverse.set_up(feature);
  EXPECT_FALSE(inverse.decompose(MatrixXd::Zero(3, 6)));
  EXPECT_EQ(inverse.solve(VectorXd::Ones(3)).norm(), 0);
  EXPECT_FALSE(
      inverse.decompose(MatrixXd::Constant(3, 6, std::numeric_limits<double>::quiet_NaN())));
  EXPECT_FALSE(inverse.decompose(MatrixXd::Constant(3, 6, 1e300)));
  EXPECT_THROW(PseudoInverse({0, 0.1, 0.1}), std::invalid_argument);
  EXPECT_THROW(PseudoInverse({1, -0.1, 0.1}), std::invalid_argument);
  EXPECT_THROW(PseudoInverse({1, 0.1, 0}), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::control

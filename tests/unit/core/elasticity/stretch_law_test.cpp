#include "core/elasticity/stretch_law.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "core/elasticity/element_stress.hpp"
#include "core/elasticity/element_tangents.hpp"
#include "core/elasticity/worst_elements.hpp"
#include "tests/unit/core/elasticity/bodies.hpp"
#include "tests/unit/core/elasticity/elements.hpp"
#include "tests/unit/core/elasticity/laws.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// A bar, its interior nodes moved so that the elements are irregular.
class LawOfEveryName : public testing::TestWithParam<std::tuple<mesh::ElementOrder, TestedLaw>> {
 protected:
  LawOfEveryName() {
    mesh::TetrahedralMesh box = mesh::make_box({0.09, 0.06, 0.05}, {3, 2, 2});
    for (int i = 0; i < box.nodes.cols(); ++i)
      if (is_inside(box.nodes.col(i))) box.nodes.col(i) += Vector3d(0.004, -0.003, 0.005);
    body_.mesh = mesh::make_element_mesh(box, std::get<0>(GetParam()));
    body_.material = {1e5, 0.35, 300};
    body_.law = std::get<1>(GetParam()).law();
    rest_ = body_.mesh.nodes;
  }

  static bool is_inside(const Vector3d& p) {
    const Eigen::Array3d size(0.09, 0.06, 0.05);
    return (p.array() > 1e-6).all() && (p.array() < size - 1e-6).all();
  }
  Matrix3Xd shaken(const Matrix3Xd& x, double size) const {
    return x + size * Matrix3Xd::Random(3, x.cols());
  }
  /// Mean first Piola-Kirchhoff stress, from the forces that hold the nodes.
  Matrix3d mean_stress(const Matrix3d& F) const {
    const Matrix3Xd f = Elements(body_).evaluate(F * rest_).forces;
    return f * rest_.transpose() / (0.09 * 0.06 * 0.05);
  }
  factor::BlockMatrix tangent(const factor::BlockPattern& pattern, const Matrix3Xd& x,
                              Tangent kind) const {
    factor::BlockMatrix K(pattern);
    make_element_tangents(ElementSet(body_), pattern)->assemble(x, kind, K, nullptr);
    return K;
  }
  factor::BlockPattern pattern() const {
    return {body_.mesh.elements, body_.mesh.node_count(), {}};
  }

  Body body_;
  Matrix3Xd rest_;
};
INSTANTIATE_TEST_SUITE_P(
    All, LawOfEveryName,
    testing::Combine(testing::Values(mesh::ElementOrder::kLinear, mesh::ElementOrder::kQuadratic),
                     testing::ValuesIn(tested_laws())),
    [](const auto& test) {
      const bool linear = std::get<0>(test.param) == mesh::ElementOrder::kLinear;
      return (linear ? "linear_" : "quadratic_") + std::get<1>(test.param).name;
    });

TEST_P(LawOfEveryName, PassesThePatchTest) {
  Matrix3d F;
  F << 1.6, 0.3, -0.1, 0.2, 0.8, 0.15, -0.3, 0.1, 0.9;
  const Matrix3Xd f = Elements(body_).evaluate(F * rest_).forces;
  int inside = 0;
  for (int i = 0; i < rest_.cols(); ++i) {
    if (!is_inside(rest_.col(i))) continue;
    ++inside;
    EXPECT_LT(f.col(i).norm(), 1e-10 * f.norm());
  }
  EXPECT_GT(inside, 0);
}

/// Textbook answers of incompressible solids at 100 % strain. The deformation keeps the volume, and
/// the stress of a free face is taken off as a pressure.
TEST_P(LawOfEveryName, StressAtFullStrainIsTheTextbooks) {
  const TestedLaw& tested = std::get<1>(GetParam());
  const double mu = lame(body_.material).mu, stretch = 2;
  // sums of c (s^(a - 1) - s^(-b a - 1)); Mooney-Rivlin is Ogden's law with the exponents 2 and -2
  struct Term {
    double shear, exponent;
  };
  std::vector<Term> terms{{mu, 2}};
  const std::vector<double>& c = tested.constants;
  if (tested.name == "mooney_rivlin") terms = {{(1 - c[0]) * mu, 2}, {c[0] * mu, -2}};
  if (tested.name == "ogden_1") terms = {{mu, c[0]}};
  if (tested.name == "ogden_2") terms = {{(1 - c[2]) * mu, c[0]}, {c[2] * mu, c[1]}};
  const auto sum = [&](double s, double other) {
    double total = 0;
    for (const auto& [shear, a] : terms)
      total += 2 * shear / a * (std::pow(s, a - 1) - std::pow(s, -other * a - 1));
    return total;
  };
  const double side = 1 / std::sqrt(stretch), thin = 1 / (stretch * stretch);
  Matrix3d P = mean_stress(Vector3d(stretch, side, side).asDiagonal());
  EXPECT_NEAR((P(0, 0) - P(1, 1) * side / stretch) / sum(stretch, 0.5), 1, 1e-9) << "uniaxial";
  P = mean_stress(Vector3d(stretch, stretch, thin).asDiagonal());
  EXPECT_NEAR((P(0, 0) - P(2, 2) * thin / stretch) / sum(stretch, 2), 1, 1e-9) << "biaxial";
  Matrix3d F = Matrix3d::Identity();
  F(0, 1) = 1;
  const double s = 0.5 + std::sqrt(1.25);  // largest stretch of simple shear by 1
  EXPECT_NEAR(mean_stress(F)(0, 1) / (sum(s, 1) * s * s / (1 + s * s)), 1, 1e-9) << "shear";
}

TEST_P(LawOfEveryName, ForcesAreTheGradientOfTheEnergyAlsoOfInvertedElements) {
  std::srand(5);
  Elements elements(body_);
  const Matrix3Xd direction = Matrix3Xd::Random(3, rest_.cols());
  const double h = 1e-8;
  for (const double size : {1e-6, 3e-3, 3e-2}) {
    const Matrix3Xd x = rotation(2, {1, 2, -1}) * shaken(rest_, size);
    const Answer at = elements.evaluate(x);
    EXPECT_TRUE(std::isfinite(at.energy));
    const double slope = (elements.evaluate(x + h * direction).energy -
                          elements.evaluate(x - h * direction).energy) /
                         (2 * h);
    EXPECT_NEAR(slope, at.forces.cwiseProduct(direction).sum(), 1e-6 * at.forces.norm() + 1e-7);
    elements.evaluate(x);
    NodalField padded = NodalField::Zero(4, x.cols());
    padded.topRows<3>() = x;
    EXPECT_GE(elements.forces().doubts(padded, 1).inverted, size > 1e-2 ? 1 : 0);
  }
}

TEST_P(LawOfEveryName, ForgetsPositionsThatAreNotFinite) {
  std::srand(11);
  Elements elements(body_);
  const Matrix3Xd x = shaken(rest_, 2e-3);
  const Answer before = elements.evaluate(x);
  elements.evaluate(Matrix3Xd::Constant(3, x.cols(), std::nan("")));
  elements.evaluate(1e300 * x);
  const Answer after = elements.evaluate(x);
  EXPECT_NEAR(after.energy / before.energy, 1, 1e-12);
  EXPECT_LT((after.forces - before.forces).norm(), 1e-10 * before.forces.norm());
}

TEST_P(LawOfEveryName, TangentIsTheDifferenceOfForces) {
  std::srand(6);
  Elements elements(body_);
  const factor::BlockPattern all = pattern();
  const Matrix3Xd u = Matrix3Xd::Random(3, rest_.cols());
  const Matrix3Xd rest_turned = rotation(1.1, {0, 2, -1}) * rest_;
  const double h = 1e-7;
  for (const double size : {0.0, 1e-7, 3e-3}) {
    const Matrix3Xd x = shaken(rest_turned, size);
    const Matrix3Xd slope =
        (elements.evaluate(x + h * u).forces - elements.evaluate(x - h * u).forces) / (2 * h);
    Matrix3Xd product(3, x.cols());
    tangent(all, x, Tangent::kExact).multiply(u, product);
    EXPECT_LT((product - slope).norm(), 1e-6 * slope.norm()) << size;
  }
}

TEST_P(LawOfEveryName, SmallStrainIsThatOfTheLinearLaw) {
  std::srand(7);
  Body linear = body_;
  linear.law.reset();
  const Matrix3Xd x = shaken(rest_, 1e-8);
  const Answer hyper = Elements(body_).evaluate(x), other = Elements(linear).evaluate(x);
  EXPECT_LT((hyper.forces - other.forces).norm(), 1e-5 * other.forces.norm());
  EXPECT_NEAR(hyper.energy / other.energy, 1, 1e-5);
}

TEST_P(LawOfEveryName, SemidefiniteTangentHasNoNegativeEigenvalueAndIsTheExactOneAtRest) {
  std::srand(8);
  const factor::BlockPattern all = pattern();
  const Matrix3Xd u = Matrix3Xd::Random(3, rest_.cols());
  Matrix3Xd exact(3, rest_.cols()), semidefinite = exact;
  tangent(all, rest_, Tangent::kExact).multiply(u, exact);
  tangent(all, rest_, Tangent::kSemidefinite).multiply(u, semidefinite);
  EXPECT_LT((exact - semidefinite).norm(), 1e-9 * exact.norm());
  const factor::BlockMatrix K = tangent(all, shaken(rest_, 2e-2), Tangent::kSemidefinite);
  const Eigen::Index n = rest_.size();
  Eigen::MatrixXd dense(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    Matrix3Xd unit = Matrix3Xd::Zero(3, rest_.cols()), column = unit;
    unit.data()[k] = 1;
    K.multiply(unit, column);
    dense.col(k) = Eigen::Map<const Eigen::VectorXd>(column.data(), n);
  }
  const Eigen::VectorXd values =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense, Eigen::EigenvaluesOnly).eigenvalues();
  EXPECT_GT(values.minCoeff(), -1e-9 * values.maxCoeff());
}

TEST_P(LawOfEveryName, StressIsThatOfTheForces) {
  Matrix3d F;
  F << 1.5, 0.2, 0, -0.1, 0.9, 0.2, 0.1, 0, 0.8;
  const Matrix3d cauchy = mean_stress(F) * F.transpose() / F.determinant();
  const ElementStress stress = element_stress(body_, F * rest_);
  Eigen::Matrix<double, 6, 1> expected;
  expected << cauchy(0, 0), cauchy(1, 1), cauchy(2, 2), cauchy(0, 1), cauchy(0, 2), cauchy(1, 2);
  for (int e = 0; e < body_.mesh.element_count(); ++e)
    EXPECT_LT((stress.cauchy.col(e) - expected).norm(), 1e-9 * expected.norm());
}

TEST_P(LawOfEveryName, WorstElementsKnowTheStressAndItsDerivative) {
  std::srand(9);
  const Matrix3Xd x = shaken(rest_, 2e-3), dx = Matrix3Xd::Random(3, rest_.cols());
  const double h = 1e-8;
  WorstElements worst(body_, Strain::kStress);
  const Eigen::VectorXd before = element_stress(body_, x - h * dx).von_mises,
                        after = element_stress(body_, x + h * dx).von_mises;
  for (const ElementStrain& one : worst.look(x)) {
    double by_node = 0;
    for (int a = 0; a < one.by_node.cols(); ++a)
      by_node += one.by_node.col(a).dot(dx.col(body_.mesh.elements(a, one.element)));
    EXPECT_NEAR(one.value, 0.5 * (before + after)[one.element], 1e-6 * one.value);
    EXPECT_NEAR(by_node, (after - before)[one.element] / (2 * h), 1e-5 * one.by_node.norm());
  }
}

TEST_P(LawOfEveryName, SinglePrecisionIsNear) {
  std::srand(10);
  const Matrix3Xd x = rotation(2.5, {1, 2, 3}) * shaken(rest_, 2e-3);
  const Answer exact = Elements(body_).evaluate(x),
               single = Elements(body_, Precision::kSingle).evaluate(x);
  EXPECT_LT((single.forces - exact.forces).norm(), 2e-5 * exact.forces.norm());
  EXPECT_NEAR(single.energy / exact.energy, 1, 1e-5);
}

TEST(StretchLaw, EveryNameIsFoundAndIsLinearElasticAtSmallStrain) {
  for (const NamedStretchLaw& named : stretch_laws()) {
    std::vector<double> constants;
    for (const auto& c : named.constants) constants.push_back(c.start);
    const StretchLaw law = named.make(constants);
    EXPECT_NEAR(law.shares[0] + law.shares[1] + law.cofactor_share, 1, 1e-15) << named.name;
    EXPECT_EQ(find_stretch_law(named.name), &named);
  }
  EXPECT_EQ(find_stretch_law("rubber"), nullptr);
}

}  // namespace
}  // namespace palpate::elasticity

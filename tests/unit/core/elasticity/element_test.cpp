#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>
#include <random>

#include "core/elasticity/point_kernel.hpp"
#include "core/factor/block_matrix.hpp"
#include "core/math/polar.hpp"
#include "tests/unit/core/elasticity/bodies.hpp"
#include "tests/unit/core/elasticity/elements.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr mesh::ElementOrder kOrders[] = {mesh::ElementOrder::kLinear,
                                          mesh::ElementOrder::kQuadratic};

class ElementsOfEveryOrder : public testing::TestWithParam<mesh::ElementOrder> {
 protected:
  const Body body_ = make_bar({0.2, 0.05, 0.04}, {3, 3, 3}, GetParam());
  const ElementSet elements_{body_};
};

TEST_P(ElementsOfEveryOrder, VolumeAndMassAreThoseOfTheBox) {
  const double volume = 0.2 * 0.05 * 0.04;
  EXPECT_NEAR(elements_.volume(), volume, 1e-12 * volume);
  const double mass = volume * body_.material.density;
  EXPECT_NEAR(elements_.nodal_mass().sum(), mass, 1e-12 * mass);
  // Second moments about O: the consistent mass integrates products of linear fields exactly.
  Eigen::VectorXd x = body_.mesh.nodes.row(0).transpose();
  Eigen::VectorXd y = body_.mesh.nodes.row(1).transpose();
  double total = 0, xx = 0, xy = 0;
  Eigen::MatrixXd m;
  for (int e = 0; e < elements_.element_count(); ++e) {
    elements_.mass(e, m);
    const Eigen::VectorXi nodes = body_.mesh.elements.col(e);
    total += m.sum();
    xx += x(nodes).dot(m * x(nodes));
    xy += x(nodes).dot(m * y(nodes));
  }
  EXPECT_NEAR(total, mass, 1e-12 * mass);
  EXPECT_NEAR(xx, mass * 0.2 * 0.2 / 3, 1e-12 * mass);
  EXPECT_NEAR(xy, mass * 0.2 * 0.05 / 4, 1e-12 * mass);
}

// Under an affine map every point has the same stress: the force on interior nodes is zero, and the
// force on a face is P n times its area, P derived from the definition of the energy.
TEST_P(ElementsOfEveryOrder, PatchTest) {
  Matrix3d F;
  F << 1.05, 0.03, -0.02, 0.01, 0.94, 0.04, 0.02, -0.05, 1.02;
  F = rotation(0.7, {1, -2, 0.5}) * F;
  const Matrix3Xd x = (F * body_.mesh.nodes).colwise() + Vector3d(0.1, 0.2, 0.3);
  const auto [energy, f] = Elements(body_).evaluate(x);

  const Lame law = lame(body_.material);
  const Matrix3d R = math::polar_rotation(F);
  const double trace = (R.transpose() * F).trace() - 3;
  const Matrix3d P = 2 * law.mu * (F - R) + law.lambda * trace * R;
  const double density = law.mu * (F - R).squaredNorm() + 0.5 * law.lambda * trace * trace;
  EXPECT_NEAR(energy, density * elements_.volume(), 1e-12 * energy);

  const Matrix3Xd traction = face_load(body_.mesh, 0.2, P.col(0) * 0.05 * 0.04);
  int inside = 0, on_end = 0;
  for (int i = 0; i < x.cols(); ++i) {
    const Vector3d p = body_.mesh.nodes.col(i);
    const bool within_section =
        p.y() > 1e-9 && p.y() < 0.05 - 1e-9 && p.z() > 1e-9 && p.z() < 0.04 - 1e-9;
    if (!within_section || p.x() < 1e-9) continue;
    const bool is_end = p.x() > 0.2 - 1e-9;
    ++(is_end ? on_end : inside);
    const Vector3d expected = is_end ? Vector3d(traction.col(i)) : Vector3d::Zero();
    EXPECT_LT((f.col(i) - expected).norm(), 1e-12 * P.norm());
  }
  EXPECT_GT(inside, 0);
  EXPECT_GT(on_end, 0);
}

TEST_P(ElementsOfEveryOrder, SemidefiniteTangentHasNoNegativeEigenvalueAndEqualsTheExactOneAtRest) {
  std::srand(3);
  Eigen::MatrixXd exact, semidefinite, warped;
  elements_.stiffness(1, body_.mesh.nodes, Tangent::kExact, 0, exact);
  elements_.stiffness(1, body_.mesh.nodes, Tangent::kSemidefinite, 0, semidefinite);
  elements_.stiffness(1, body_.mesh.nodes, Tangent::kWarped, 0, warped);
  EXPECT_LT((exact - semidefinite).norm(), 1e-9 * exact.norm());
  EXPECT_LT((exact - warped).norm(), 1e-9 * exact.norm());

  // Compressed to half its size the element is unstable.
  Matrix3Xd x = 0.5 * body_.mesh.nodes + 0.003 * Matrix3Xd::Random(3, body_.mesh.node_count());
  elements_.stiffness(1, x, Tangent::kExact, 0, exact);
  elements_.stiffness(1, x, Tangent::kSemidefinite, 0, semidefinite);
  const auto least = [](const Eigen::MatrixXd& K) {
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K).eigenvalues()(0);
  };
  EXPECT_LT(least(exact), -1e-3 * exact.norm());
  EXPECT_GT(least(semidefinite), -1e-12 * exact.norm());
}

INSTANTIATE_TEST_SUITE_P(Order, ElementsOfEveryOrder, testing::ValuesIn(kOrders));

TEST(ElementSet, RefusesAnElementWithoutVolume) {
  Body body = make_bar({1, 1, 1}, {1, 1, 1}, mesh::ElementOrder::kLinear);
  std::swap(body.mesh.elements(0, 2), body.mesh.elements(1, 2));
  EXPECT_THROW(ElementSet{body}, std::invalid_argument);
  EXPECT_THROW(make_element_forces(body.mesh, std::vector<Lame>(body.mesh.element_count()),
                                   mesh_numbering(body.mesh), Precision::kDouble),
               std::invalid_argument);
}

template <class Pack>
class PointKernel : public testing::Test {};
using Packs = testing::Types<math::Pack4d, math::Pack8f>;
TYPED_TEST_SUITE(PointKernel, Packs, );  // as clang wants it

TYPED_TEST(PointKernel, FindsTheRotationFromAnyStartAndForInvertedPoints) {
  using Pack = TypeParam;
  using Real = typename math::PackTraits<Pack>::Real;
  const double rounding = sizeof(Real) == 4 ? 3e-5 : 1e-11;
  std::srand(5);
  std::array<PointState<Pack>, 2> state;
  for (int trial = 0; trial < 200; ++trial) {
    std::array<PackMatrix<Pack>, 2> F, R;
    for (auto& point : F) {
      for (Pack& component : point) {
        for (int lane = 0; lane < math::kLanes<Pack>; ++lane) {
          component[lane] = static_cast<Real>(Eigen::internal::random<double>(-1, 1));
        }
      }
    }
    update_rotations(F, state, R);
    for (int lane = 0; lane < 2 * math::kLanes<Pack>; ++lane) {
      Matrix3d f, r;
      for (int k = 0; k < 9; ++k) {
        f(k / 3, k % 3) = static_cast<double>(F[lane % 2][k][lane / 2]);
        r(k / 3, k % 3) = static_cast<double>(R[lane % 2][k][lane / 2]);
      }
      EXPECT_NEAR(r.determinant(), 1, rounding);
      // The maximum of tr(R^T F); its value is unique even if R is not.
      EXPECT_NEAR((r.transpose() * f).trace(), (math::polar_rotation(f).transpose() * f).trace(),
                  rounding);
    }
  }
}

// One evaluation after a small motion performs few rotation iterations: their residual must not
// show in the strain.
TYPED_TEST(PointKernel, FollowsSmallTurnsToTheRoundingOfStrains) {
  using Pack = TypeParam;
  using Real = typename math::PackTraits<Pack>::Real;
  const double rounding = sizeof(Real) == 4 ? 5e-7 : 5e-13;
  std::srand(6);
  for (const double strain : {0.0, 0.01, 0.1, 0.3}) {
    std::array<PointState<Pack>, 1> state;
    std::array<PackMatrix<Pack>, 1> F, R;
    std::vector<Matrix3d> f(math::kLanes<Pack>);
    for (Matrix3d& m : f) m = Matrix3d::Identity() + strain * Matrix3d::Random();
    for (const double turn :
         {0.0, 1e-4, 3e-4, 1e-3, 2e-3, 4e-3, 7e-3, 0.01, 0.02, 0.03, 0.05, 0.1}) {
      for (int lane = 0; lane < math::kLanes<Pack>; ++lane) {
        f[lane] = rotation(turn, Vector3d::Random().normalized()) * f[lane];
        for (int k = 0; k < 9; ++k) F[0][k][lane] = static_cast<Real>(f[lane](k / 3, k % 3));
      }
      update_rotations(F, state, R);
      for (int lane = 0; lane < math::kLanes<Pack>; ++lane) {
        const Matrix3d E = math::polar_rotation(f[lane]).transpose() * f[lane];
        const PackSymmetric<Pack>& found = state[0].strain;
        const double difference[6] = {
            found[0][lane] - (E(0, 0) - 1), found[1][lane] - (E(1, 1) - 1),
            found[2][lane] - (E(2, 2) - 1), found[3][lane] - E(0, 1),
            found[4][lane] - E(0, 2),       found[5][lane] - E(1, 2)};
        for (const double d : difference)
          EXPECT_LT(std::abs(d), rounding) << strain << ", " << turn;
      }
    }
  }
}

// A point that rotates for hours keeps a unit quaternion.
TYPED_TEST(PointKernel, RotationsDoNotDriftOffTheUnitSphere) {
  using Pack = TypeParam;
  using Real = typename math::PackTraits<Pack>::Real;
  std::array<PointState<Pack>, 2> state;
  std::array<PackMatrix<Pack>, 2> F, R;
  Matrix3d turned = Matrix3d::Identity();
  const Matrix3d step = rotation(7e-3, {1, -2, 0.5});
  for (int i = 0; i < 100'000; ++i) {
    turned = step * turned;
    for (auto& point : F) {
      for (int k = 0; k < 9; ++k) {
        point[k] = math::splat<Pack>(static_cast<double>(turned(k / 3, k % 3)));
      }
    }
    update_rotations(F, state, R);
  }
  for (const auto& point : state) {
    double norm2 = 0;
    for (const Pack& q : point.rotation) norm2 += static_cast<double>(q[1]) * q[1];
    EXPECT_NEAR(norm2, 1, 4 * std::numeric_limits<Real>::epsilon());
  }
}

TEST_P(ElementsOfEveryOrder, NumberingChangesNothingButRounding) {
  std::srand(11);
  const int n = body_.mesh.node_count();
  const Matrix3Xd x = body_.mesh.nodes + 1e-3 * Matrix3Xd::Random(3, n);
  const Answer expected = Elements(body_).evaluate(x);
  std::vector<int> numbering = mesh_numbering(body_.mesh);
  std::shuffle(numbering.begin(), numbering.end(), std::mt19937(12));
  NodalField shuffled = NodalField::Zero(4, n), forces = shuffled;
  for (int i = 0; i < n; ++i) shuffled.col(numbering[i]).head<3>() = x.col(i);
  const auto elements =
      make_element_forces(body_.mesh, elements_.materials(), numbering, Precision::kDouble);
  EXPECT_NEAR(elements->add(shuffled, 0, forces), expected.energy, 1e-12 * expected.energy);
  for (int i = 0; i < n; ++i) {
    EXPECT_LT((forces.col(numbering[i]).head<3>() - expected.forces.col(i)).norm(),
              1e-12 * expected.forces.norm());
  }
}

TEST_P(ElementsOfEveryOrder, SinglePrecisionKeepsSevenDigitsOfStrainFarFromTheOrigin) {
  std::srand(7);
  const Matrix3d R = rotation(0.7, {1, -2, 0.5});
  const Matrix3Xd strained =
      body_.mesh.nodes + 3e-4 * Matrix3Xd::Random(3, body_.mesh.node_count());
  const Matrix3Xd x = (R * strained).colwise() + Vector3d(5, -3, 2);
  const Answer exact = Elements(body_).evaluate(x);
  const Answer single = Elements(body_, Precision::kSingle).evaluate(x);
  EXPECT_NEAR(single.energy, exact.energy, 1e-5 * exact.energy);
  // Forces of rounded strains correspond to stresses of about 1e-7 E.
  const double largest = exact.forces.colwise().norm().maxCoeff();
  EXPECT_LT((single.forces - exact.forces).colwise().norm().maxCoeff(), 3e-5 * largest);
}

TEST_P(ElementsOfEveryOrder, EachElementHasItsOwnMaterial) {
  Body body = body_;
  for (int e = 0; e < body.mesh.element_count(); ++e) {
    body.element_materials.push_back({1e4 * (1 + e % 7), 0.1 * (e % 5), 100.0 + e});
  }
  std::srand(9);
  const Matrix3Xd x = body.mesh.nodes + 1e-3 * Matrix3Xd::Random(3, body.mesh.node_count());
  const Answer all = Elements(body).evaluate(x);
  double energy = 0, mass = 0;
  Matrix3Xd forces = Matrix3Xd::Zero(3, x.cols());
  for (int e = 0; e < body.mesh.element_count(); ++e) {
    Body one = body;
    one.mesh.elements = body.mesh.elements.col(e).eval();
    one.element_materials = {body.element_materials[e]};
    Elements element(one);
    const Answer a = element.evaluate(x);
    energy += a.energy;
    forces += a.forces;
    mass += element.matrices.nodal_mass().sum();
  }
  EXPECT_NEAR(all.energy, energy, 1e-12 * energy);
  EXPECT_LT((all.forces - forces).norm(), 1e-12 * forces.norm());
  EXPECT_NEAR(ElementSet(body).nodal_mass().sum(), mass, 1e-12 * mass);
}

TEST_P(ElementsOfEveryOrder, RotationsOfNodesAreThoseOfARigidMotion) {
  Elements elements(body_);
  const Matrix3d R = rotation(2.5, {1, -2, 0.5});
  elements.evaluate(R * body_.mesh.nodes);
  Eigen::Matrix4Xf q = Eigen::Matrix4Xf::Zero(4, body_.mesh.node_count());
  q.row(0).setOnes();
  elements.forces().node_rotations(q);
  for (int i = 0; i < q.cols(); ++i) {
    const Eigen::Quaternionf rotation_of_node(q(0, i), q(1, i), q(2, i), q(3, i));
    EXPECT_LT((rotation_of_node.toRotationMatrix().cast<double>() - R).norm(), 1e-6);
  }
}

// Compared with quaternions of polar decompositions, element by element.
template <int kNodes>
Eigen::Matrix4Xd expected_rotations(const mesh::ElementMesh& mesh, const Matrix3Xd& x) {
  const auto add = [](const Eigen::Vector4d& q, auto&& sum) {
    sum += q.dot(sum) < 0 ? Eigen::Vector4d(-q) : q;
  };
  Eigen::Matrix4Xd sums = Eigen::Matrix4Xd::Zero(4, mesh.node_count());
  for (int e = 0; e < mesh.element_count(); ++e) {
    const Eigen::VectorXi nodes = mesh.elements.col(e);
    const Eigen::Matrix<double, 3, 4> corners = mesh.nodes(Eigen::all, nodes.head<4>());
    Eigen::Vector4d of_element = Eigen::Vector4d::Zero();
    for (const auto& gradients : Tetrahedron<kNodes>::gradients(corners)) {
      const Matrix3d F = x(Eigen::all, nodes) * gradients.transpose();
      const Eigen::Quaterniond q(math::polar_rotation(F));
      add({q.w(), q.x(), q.y(), q.z()}, of_element);
    }
    for (int a = 0; a < 4; ++a) add(of_element, sums.col(nodes(a)));
  }
  for (int e = 0; e < mesh.element_count(); ++e) {
    for (int m = 4; m < kNodes; ++m) {
      const int* edge = mesh::kTetrahedronEdges[m - 4];
      auto&& middle = sums.col(mesh.elements(m, e));
      middle = sums.col(mesh.elements(edge[0], e));
      add(sums.col(mesh.elements(edge[1], e)), middle);
    }
  }
  return sums.colwise().normalized();
}

TEST_P(ElementsOfEveryOrder, RotationsOfNodesAreMeansOverTheirElements) {
  std::srand(13);
  const int n = body_.mesh.node_count();
  const Matrix3Xd x =
      rotation(2.5, {1, -2, 0.5}) * (body_.mesh.nodes + 2e-3 * Matrix3Xd::Random(3, n));
  const Eigen::Matrix4Xd expected = GetParam() == mesh::ElementOrder::kLinear
                                        ? expected_rotations<4>(body_.mesh, x)
                                        : expected_rotations<10>(body_.mesh, x);
  for (const Precision precision : {Precision::kSingle, Precision::kDouble}) {
    Elements elements(body_, precision);
    elements.evaluate(x);
    Eigen::Matrix4Xf q = Eigen::Matrix4Xf::Zero(4, n);
    for (int i = 0; i < n; ++i) q(0, i) = i % 2 == 0 ? 1.0F : -1.0F;
    const Eigen::Matrix4Xf signs = q;
    elements.forces().node_rotations(q);
    for (int i = 0; i < n; ++i) {
      const double sign = expected.col(i).dot(q.col(i).cast<double>()) < 0 ? -1 : 1;
      EXPECT_LT((sign * q.col(i).cast<double>() - expected.col(i)).norm(), 1e-6);
      const bool is_corner = (body_.mesh.elements.topRows<4>().array() == i).any();
      if (is_corner) {
        EXPECT_GT(q.col(i).dot(signs.col(i)), 0);
      }
    }
  }
}

TEST(BodyCheck, NamesWhatIsWrong) {
  const Body good = make_bar({1, 1, 1}, {1, 1, 1}, mesh::ElementOrder::kLinear);
  EXPECT_NO_THROW(good.check());
  const auto refused = [&](auto&& spoil) {
    Body body = good;
    spoil(body);
    EXPECT_THROW(body.check(), std::invalid_argument);
  };
  refused([](Body& b) { b.material.poisson_ratio = 0.5; });
  refused([](Body& b) { b.material.young_modulus = 0; });
  refused([](Body& b) { b.material.density = -1; });
  refused([](Body& b) { b.fixed_nodes.push_back(8); });
  refused([](Body& b) { b.fixed_nodes.push_back(b.grasps[0].nodes[0]); });
  refused([](Body& b) { b.grasps[0].nodes.clear(); });
  refused([](Body& b) { b.mesh.elements(0, 0) = -1; });
  refused([](Body& b) { b.mesh.elements.resize(4, 0); });
  refused([](Body& b) { b.mesh.nodes(0, 0) = std::nan(""); });
}

}  // namespace
}  // namespace palpate::elasticity

#include "sim/object/hexahedron_pack.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "sim/object/hexahedral_grid.hpp"

namespace palpate::object {
namespace {

/// Six different elements: one full pack and half of another.
HexahedralGrid pack_grid() {
  return {Eigen::Vector3d(0.1, -0.2, 0.3), {{{0, 0.03, 0.08, 0.12}, {0, 0.02, 0.06}, {0, 0.05}}}};
}

Eigen::Matrix3Xd random_motion(Eigen::Index n) {
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Eigen::Matrix3Xd field(3, n);
  for (double& value : field.reshaped()) value = uniform(generator);
  return field;
}

/// Sums of products of shape functions and their slopes, as in textbooks.
Eigen::Matrix3d plain_gradient(const HexahedralGrid& grid, const Eigen::Matrix3Xd& field,
                               int element, int point) {
  Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
  const double g = std::sqrt(0.6);
  const QuadraticShape shape[3] = {QuadraticShape(g * (point % 3 - 1)),
                                   QuadraticShape(g * (point / 3 % 3 - 1)),
                                   QuadraticShape(g * (point / 9 - 1))};
  for (int a = 0; a < 27; ++a) {
    const int index[3] = {a % 3, a / 3 % 3, a / 9};
    for (int axis = 0; axis < 3; ++axis) {
      double slope = 2 / grid.element_size(element)[axis];
      for (int d = 0; d < 3; ++d)
        slope *= d == axis ? shape[d].slope[index[d]] : shape[d].value[index[d]];
      gradient.col(axis) += slope * field.col(grid.elements()(a, element));
    }
  }
  return gradient;
}

TEST(HexahedronPack, GradientsAreThoseOfTheShapeFunctions) {
  const HexahedralGrid box = pack_grid();
  const Eigen::Matrix3Xd field = random_motion(box.node_count());
  for (const int first : {0, 4}) {
    const HexahedronPack pack(box, first);
    ASSERT_EQ(pack.lanes(), first == 0 ? 4 : 2);
    HexahedronPack::Vectors nodal;
    ElementGradients found;
    pack.gather(field.data(), nodal);
    pack.gradients(nodal, found);
    for (int lane = 0; lane < pack.lanes(); ++lane) {
      for (int point = 0; point < kGaussPoints; ++point) {
        const Eigen::Matrix3d plain = plain_gradient(box, field, first + lane, point);
        EXPECT_LT((tensor_at(found, lane, point) - plain).cwiseAbs().maxCoeff(),
                  1e-14 * plain.norm() + 1e-12);
      }
    }
  }
}

TEST(HexahedronPack, DivergenceDoesTheWorkOfTheStress) {
  const HexahedralGrid box = pack_grid();
  const Eigen::Matrix3Xd virtual_motion = random_motion(box.node_count());
  Eigen::Matrix3Xd forces = Eigen::Matrix3Xd::Zero(3, box.node_count());
  double work = 0, scale = 0;
  for (int first = 0; first < box.element_count(); first += kTogether) {
    const HexahedronPack pack(box, first);
    ElementGradients stress;
    for (int point = 0; point < kGaussPoints; ++point) {
      for (int lane = 0; lane < kTogether; ++lane) {
        Eigen::Matrix3d P;
        for (int k = 0; k < 9; ++k) P(k / 3, k % 3) = std::sin(1 + first + lane + 5 * point + k);
        set_tensor(stress, lane, point, P);
        if (lane >= pack.lanes()) continue;
        const int along[3] = {point % 3, point / 3 % 3, point / 9};
        double weight = 1;
        for (const int i : along) weight *= i == 1 ? 8. / 18 : 5. / 18;
        EXPECT_NEAR(HexahedronPack::weight(point), weight, 1e-15);
        const double part =
            pack.volume(lane) * weight *
            plain_gradient(box, virtual_motion, first + lane, point).cwiseProduct(P).sum();
        work += part;
        scale += std::abs(part);
      }
    }
    HexahedronPack::Vectors nodal;
    pack.divergence(stress, nodal);
    pack.scatter(nodal, forces.data());
  }
  EXPECT_NEAR(forces.cwiseProduct(virtual_motion).sum(), -work, 1e-13 * scale);
}

TEST(HexahedronPack, PointsAreThoseOfGauss) {
  const Eigen::Array3d first = HexahedronPack::point(0), middle = HexahedronPack::point(13);
  EXPECT_LT((first - (0.5 - std::sqrt(0.15))).abs().maxCoeff(), 1e-15);
  EXPECT_LT((middle - 0.5).abs().maxCoeff(), 1e-15);
  EXPECT_NEAR(HexahedronPack::point(2).x(), 0.5 + std::sqrt(0.15), 1e-15);
  EXPECT_NEAR(HexahedronPack::point(18).z(), 0.5 + std::sqrt(0.15), 1e-15);
}

}  // namespace
}  // namespace palpate::object

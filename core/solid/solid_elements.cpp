#include "core/solid/solid_elements.hpp"

#include <limits>
#include <stdexcept>
#include <string>

namespace palpate::solid {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Column = Eigen::Matrix<double, 30, 1>;
using Square = Eigen::Matrix<double, 30, 30>;
using Strain = Eigen::Matrix<double, 9, 30>;  // derivative of F with respect to the nodes

Strain strain(const elasticity::Tetrahedron<10>::Gradients& gradients) {
  Strain B = Strain::Zero();
  for (int a = 0; a < 10; ++a) {
    for (int k = 0; k < 3; ++k) B.block<3, 3>(3 * k, 3 * a).diagonal().setConstant(gradients(k, a));
  }
  return B;
}

}  // namespace

SolidElements::SolidElements(const mesh::ElementMesh& mesh) : mesh_(mesh) {
  if (mesh.order != mesh::ElementOrder::kQuadratic) {
    throw std::invalid_argument("a solid needs quadratic elements");
  }
  for (int e = 0; e < mesh.element_count(); ++e) {
    Eigen::Matrix<double, 3, 4> corners;
    for (int a = 0; a < 4; ++a) corners.col(a) = mesh.nodes.col(mesh.elements(a, e));
    const double volume = elasticity::tetrahedron_volume(corners);
    if (!(volume > 0)) {
      throw std::invalid_argument("element " + std::to_string(e) + " has no positive volume");
    }
    shapes_.push_back({Element::gradients(corners), volume / Element::kPoints});
  }
}

SolidElements::Nodes SolidElements::gather(int element, const Matrix3Xd& x) const {
  Nodes d;  // relative to the first node, for accuracy far from the origin
  for (int a = 0; a < 10; ++a) {
    d.col(a) = x.col(mesh_.elements(a, element)) - x.col(mesh_.elements(0, element));
  }
  return d;
}

double SolidElements::forces(const Matrix3Xd& x, const SolidCoefficients& c,
                             Matrix3Xd& forces) const {
  forces.setZero(3, mesh_.node_count());
  double energy = 0;
  PointResponse response;
  Matrix3d cofactors;
  for (int e = 0; e < mesh_.element_count(); ++e) {
    const Shape& shape = shapes_[e];
    const Nodes d = gather(e, x);
    Nodes local = Nodes::Zero(), of_volume = Nodes::Zero();
    double mean = 0;
    for (const Nodes& g : shape.gradients) {
      const Matrix3d F = d * g.transpose();
      if (!point_response(F, c, false, response)) return std::numeric_limits<double>::infinity();
      energy += shape.weight * response.energy;
      local += shape.weight * response.stress * g;
      mean += volume_ratio(F, cofactors) / Element::kPoints;
      of_volume += shape.weight * cofactors * g;
    }
    energy += 0.5 * Element::kPoints * shape.weight * c.bulk_mean * (mean - 1) * (mean - 1);
    local += c.bulk_mean * (mean - 1) * of_volume;
    for (int a = 0; a < 10; ++a) forces.col(mesh_.elements(a, e)) += local.col(a);
  }
  return energy;
}

void SolidElements::add_tangent(const Matrix3Xd& x, const SolidCoefficients& c, double factor,
                                factor::BlockMatrix& tangent) const {
  PointResponse response;
  Eigen::Matrix<double, 9, 9> second;
  Eigen::MatrixXd K(30, 30);
  for (int e = 0; e < mesh_.element_count(); ++e) {
    const Shape& shape = shapes_[e];
    const Nodes d = gather(e, x);
    double mean = 0;
    Matrix3d cofactors;
    for (const Nodes& g : shape.gradients) {
      mean += volume_ratio(d * g.transpose(), cofactors) / Element::kPoints;
    }
    Column of_volume = Column::Zero();
    Square sum = Square::Zero();
    for (const Nodes& g : shape.gradients) {
      const Matrix3d F = d * g.transpose();
      const Strain B = strain(g);
      point_response(F, c, true, response);
      volume_ratio(F, cofactors, &second);
      of_volume += shape.weight * B.transpose() *
                   Eigen::Map<const Eigen::Matrix<double, 9, 1>>(cofactors.data());
      second = shape.weight * (response.tangent + c.bulk_mean * (mean - 1) * second);
      sum.noalias() += B.transpose() * (second * B);
    }
    const double volume = Element::kPoints * shape.weight;
    sum.noalias() += c.bulk_mean / volume * of_volume * of_volume.transpose();
    K = factor * sum;
    tangent.add(e, K);
  }
}

}  // namespace palpate::solid

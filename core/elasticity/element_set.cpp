#include "core/elasticity/element_set.hpp"

#include <stdexcept>
#include <string>

namespace palpate::elasticity {

ElementSet::ElementSet(const Body& body)
    : mesh_(body.mesh),
      materials_(element_materials(body)),
      nodal_mass_(Eigen::VectorXd::Zero(body.mesh.node_count())) {
  const bool is_linear = mesh_.order == mesh::ElementOrder::kLinear;
  for (int e = 0; e < mesh_.element_count(); ++e) {
    const double volume = tetrahedron_volume(rest_corners(e));
    if (!(volume > 0)) {
      throw std::invalid_argument("element " + std::to_string(e) + " has no positive volume");
    }
    const Material& material = body.material_of(e);
    density_.push_back(material.density);
    volume_ += volume;
    for (int a = 0; a < nodes_per_element(); ++a) {
      const double share =
          is_linear ? Tetrahedron<4>::volume_shares()(a) : Tetrahedron<10>::volume_shares()(a);
      nodal_mass_(mesh_.elements(a, e)) += material.density * volume * share;
    }
  }
}

Eigen::Matrix<double, 3, 4> ElementSet::rest_corners(int element) const {
  Eigen::Matrix<double, 3, 4> corners;
  for (int a = 0; a < 4; ++a) corners.col(a) = mesh_.nodes.col(mesh_.elements(a, element));
  return corners;
}

template <int kNodes>
void ElementSet::element_stiffness(int element, const Eigen::Matrix3Xd& x, Tangent kind,
                                   double viscous, Eigen::MatrixXd& K) const {
  using Element = Tetrahedron<kNodes>;
  const Eigen::Matrix<double, 3, 4> corners = rest_corners(element);
  const auto gradients = Element::gradients(corners);
  const double weight = tetrahedron_volume(corners) / Element::kPoints;
  Eigen::Matrix<double, 3, kNodes> d;
  for (int a = 0; a < kNodes; ++a) {
    d.col(a) = x.col(mesh_.elements(a, element)) - x.col(mesh_.elements(0, element));
  }
  K.setZero(3 * kNodes, 3 * kNodes);
  for (const auto& g : gradients) {
    const PointTangent t =
        point_tangent(d * g.transpose(), materials_.lame[element], kind, viscous);
    const Eigen::Matrix<double, 3, kNodes> h = t.rotation * g;
    for (int a = 0; a < kNodes; ++a) {
      const Eigen::Matrix3d left = math::cross_matrix(h.col(a)) * t.twist;
      for (int b = a; b < kNodes; ++b) {
        Eigen::Matrix3d block = left * math::cross_matrix(h.col(b));
        block += t.l * h.col(a) * h.col(b).transpose();
        block.diagonal().array() += t.s * h.col(a).dot(h.col(b));
        K.block<3, 3>(3 * a, 3 * b) += weight * block;
      }
    }
  }
  for (int a = 0; a < kNodes; ++a) {
    for (int b = a + 1; b < kNodes; ++b) {
      K.block<3, 3>(3 * b, 3 * a) = K.block<3, 3>(3 * a, 3 * b).transpose();
    }
  }
}

void ElementSet::stiffness(int element, const Eigen::Matrix3Xd& x, Tangent kind, double viscous,
                           Eigen::MatrixXd& K) const {
  if (mesh_.order == mesh::ElementOrder::kQuadratic) {
    element_stiffness<10>(element, x, kind, viscous, K);
  } else {
    element_stiffness<4>(element, x, kind, viscous, K);
  }
}

void ElementSet::mass(int element, Eigen::MatrixXd& M) const {
  if (mesh_.order == mesh::ElementOrder::kQuadratic) {
    M = Tetrahedron<10>::mass_shares();
  } else {
    M = Tetrahedron<4>::mass_shares();
  }
  M *= density_[element] * tetrahedron_volume(rest_corners(element));
}

}  // namespace palpate::elasticity

#include "core/elasticity/element_set.hpp"

#include <stdexcept>
#include <string>

namespace palpate::elasticity {

ElementSet::ElementSet(const mesh::ElementMesh& mesh, const Material& material)
    : mesh_(mesh),
      lame_(lame(material)),
      density_(material.density),
      nodal_mass_(Eigen::VectorXd::Zero(mesh.node_count())) {
  const bool is_linear = mesh.order == mesh::ElementOrder::kLinear;
  for (int e = 0; e < mesh.element_count(); ++e) {
    const Eigen::Matrix<double, 3, 4> corners = rest_corners(e);
    const double v = tetrahedron_volume(corners);
    if (!(v > 0)) {
      throw std::invalid_argument("element " + std::to_string(e) + " has no positive volume");
    }
    volume_ += v;
    if (is_linear) {
      const int lane = e % 4;
      if (lane == 0) {
        // Lanes beyond the last element repeat it with no weight.
        linear_.emplace_back();
        linear_.back().weight.setZero();
      }
      LinearBlock& block = linear_.back();
      const auto g = Tetrahedron<4>::gradients(corners)[0];
      block.weight(lane) = v;
      for (int l = lane; l < 4; ++l) {
        for (int a = 0; a < 4; ++a) block.nodes[l][a] = mesh.elements(a, e);
        for (int k = 0; k < 9; ++k) block.gradients[k](l) = g(k % 3, 1 + k / 3);
      }
      const auto shares = Tetrahedron<4>::volume_shares();
      for (int a = 0; a < 4; ++a) nodal_mass_(mesh.elements(a, e)) += density_ * v * shares(a);
    } else {
      QuadraticBlock& block = quadratic_.emplace_back();
      const auto g = Tetrahedron<10>::gradients(corners);
      block.weight = Lanes::Constant(v / 4);
      for (int a = 0; a < 10; ++a) block.nodes[a] = mesh.elements(a, e);
      for (int p = 0; p < 4; ++p) {
        for (int k = 0; k < 27; ++k) block.gradients[k](p) = g[p](k % 3, 1 + k / 3);
      }
      const auto shares = Tetrahedron<10>::volume_shares();
      for (int a = 0; a < 10; ++a) nodal_mass_(mesh.elements(a, e)) += density_ * v * shares(a);
    }
  }
}

Eigen::Matrix<double, 3, 4> ElementSet::rest_corners(int element) const {
  Eigen::Matrix<double, 3, 4> corners;
  for (int a = 0; a < 4; ++a) corners.col(a) = mesh_.nodes.col(mesh_.elements(a, element));
  return corners;
}

// Differences are taken within the element, not from the rest positions, so that nothing is lost
// when the body has moved far.
void ElementSet::deformation(const QuadraticBlock& b, const Eigen::Matrix3Xd& x, LaneMatrix& F) {
  const Eigen::Vector3d x0 = x.col(b.nodes[0]);
  for (Lanes& component : F) component.setZero();
  for (int a = 0; a < 9; ++a) {
    const Eigen::Vector3d d = x.col(b.nodes[a + 1]) - x0;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) F[3 * i + j] += d(i) * b.gradients[3 * a + j];
    }
  }
}

void ElementSet::deformation(const LinearBlock& b, const Eigen::Matrix3Xd& x, LaneMatrix& F) {
  for (Lanes& component : F) component.setZero();
  for (int a = 0; a < 3; ++a) {
    for (int i = 0; i < 3; ++i) {
      Lanes d;
      for (int l = 0; l < 4; ++l) d(l) = x(i, b.nodes[l][a + 1]) - x(i, b.nodes[l][0]);
      for (int j = 0; j < 3; ++j) F[3 * i + j] += d * b.gradients[3 * a + j];
    }
  }
}

void ElementSet::scatter(const QuadraticBlock& b, const LaneMatrix& P, Eigen::Matrix3Xd& forces) {
  Eigen::Vector3d rest = Eigen::Vector3d::Zero();
  for (int a = 0; a < 9; ++a) {
    Eigen::Vector3d f;
    for (int i = 0; i < 3; ++i) {
      f(i) = (P[3 * i] * b.gradients[3 * a] + P[3 * i + 1] * b.gradients[3 * a + 1] +
              P[3 * i + 2] * b.gradients[3 * a + 2])
                 .sum();
    }
    forces.col(b.nodes[a + 1]) += f;
    rest += f;
  }
  forces.col(b.nodes[0]) -= rest;
}

void ElementSet::scatter(const LinearBlock& b, const LaneMatrix& P, Eigen::Matrix3Xd& forces) {
  for (int i = 0; i < 3; ++i) {
    Lanes rest = Lanes::Zero();
    for (int a = 0; a < 3; ++a) {
      const Lanes f = P[3 * i] * b.gradients[3 * a] + P[3 * i + 1] * b.gradients[3 * a + 1] +
                      P[3 * i + 2] * b.gradients[3 * a + 2];
      for (int l = 0; l < 4; ++l) forces(i, b.nodes[l][a + 1]) += f(l);
      rest += f;
    }
    for (int l = 0; l < 4; ++l) forces(i, b.nodes[l][0]) -= rest(l);
  }
}

template <class Block>
double ElementSet::add_block_forces(const std::vector<Block>& blocks, const Eigen::Matrix3Xd& x,
                                    double viscous, State& state,
                                    Eigen::Matrix3Xd& forces) const noexcept {
  Lanes energy = Lanes::Zero();
  LaneMatrix F, R, P;
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const Block& block = blocks[k];
    deformation(block, x, F);
    update_rotation(F, state[k], R);
    energy += block.weight * add_stress(lame_, viscous, state[k], R, P);
    for (Lanes& component : P) component *= block.weight;
    scatter(block, P, forces);
  }
  return energy.sum();
}

double ElementSet::add_forces(const Eigen::Matrix3Xd& x, double viscous, State& state,
                              Eigen::Matrix3Xd& forces) const noexcept {
  return linear_.empty() ? add_block_forces(quadratic_, x, viscous, state, forces)
                         : add_block_forces(linear_, x, viscous, state, forces);
}

void ElementSet::begin_step(State& state) noexcept {
  for (PointState& points : state) points.previous_stretch = points.stretch;
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
    const PointTangent t = point_tangent(d * g.transpose(), lame_, kind, viscous);
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
  if (linear_.empty()) {
    element_stiffness<10>(element, x, kind, viscous, K);
  } else {
    element_stiffness<4>(element, x, kind, viscous, K);
  }
}

void ElementSet::mass(int element, Eigen::MatrixXd& M) const {
  if (linear_.empty()) {
    M = Tetrahedron<10>::mass_shares();
  } else {
    M = Tetrahedron<4>::mass_shares();
  }
  M *= density_ * tetrahedron_volume(rest_corners(element));
}

}  // namespace palpate::elasticity

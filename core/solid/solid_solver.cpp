#include "core/solid/solid_solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "core/elasticity/element_tangents.hpp"

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

using Eigen::Matrix3Xd;

/// Body of unit density with this mesh.
elasticity::Body unit_body(const mesh::ElementMesh& mesh, const std::vector<int>& fixed_nodes) {
  if (fixed_nodes.empty()) throw std::invalid_argument("a solid needs nodes that are fixed");
  elasticity::Body body;
  body.mesh = mesh;
  body.material.density = 1;
  body.fixed_nodes = fixed_nodes;
  body.check();
  return body;
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

SolidBody::SolidBody(const mesh::ElementMesh& mesh, const std::vector<int>& fixed_nodes)
    : elements_(mesh),
      pattern_(mesh.elements, mesh.node_count(), fixed_nodes),
      supernodes_(pattern_),
      extent_((mesh.nodes.rowwise().maxCoeff() - mesh.nodes.rowwise().minCoeff()).norm()) {
  const elasticity::ElementSet set(unit_body(mesh, fixed_nodes));
  nodal_volume_ = set.nodal_mass();
  volume_blocks_ = elasticity::mass_blocks(set, pattern_);
}

double SolidSolver::rounding() const {
  const double stiffest = *std::max_element(factor_.diagonal().begin(), factor_.diagonal().end());
  return std::numeric_limits<double>::epsilon() * stiffest * body_.extent();
}

void SolidSolver::clear_fixed(Matrix3Xd& field) const {
  for (int node = 0; node < field.cols(); ++node) {
    if (body_.pattern().unknown(node) < 0) field.col(node).setZero();
  }
}

bool SolidSolver::factorise(const factor::BlockMatrix& matrix) {
  return factor_.factorise(matrix) && factor_.is_positive({});
}

Matrix3Xd SolidSolver::apply_inverse(const Matrix3Xd& rhs) {
  Eigen::MatrixXd columns(3 * body_.pattern().size(), 1);
  for (int k = 0; k < body_.pattern().size(); ++k) {
    columns.block<3, 1>(3 * k, 0) = rhs.col(body_.pattern().node(k));
  }
  factor_.solve(columns, {});
  Matrix3Xd solution = Matrix3Xd::Zero(3, rhs.cols());
  for (int k = 0; k < body_.pattern().size(); ++k) {
    solution.col(body_.pattern().node(k)) = columns.block<3, 1>(3 * k, 0);
  }
  return solution;
}

factor::BlockMatrix SolidSolver::tangent(const Matrix3Xd& x, const SolidCoefficients& c) const {
  factor::BlockMatrix K(body_.pattern());
  body_.elements().add_tangent(x, c, 1, K);
  return K;
}

bool SolidSolver::newton(const SolidCoefficients& c, const Matrix3Xd& loads, Matrix3Xd& x,
                         const SolidOptions& options) {
  Matrix3Xd forces;
  double scale = 0;
  const auto evaluate = [&] {
    const double energy = body_.elements().forces(x, c, forces);
    if (!std::isfinite(energy)) return energy;
    scale = std::max(largest_norm(forces), largest_norm(loads));
    forces -= loads;
    clear_fixed(forces);
    return energy - (loads.array() * (x - body_.mesh().nodes).array()).sum();
  };
  double energy = evaluate();
  for (int i = 0; i < options.iterations; ++i) {
    if (!std::isfinite(energy)) return false;
    const double begin = largest_norm(forces);
    if (!factorise(tangent(x, c))) return false;
    if (begin <= options.tolerance * scale + rounding()) return true;
    const Matrix3Xd step = apply_inverse(-forces), start = x;
    const double slope = (forces.array() * step.array()).sum();
    bool accepted = false;
    for (double alpha = 1; alpha > 1e-4 && !accepted; alpha /= 2) {
      x = start + alpha * step;
      const double next = evaluate();
      // near convergence rounding errors exceed the changes of the energy, and the forces decide
      const double blind = rounding() * body_.extent();
      accepted = next <= energy + 1e-4 * alpha * slope ||
                 (std::abs(next - energy) <= blind && largest_norm(forces) < begin);
      if (accepted) energy = next;
    }
    if (!accepted) return false;
  }
  return false;
}

bool SolidSolver::solve(const SolidCoefficients& c, const Matrix3Xd& loads, Matrix3Xd& x,
                        const SolidOptions& options) {
  const Matrix3Xd begin = x;
  for (int steps = 1; steps <= options.load_steps; steps *= 2) {
    x = begin;
    bool converged = true;
    for (int s = 1; s <= steps && converged; ++s) {
      converged = newton(c, static_cast<double>(s) / steps * loads, x, options);
    }
    if (converged) return true;
  }
  return false;
}

Matrix3Xd SolidSolver::sensitivity(const Matrix3Xd& x, const SolidSlope& slope) {
  Matrix3Xd forces;
  body_.elements().forces(x, slope.coefficients, forces);
  return apply_inverse(slope.load.size() > 0 ? Matrix3Xd(slope.load - forces) : Matrix3Xd(-forces));
}

}  // namespace palpate::solid

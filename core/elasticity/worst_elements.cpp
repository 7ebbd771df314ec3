#include "core/elasticity/worst_elements.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <optional>

#include "core/elasticity/principal_kernel.hpp"
#include "core/math/polar.hpp"
#include "core/math/rigid.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kSmallestVolume = 0.01;  // relative to that at rest, as in StressEvaluator

Vector3d vee(const Matrix3d& m) {
  return {m(2, 1) - m(1, 2), m(0, 2) - m(2, 0), m(1, 0) - m(0, 1)};
}

/// d det F / d F.
Matrix3d cofactor(const Matrix3d& F) {
  Matrix3d c;
  c.col(0) = F.col(1).cross(F.col(2));
  c.col(1) = F.col(2).cross(F.col(0));
  c.col(2) = F.col(0).cross(F.col(1));
  return c;
}

struct PointStress {
  Matrix3d F, R, P;    // deformation gradient, its rotation, first Piola-Kirchhoff stress, Pa
  double trace_E = 0;  // trace of R^T F - I
  Matrix3d V;          // hyperelastic: principal axes of R^T F, and what follows from its stretches
  std::optional<PrincipalTangent<double>> tangent;
};

PointStress point_stress(const Matrix3d& F, const Lame& lame, const std::optional<StretchLaw>& law,
                         Eigen::Quaterniond& rotation) {
  PointStress point;
  point.F = F;
  point.R = math::polar_rotation(F, rotation);
  if (law) {
    const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(Matrix3d(point.R.transpose() * F));
    const Vector3d e = solver.eigenvalues().array() - 1;
    const PrincipalResponse<double> response(*law, lame.mu, lame.lambda, {e[0], e[1], e[2]});
    point.V = solver.eigenvectors();
    point.P = point.R * point.V *
              Vector3d(response.stress[0], response.stress[1], response.stress[2]).asDiagonal() *
              point.V.transpose();
    point.tangent.emplace(response);
    return point;
  }
  point.trace_E = point.R.cwiseProduct(F).sum() - 3;
  point.P = 2 * lame.mu * (F - point.R) + lame.lambda * point.trace_E * point.R;
  return point;
}

/// dP for dF, which is symmetric: also d(A : P) / dF for A = dF.
Matrix3d by_deformation(const Matrix3d& dF, const PointStress& point) {
  const Matrix3d U = point.R * point.V, D = U.transpose() * dF * point.V;
  const PrincipalTangent<double>& t = *point.tangent;
  Matrix3d dP;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    dP(k, k) = t.hessian[k] * D(k, k) + t.hessian[5 - j] * D(i, i) + t.hessian[5 - i] * D(j, j);
    dP(i, j) = t.same(k) * D(i, j) + t.crossed(k) * D(j, i);
    dP(j, i) = t.same(k) * D(j, i) + t.crossed(k) * D(i, j);
  }
  return U * dP * point.V.transpose();
}

/// d (A : P F^T) / d F for a constant symmetric A; linear: P = 2 mu (F - R) + lambda tr(R^T F - I)
/// R and dR = R [w]x, w = H vee(R^T dF), H = (tr(S) I - S)^-1.
Matrix3d by_deformation(const Matrix3d& A, const PointStress& point, const Lame& lame) {
  const Matrix3d C = A * point.F;
  if (point.tangent) return by_deformation(C, point) + A * point.P;
  const Vector3d turn = math::polar_spin(point.R, point.F) * vee(point.R.transpose() * C);
  const double l = lame.lambda;
  return 2 * lame.mu * C + l * C.cwiseProduct(point.R).sum() * point.R +
         (l * point.trace_E - 2 * lame.mu) * point.R * math::cross_matrix(turn) + A * point.P;
}

template <int kNodes, class Put>
void put_points(const ElementSet& elements, Put&& put) {
  constexpr int kPoints = Tetrahedron<kNodes>::kPoints;
  for (int e = 0; e < elements.element_count(); ++e) {
    const Eigen::Matrix<double, 3, 4> corners = elements.rest_corners(e);
    const double weight = tetrahedron_volume(corners) / kPoints;
    for (const auto& gradients : Tetrahedron<kNodes>::gradients(corners)) put(gradients, weight);
  }
}

}  // namespace

WorstElements::WorstElements(const Body& body, Strain strain)
    : strain_(strain), elements_((body.check(), body)) {
  const auto put = [this](const auto& gradients, double weight) {
    Point point;
    point.gradients = gradients;
    point.weight = weight;
    points_.push_back(point);
  };
  if (elements_.mesh().order == mesh::ElementOrder::kLinear) {
    put_points<4>(elements_, put);
  } else {
    put_points<10>(elements_, put);
  }
  points_per_element_ = static_cast<int>(points_.size()) / elements_.element_count();
  kept_.assign(elements_.element_count(), false);
  candidate_.by_node.setZero(3, elements_.nodes_per_element());
  for (ElementStrain& one : worst_) one = candidate_;
}

Matrix3d WorstElements::deformation(const Eigen::Matrix3Xd& x, int element,
                                    const Point& point) const noexcept {
  const auto nodes = elements_.mesh().elements.col(element);
  Matrix3d F = Matrix3d::Zero();
  const Vector3d first = x.col(nodes[0]);
  for (int a = 1; a < nodes.size(); ++a)
    F.noalias() += (x.col(nodes[a]) - first) * point.gradients.col(a).transpose();
  return F;
}

/// s = sqrt(3/2) |dev sigma| with sigma = sum_p w P F^T / V, V = sum_p w det F, so that with
/// A = ds / dsigma = 3/2 dev sigma / s:  V ds = sum_p w (A : d(P F^T) - s d det F).
void WorstElements::evaluate_stress(const Eigen::Matrix3Xd& x, ElementStrain& out) noexcept {
  const ElementMaterials& materials = elements_.materials();
  const Lame& lame = materials.lame[out.element];
  Point* points = points_of(out.element);
  std::array<PointStress, 4> at;
  Matrix3d sum = Matrix3d::Zero();
  double volume = 0, at_rest = 0;
  for (int p = 0; p < points_per_element_; ++p) {
    at[p] = point_stress(deformation(x, out.element, points[p]), lame, materials.law,
                         points[p].rotation);
    sum += points[p].weight * at[p].P * at[p].F.transpose();
    volume += points[p].weight * at[p].F.determinant();
    at_rest += points[p].weight;
  }
  const bool crushed = volume < kSmallestVolume * at_rest;
  if (crushed) volume = kSmallestVolume * at_rest;
  const Matrix3d sigma = sum / volume;
  const Matrix3d deviator = sigma - sigma.trace() / 3 * Matrix3d::Identity();
  out.value = std::sqrt(1.5) * deviator.norm();
  out.by_node.setZero();
  if (!(out.value > 1e-12 * lame.mu)) return;  // at rest, where the value has a kink
  const Matrix3d A = 1.5 / out.value * deviator;
  for (int p = 0; p < points_per_element_; ++p) {
    Matrix3d by_F = by_deformation(A, at[p], lame);
    if (!crushed) by_F -= out.value * cofactor(at[p].F);
    out.by_node.noalias() += (points[p].weight / volume * by_F).lazyProduct(points[p].gradients);
  }
}

/// d lambda_max = (R n) (n) : dF for the principal axis n of the stretch R^T F.
void WorstElements::evaluate_stretch(const Eigen::Matrix3Xd& x, ElementStrain& out) noexcept {
  Point* points = points_of(out.element);
  out.value = 0;
  for (int p = 0; p < points_per_element_; ++p) {
    const Matrix3d F = deformation(x, out.element, points[p]);
    const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(Matrix3d(F.transpose() * F));
    const double stretch = std::sqrt(std::max(0.0, solver.eigenvalues()[2]));
    if (!(stretch > out.value)) continue;
    out.value = stretch;
    const Vector3d n = solver.eigenvectors().col(2);
    out.by_node.noalias() = (F * n / stretch).lazyProduct(n.transpose() * points[p].gradients);
  }
}

void WorstElements::evaluate(const Eigen::Matrix3Xd& x, ElementStrain& out) noexcept {
  if (strain_ == Strain::kStress) {
    evaluate_stress(x, out);
  } else {
    evaluate_stretch(x, out);
  }
}

void WorstElements::take_in(const ElementStrain& candidate) noexcept {
  ElementStrain* least = &worst_[0];
  for (ElementStrain& one : worst_) {
    if (one.element < 0) {
      least = &one;
      break;
    }
    if (one.value < least->value) least = &one;
  }
  if (least->element >= 0) {
    if (!(candidate.value > least->value)) return;
    kept_[least->element] = false;
  }
  *least = candidate;
  kept_[candidate.element] = true;
}

const std::array<ElementStrain, WorstElements::kCount>& WorstElements::look(
    const Eigen::Matrix3Xd& x) noexcept {
  if (x.cols() != elements_.mesh().node_count()) return worst_;
  for (ElementStrain& one : worst_)
    if (one.element >= 0) evaluate(x, one);
  const int count = elements_.element_count();
  for (int k = 0; k < std::min(kLook, count); ++k) {
    if (!kept_[next_]) {
      candidate_.element = next_;
      evaluate(x, candidate_);
      take_in(candidate_);
    }
    next_ = (next_ + 1) % count;
  }
  return worst_;
}

double WorstElements::peak() const noexcept {
  double peak = 0;
  for (const ElementStrain& one : worst_)
    if (one.element >= 0) peak = std::max(peak, one.value);
  return peak;
}

}  // namespace palpate::elasticity

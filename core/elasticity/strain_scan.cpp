#include "core/elasticity/strain_scan.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/elasticity/element_set.hpp"

namespace palpate::elasticity {
namespace {

template <int kNodes>
void put_means(const ElementSet& elements, Eigen::Matrix3Xd& means) {
  for (int e = 0; e < elements.element_count(); ++e) {
    auto mean = means.middleCols<kNodes>(kNodes * e);
    for (const auto& gradients : Tetrahedron<kNodes>::gradients(elements.rest_corners(e)))
      mean += gradients / Tetrahedron<kNodes>::kPoints;
  }
}

}  // namespace

StrainScan::StrainScan(const Body& body) : node_count_(body.mesh.node_count()) {
  body.check();
  const ElementSet elements(body);
  elements_ = elements.mesh().elements;
  gradients_.setZero(3, elements_.size());
  if (elements.mesh().order == mesh::ElementOrder::kLinear) {
    put_means<4>(elements, gradients_);
  } else {
    put_means<10>(elements, gradients_);
  }
}

double StrainScan::strain_of(const Eigen::Matrix3Xd& x, int element) const noexcept {
  const auto nodes = elements_.col(element);
  const Eigen::Index first = nodes.size() * element;
  Eigen::Matrix3d F = Eigen::Matrix3d::Zero();
  for (Eigen::Index a = 1; a < nodes.size(); ++a)
    F.noalias() += (x.col(nodes[a]) - x.col(nodes[0])) * gradients_.col(first + a).transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(Eigen::Matrix3d(F.transpose() * F), Eigen::EigenvaluesOnly);
  const auto strain = [&solver](int i) {
    return std::abs(std::sqrt(std::max(0.0, solver.eigenvalues()[i])) - 1);
  };
  return std::max(strain(0), strain(2));
}

void StrainScan::look(const Eigen::Matrix3Xd& x) noexcept {
  if (x.cols() != node_count_) return;
  const int count = static_cast<int>(elements_.cols());
  for (int k = 0; k < std::min(kLook, count); ++k) {
    now_ = std::max(now_, strain_of(x, next_));  // one that is not a number is left out
    if (++next_ < count) continue;
    next_ = 0;
    last_ = now_;
    now_ = 0;
  }
}

void StrainScan::reset() noexcept {
  next_ = 0;
  last_ = now_ = 0;
}

}  // namespace palpate::elasticity

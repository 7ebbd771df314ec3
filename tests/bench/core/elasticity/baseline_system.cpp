#include "tests/bench/core/elasticity/baseline_system.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <set>
#include <stdexcept>

#include "core/elasticity/element.hpp"
#include "core/math/polar.hpp"
#include "core/math/rigid.hpp"

namespace palpate::bench {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// A [b]x.
Matrix3d times_cross(const Matrix3d& A, const Vector3d& b) {
  Matrix3d C;
  C.col(0) = A.col(1) * b.z() - A.col(2) * b.y();
  C.col(1) = A.col(2) * b.x() - A.col(0) * b.z();
  C.col(2) = A.col(0) * b.y() - A.col(1) * b.x();
  return C;
}

}  // namespace

void BlockRows::multiply(const Eigen::Matrix4Xd& x, Eigen::Matrix4Xd& y) const {
  for (int i = 0; i < size(); ++i) {
    Eigen::Vector4d sum = Eigen::Vector4d::Zero();
    for (int k = row_start[i]; k < row_start[i + 1]; ++k) {
      const double* v = x.col(column[k]).data();
      sum += blocks[k].col(0) * v[0] + blocks[k].col(1) * v[1] + blocks[k].col(2) * v[2];
    }
    y.col(i) = sum;
  }
}

BaselineSystem::BaselineSystem(const elasticity::Body& body)
    : elements_(body.mesh.elements), unknown_(body.mesh.node_count(), 0) {
  if (body.damping.stiffness_factor != 0) {
    throw std::invalid_argument("the baselines know no stiffness damping");
  }
  for (int i : body.fixed_nodes) unknown_[i] = -1;
  if (!body.grasps.empty()) {
    for (int i : body.grasps[0].nodes) unknown_[i] = -1;
  }
  for (int i = 0; i < body.mesh.node_count(); ++i) {
    if (unknown_[i] < 0) continue;
    unknown_[i] = size();
    node_.push_back(i);
  }
  residual_ = Eigen::Matrix4Xd::Zero(4, size());
  if (body.mesh.nodes_per_element() == 4) {
    add_rest_points<4>(body);
  } else {
    add_rest_points<10>(body);
  }
  find_pattern();
  add_mass(body);
}

template <int kNodes>
void BaselineSystem::add_rest_points(const elasticity::Body& body) {
  using Element = elasticity::Tetrahedron<kNodes>;
  points_per_element_ = Element::kPoints;
  gradients_.resize(3, elements_.cols() * Element::kPoints * kNodes);
  for (int e = 0; e < elements_.cols(); ++e) {
    Eigen::Matrix<double, 3, 4> corners;
    for (int a = 0; a < 4; ++a) corners.col(a) = body.mesh.nodes.col(elements_(a, e));
    const double volume = elasticity::tetrahedron_volume(corners);
    const elasticity::Lame lame = elasticity::lame(body.material_of(e));
    for (const auto& g : Element::gradients(corners)) {
      gradients_.middleCols<kNodes>(static_cast<int>(points_.size()) * kNodes) = g;
      points_.push_back({volume / Element::kPoints, lame.mu, lame.lambda});
    }
  }
}

void BaselineSystem::find_pattern() {
  const int n = static_cast<int>(elements_.rows());
  std::vector<std::set<int>> rows(size());
  for (int e = 0; e < elements_.cols(); ++e) {
    for (int a = 0; a < n; ++a) {
      const int i = unknown_[elements_(a, e)];
      if (i < 0) continue;
      for (int b = 0; b < n; ++b) {
        const int j = unknown_[elements_(b, e)];
        if (j >= 0) rows[i].insert(j);
      }
    }
  }
  matrix_.row_start.assign(1, 0);
  for (const auto& row : rows) {
    matrix_.column.insert(matrix_.column.end(), row.begin(), row.end());
    matrix_.row_start.push_back(static_cast<int>(matrix_.column.size()));
  }
  matrix_.blocks.assign(matrix_.column.size(), BlockRows::Block::Zero());
  const auto slot = [&](int i, int j) {
    const auto begin = matrix_.column.begin() + matrix_.row_start[i];
    const auto end = matrix_.column.begin() + matrix_.row_start[i + 1];
    return static_cast<int>(std::lower_bound(begin, end, j) - matrix_.column.begin());
  };
  for (int e = 0; e < elements_.cols(); ++e) {
    for (int a = 0; a < n; ++a) {
      for (int b = 0; b < n; ++b) {
        const int i = unknown_[elements_(a, e)], j = unknown_[elements_(b, e)];
        slots_.push_back(i < 0 || j < 0 ? -1 : slot(i, j));
      }
    }
  }
}

void BaselineSystem::add_mass(const elasticity::Body& body) {
  const int n = static_cast<int>(elements_.rows());
  const Eigen::MatrixXd shares = n == 4
                                     ? Eigen::MatrixXd(elasticity::Tetrahedron<4>::mass_shares())
                                     : Eigen::MatrixXd(elasticity::Tetrahedron<10>::mass_shares());
  masses_.assign(matrix_.column.size(), 0);
  // Prescribed nodes move too, and drag their neighbours' mass along.
  std::vector<std::vector<std::pair<int, double>>> rows(size());
  for (int e = 0; e < elements_.cols(); ++e) {
    const double mass =
        body.material_of(e).density * points_[e * points_per_element_].weight * points_per_element_;
    for (int a = 0; a < n; ++a) {
      const int i = unknown_[elements_(a, e)];
      for (int b = 0; b < n; ++b) {
        const int slot = slots_[(e * n + a) * n + b];
        if (slot >= 0) masses_[slot] += mass * shares(a, b);
        if (i >= 0) rows[i].emplace_back(elements_(b, e), mass * shares(a, b));
      }
    }
  }
  mass_start_.assign(1, 0);
  for (auto& row : rows) {
    std::sort(row.begin(), row.end());
    for (std::size_t k = 0; k < row.size(); ++k) {
      const bool is_same = k > 0 && row[k].first == row[k - 1].first;
      if (!is_same) {
        mass_column_.push_back(row[k].first);
        mass_.push_back(0);
      }
      mass_.back() += row[k].second;
    }
    mass_start_.push_back(static_cast<int>(mass_column_.size()));
  }
}

template <int kNodes>
void BaselineSystem::add_elements(const Matrix3Xd& x) {
  for (int e = 0, p = 0; e < elements_.cols(); ++e) {
    Eigen::Matrix<double, 3, kNodes> local, forces;
    for (int a = 0; a < kNodes; ++a) {
      local.col(a) = x.col(elements_(a, e)) - x.col(elements_(0, e));
    }
    forces.setZero();
    std::array<Matrix3d, kNodes*(kNodes + 1) / 2> upper;
    for (Matrix3d& block : upper) block.setZero();
    for (int q = 0; q < points_per_element_; ++q, ++p) {
      Point& point = points_[p];
      const auto g = gradients_.middleCols<kNodes>(p * kNodes);
      Matrix3d F = local.col(1) * g.col(1).transpose();
      for (int a = 2; a < kNodes; ++a) F.noalias() += local.col(a) * g.col(a).transpose();
      const Matrix3d R = math::polar_rotation(F, point.rotation);
      const double stretch = R.cwiseProduct(F).sum() - 3;
      const double mu = point.weight * point.mu, lambda = point.weight * point.lambda;
      const Matrix3d P = 2 * mu * (F - R) + lambda * stretch * R;
      const Matrix3d twist = (2 * mu - lambda * stretch) * R *
                             math::polar_spin(R, F).selfadjointView<Eigen::Upper>() * R.transpose();
      Eigen::Matrix<double, 3, kNodes> h;
      h.noalias() = R * g;
      forces.noalias() += P * g;
      for (int a = 0, k = 0; a < kNodes; ++a) {
        const Matrix3d turned = math::cross_matrix(h.col(a)) * twist;
        for (int b = a; b < kNodes; ++b, ++k) {
          Matrix3d& block = upper[k];
          block += times_cross(turned, h.col(b));
          block.noalias() += (lambda * h.col(a)) * h.col(b).transpose();
          block.diagonal().array() += 2 * mu * g.col(a).dot(g.col(b));
        }
      }
    }
    for (int a = 0, k = 0; a < kNodes; ++a) {
      const int i = unknown_[elements_(a, e)];
      if (i >= 0) residual_.col(i).template head<3>() += forces.col(a);
      for (int b = a; b < kNodes; ++b, ++k) {
        const int slot = slots_[(e * kNodes + a) * kNodes + b];
        if (slot < 0) continue;
        matrix_.blocks[slot].template topRows<3>() += upper[k];
        if (a != b) {
          matrix_.blocks[slots_[(e * kNodes + b) * kNodes + a]].template topRows<3>() +=
              upper[k].transpose();
        }
      }
    }
  }
}

void BaselineSystem::assemble(const Matrix3Xd& x, const Matrix3Xd& x_inertial,
                              const Matrix3Xd& loads, double inertia) {
  for (std::size_t k = 0; k < matrix_.blocks.size(); ++k) {
    matrix_.blocks[k].setZero();
    matrix_.blocks[k].diagonal().setConstant(inertia * masses_[k]);
  }
  for (int i = 0; i < size(); ++i) {
    Vector3d force = -loads.col(node_[i]);
    if (inertia > 0) {
      Vector3d sum = Vector3d::Zero();
      for (int k = mass_start_[i]; k < mass_start_[i + 1]; ++k) {
        sum += mass_[k] * (x.col(mass_column_[k]) - x_inertial.col(mass_column_[k]));
      }
      force += inertia * sum;
    }
    residual_.col(i) << force, 0;
  }
  if (elements_.rows() == 4) {
    add_elements<4>(x);
  } else {
    add_elements<10>(x);
  }
}

int BaselineSystem::inverted(const Matrix3Xd& x) const {
  const int n = static_cast<int>(elements_.rows());
  int count = 0;
  for (std::size_t p = 0; p < points_.size(); ++p) {
    const int e = static_cast<int>(p) / points_per_element_;
    Matrix3d F = Matrix3d::Zero();
    for (int a = 0; a < n; ++a) {
      F += x.col(elements_(a, e)) * gradients_.col(static_cast<int>(p) * n + a).transpose();
    }
    count += !(F.determinant() > 0);
  }
  return count;
}

}  // namespace palpate::bench

#include "tests/bench/core/elasticity/baseline_system.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>

#include "core/elasticity/element.hpp"

namespace palpate::bench {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr int kLanes = 4;

LaneVector cross(const LaneVector& a, const LaneVector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Lanes dot(const LaneVector& a, const LaneVector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

LaneVector times(const LaneMatrix& A, const LaneVector& b) {
  return {dot(A[0], b), dot(A[1], b), dot(A[2], b)};
}

/// Nodes of four elements relative to their first one. After the last element it is repeated.
template <int kNodes>
std::array<LaneVector, kNodes> gather(const Eigen::MatrixXi& elements, int first,
                                      const Matrix3Xd& x) {
  std::array<LaneVector, kNodes> local;
  for (int l = 0; l < kLanes; ++l) {
    const int e = std::min(first + l, static_cast<int>(elements.cols()) - 1);
    const Vector3d origin = x.col(elements(0, e));
    for (int a = 0; a < kNodes; ++a) {
      const Vector3d p = x.col(elements(a, e)) - origin;
      for (int i = 0; i < 3; ++i) local[a][i][l] = p(i);
    }
  }
  return local;
}

template <int kNodes>
LaneMatrix deformation(const std::array<LaneVector, kNodes>& local,
                       const std::array<LaneVector, kNodes>& gradients) {
  LaneMatrix F{};
  for (int a = 1; a < kNodes; ++a) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) F[i][j] += local[a][i] * gradients[a][j];
    }
  }
  return F;
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
    add_rest_points<4>(body, linear_);
  } else {
    add_rest_points<10>(body, quadratic_);
  }
  find_pattern();
  add_mass(body);
}

template <int kNodes>
void BaselineSystem::add_rest_points(const elasticity::Body& body, Points<kNodes>& points) {
  using Element = elasticity::Tetrahedron<kNodes>;
  const auto count = static_cast<int>(elements_.cols());
  for (int first = 0; first < count; first += kLanes) {
    std::array<LanePoint<kNodes>, Element::kPoints> group;
    for (int l = 0; l < kLanes; ++l) {
      const int e = std::min(first + l, count - 1);
      Eigen::Matrix<double, 3, 4> corners;
      for (int a = 0; a < 4; ++a) corners.col(a) = body.mesh.nodes.col(elements_(a, e));
      const double weight = elasticity::tetrahedron_volume(corners) / Element::kPoints;
      const elasticity::Lame lame = elasticity::lame(body.material_of(e));
      const auto gradients = Element::gradients(corners);
      for (int q = 0; q < Element::kPoints; ++q) {
        for (int a = 0; a < kNodes; ++a) {
          for (int i = 0; i < 3; ++i) group[q].gradients[a][i][l] = gradients[q](i, a);
        }
        group[q].mu[l] = weight * lame.mu;
        group[q].lambda[l] = weight * lame.lambda;
        group[q].rotation[0][l] = 1;
      }
    }
    points.insert(points.end(), group.begin(), group.end());
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
  // Prescribed nodes move too, and contribute inertia to their neighbours.
  std::vector<std::vector<std::pair<int, double>>> rows(size());
  for (int e = 0; e < elements_.cols(); ++e) {
    Eigen::Matrix<double, 3, 4> corners;
    for (int a = 0; a < 4; ++a) corners.col(a) = body.mesh.nodes.col(elements_(a, e));
    const double mass = body.material_of(e).density * elasticity::tetrahedron_volume(corners);
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
void BaselineSystem::add_elements(const Matrix3Xd& x, Points<kNodes>& points) {
  constexpr int kPoints = elasticity::Tetrahedron<kNodes>::kPoints;
  const auto count = static_cast<int>(elements_.cols());
  auto point = points.begin();
  for (int first = 0; first < count; first += kLanes) {
    const auto local = gather<kNodes>(elements_, first, x);
    std::array<LaneVector, kNodes> forces{};
    std::array<LaneMatrix, kNodes*(kNodes + 1) / 2> upper{};
    for (int q = 0; q < kPoints; ++q, ++point) {
      const auto& g = point->gradients;
      const LaneResponse r =
          respond(deformation<kNodes>(local, g), point->mu, point->lambda, point->rotation);
      std::array<LaneVector, kNodes> h;
      for (int a = 0; a < kNodes; ++a) {
        h[a] = times(r.rotation, g[a]);
        for (int i = 0; i < 3; ++i) forces[a][i] += dot(r.stress[i], g[a]);
      }
      // K_ab = (g_a . g_b) 2 mu I + lambda h_a h_b^T + [h_a]x twist [h_b]x
      for (int a = 0, k = 0; a < kNodes; ++a) {
        LaneMatrix turned;  // columns of twist [.]x turned by [h_a]x; twist is symmetric
        for (int j = 0; j < 3; ++j) turned[j] = cross(h[a], r.twist[j]);
        for (int b = a; b < kNodes; ++b, ++k) {
          const Lanes direct = 2 * point->mu * dot(g[a], g[b]);
          for (int i = 0; i < 3; ++i) {
            // Row i of ([h_a]x twist) times [h_b]x is -(h_b x row), reversed: row x h_b.
            const LaneVector row = cross({turned[0][i], turned[1][i], turned[2][i]}, h[b]);
            const Lanes along = point->lambda * h[a][i];
            for (int j = 0; j < 3; ++j) upper[k][i][j] += along * h[b][j] + row[j];
            upper[k][i][i] += direct;
          }
        }
      }
    }
    for (int l = 0; l < std::min(kLanes, count - first); ++l) {
      const int e = first + l;
      const int* slots = &slots_[static_cast<std::size_t>(e) * kNodes * kNodes];
      for (int a = 0, k = 0; a < kNodes; ++a) {
        const int u = unknown_[elements_(a, e)];
        for (int i = 0; u >= 0 && i < 3; ++i) residual_(i, u) += forces[a][i][l];
        for (int b = a; b < kNodes; ++b, ++k) {
          if (slots[a * kNodes + b] < 0) continue;
          BlockRows::Block& block = matrix_.blocks[slots[a * kNodes + b]];
          BlockRows::Block& mirrored = matrix_.blocks[slots[b * kNodes + a]];
          for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
              block(i, j) += upper[k][i][j][l];
              if (a != b) mirrored(j, i) += upper[k][i][j][l];
            }
          }
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
    add_elements<4>(x, linear_);
  } else {
    add_elements<10>(x, quadratic_);
  }
}

template <int kNodes>
int BaselineSystem::count_inverted(const Matrix3Xd& x, const Points<kNodes>& points) const {
  constexpr int kPoints = elasticity::Tetrahedron<kNodes>::kPoints;
  const auto elements = static_cast<int>(elements_.cols());
  int count = 0;
  auto point = points.begin();
  for (int first = 0; first < elements; first += kLanes) {
    const auto local = gather<kNodes>(elements_, first, x);
    for (int q = 0; q < kPoints; ++q, ++point) {
      const LaneMatrix F = deformation<kNodes>(local, point->gradients);
      const Lanes determinant = dot(F[0], cross(F[1], F[2]));
      for (int l = 0; l < std::min(kLanes, elements - first); ++l) count += !(determinant[l] > 0);
    }
  }
  return count;
}

int BaselineSystem::inverted(const Matrix3Xd& x) const {
  return elements_.rows() == 4 ? count_inverted<4>(x, linear_) : count_inverted<10>(x, quadratic_);
}

}  // namespace palpate::bench

#include "core/solid/solid_membrane.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "core/solid/solid_quadrilateral.hpp"

namespace palpate::solid {

using Eigen::Matrix2d;
using Eigen::Matrix4d;
using Eigen::Vector2d;
using Eigen::Vector4d;
using Eigen::VectorXd;

namespace {

Vector4d flattened(const Matrix2d& m) { return Eigen::Map<const Vector4d>(m.data()); }

/// Foundation traction per area of a membrane displaced by u.
struct Hold {
  Hold(const Vector2d& u, const MembraneVector& p) {
    const double grip = p[kGrip], q = u.squaredNorm() / (grip * grip);
    const double share = 1 / std::sqrt(1 + q), cube = share * share * share;
    energy = p[kFoundation] * u.squaredNorm() * share / (1 + share);
    pressure = p[kFoundation] * share * u;
    tangent = -p[kFoundation] * cube / (grip * grip) * u * u.transpose();
    tangent.diagonal().array() += p[kFoundation] * share;
    by_grip = p[kFoundation] * cube * q / grip * u;
  }
  double energy;
  Vector2d pressure, by_grip;
  Matrix2d tangent;
};

}  // namespace

bool membrane_response(const Matrix2d& F, const MembraneVector& p, MembraneResponse& response) {
  const double J = F.determinant(), shear = p[kShear], b = p[kStiffening];
  if (!(J > 0)) return false;
  const Matrix2d G = F.inverse().transpose();
  const double squeeze = 1 / (J * J), strain = F.squaredNorm() + squeeze - 3;
  if (!(b * strain < 50)) return false;
  const double first = shear / 2 * std::exp(b * strain);
  const Matrix2d Q = 2 * (F - squeeze * G);
  response.energy = b > 1e-9 ? shear / (2 * b) * std::expm1(b * strain) : shear / 2 * strain;
  response.stress = first * Q;
  Matrix4d slope = 4 * squeeze * flattened(G) * flattened(G).transpose();
  slope.diagonal().array() += 2;
  for (int k = 0; k < 2; ++k) {
    for (int l = 0; l < 2; ++l) {
      // -d(F^-T) = F^-T dF^T F^-T
      slope.block<2, 2>(2 * k, 2 * l) += 2 * squeeze * G.col(l) * G.col(k).transpose();
    }
  }
  response.tangent = first * slope + first * b * flattened(Q) * flattened(Q).transpose();
  response.by_parameter.setZero();
  response.by_parameter.col(kShear) = flattened(response.stress) / shear;
  response.by_parameter.col(kStiffening) = strain * flattened(response.stress);

  const Vector2d a(std::cos(p[kAngle]), std::sin(p[kAngle])), across(-a.y(), a.x());
  const Vector2d Fa = F * a;
  const double fibre = p[kFibre], excess = Fa.squaredNorm() - 1;
  response.energy += fibre / 8 * excess * excess;
  const Matrix2d pull = excess / 2 * Fa * a.transpose();
  response.stress += fibre * pull;
  for (int k = 0; k < 2; ++k) {
    for (int l = 0; l < 2; ++l) {
      Matrix2d block = Fa * Fa.transpose();
      block.diagonal().array() += excess / 2;
      response.tangent.block<2, 2>(2 * k, 2 * l) += fibre * a[k] * a[l] * block;
    }
  }
  response.by_parameter.col(kFibre) = flattened(pull);
  const Matrix2d turn = Fa.dot(F * across) * Fa * a.transpose() +
                        excess / 2 * (F * across * a.transpose() + Fa * across.transpose());
  response.by_parameter.col(kAngle) = fibre * flattened(turn);
  return true;
}

/// Equations over the unknowns; forces of all coordinates.
struct SolidMembrane::System {
  VectorXd forces;
  std::vector<Eigen::Triplet<double>> tangent, border;  // border: rows of prescribed coordinates
  Eigen::Matrix<double, Eigen::Dynamic, kMembraneParameters> by_parameter;
};

SolidMembrane::SolidMembrane(std::vector<double> x, std::vector<double> y,
                             std::vector<Rectangle> pads)
    : x_(std::move(x)), y_(std::move(y)), pad_count_(static_cast<int>(pads.size())) {
  const auto rises = [](const std::vector<double>& lines) {
    return lines.size() >= 2 &&
           std::adjacent_find(lines.begin(), lines.end(), std::greater_equal<>()) == lines.end();
  };
  if (!rises(x_) || !rises(y_)) {
    throw std::invalid_argument("a membrane needs at least two rising lines along each axis");
  }
  const int columns = static_cast<int>(x_.size()) - 1, rows = static_cast<int>(y_.size()) - 1;
  across_ = 2 * columns + 1;
  const int up = 2 * rows + 1;
  rest_.resize(2, across_ * up);
  unknown_.assign(rest_.size(), -1);
  pad_.assign(rest_.cols(), -1);
  const auto at = [](const std::vector<double>& lines, int k) {
    return k % 2 == 0 ? lines[k / 2] : 0.5 * (lines[k / 2] + lines[k / 2 + 1]);
  };
  for (int j = 0; j < up; ++j) {
    for (int i = 0; i < across_; ++i) {
      const int node = i + across_ * j;
      rest_.col(node) << at(x_, i), at(y_, j);
      for (int k = 0; k < pad_count_; ++k) {
        const Eigen::Array2d p = rest_.col(node);
        if ((p > pads[k].least.array() - 1e-9).all() &&
            (p < pads[k].greatest.array() + 1e-9).all()) {
          pad_[node] = k;
        }
      }
      if (pad_[node] >= 0 || i == 0 || j == 0 || i == across_ - 1 || j == up - 1) continue;
      unknown_[2 * node] = size_++;
      unknown_[2 * node + 1] = size_++;
    }
  }
  if (size_ == 0) throw std::invalid_argument("a membrane needs nodes that are free");
  for (int e = 0; e < columns * rows; ++e) {
    Element element;
    const int i = e % columns, j = e / columns;
    const double width = x_[i + 1] - x_[i], height = y_[j + 1] - y_[j];
    for (int a = 0; a < 9; ++a) {
      element.nodes[a] = 2 * i + a % 3 + across_ * (2 * j + a / 3);
    }
    for (int k = 0; k < 9; ++k) {
      const double s = kGaussPoints[k % 3], t = kGaussPoints[k / 3];
      const auto ns = line_shape(s), nt = line_shape(t), ds = line_slope(s), dt = line_slope(t);
      Point& point = element.points[k];
      point.area = width * height / 4 * kGaussWeights[k % 3] * kGaussWeights[k / 3];
      point.strain.setZero();
      for (int a = 0; a < 9; ++a) {
        point.shape[a] = ns[a % 3] * nt[a / 3];
        const double by_x = ds[a % 3] * nt[a / 3] * 2 / width;
        const double by_y = ns[a % 3] * dt[a / 3] * 2 / height;
        point.strain(0, 2 * a) = point.strain(1, 2 * a + 1) = by_x;
        point.strain(2, 2 * a) = point.strain(3, 2 * a + 1) = by_y;
      }
    }
    elements_.push_back(element);
  }
}

double SolidMembrane::evaluate(const VectorXd& u, const MembraneVector& p, System& system,
                               bool with_tangent, bool with_slopes) const {
  double energy = 0;
  system.forces.setZero(u.size());
  system.tangent.clear();
  system.border.clear();
  if (with_slopes) system.by_parameter.setZero(u.size(), kMembraneParameters);
  MembraneResponse response;
  for (const Element& element : elements_) {
    Eigen::Matrix<double, 18, 1> local, f = decltype(f)::Zero();
    Eigen::Matrix<double, 18, 18> K = decltype(K)::Zero();
    Eigen::Matrix<double, 18, kMembraneParameters> by = decltype(by)::Zero();
    for (int a = 0; a < 9; ++a) local.segment<2>(2 * a) = u.segment<2>(2 * element.nodes[a]);
    for (const Point& point : element.points) {
      const Vector4d gradient = point.strain * local;
      const Matrix2d F = Matrix2d::Identity() + Eigen::Map<const Matrix2d>(gradient.data());
      if (!membrane_response(F, p, response)) return std::numeric_limits<double>::infinity();
      Vector2d moved = Vector2d::Zero();
      for (int a = 0; a < 9; ++a) moved += point.shape[a] * local.segment<2>(2 * a);
      const Hold hold(moved, p);
      energy += point.area * (response.energy + hold.energy);
      f += point.area * point.strain.transpose() * flattened(response.stress);
      for (int a = 0; a < 9; ++a) {
        const double share = point.area * point.shape[a];
        f.segment<2>(2 * a) += share * hold.pressure;
        by.col(kFoundation).segment<2>(2 * a) += share / p[kFoundation] * hold.pressure;
        by.col(kGrip).segment<2>(2 * a) += share * hold.by_grip;
        if (!with_tangent) continue;
        for (int b = 0; b < 9; ++b) {
          K.block<2, 2>(2 * a, 2 * b) += share * point.shape[b] * hold.tangent;
        }
      }
      if (with_slopes) by += point.area * point.strain.transpose() * response.by_parameter;
      if (with_tangent) {
        K.noalias() += point.area * point.strain.transpose() * (response.tangent * point.strain);
      }
    }
    for (int a = 0; a < 18; ++a) {
      const int row = 2 * element.nodes[a / 2] + a % 2, k = unknown_[row];
      system.forces[row] += f[a];
      if (with_slopes) system.by_parameter.row(row) += by.row(a);
      for (int b = 0; with_tangent && b < 18; ++b) {
        const int l = unknown_[2 * element.nodes[b / 2] + b % 2];
        if (l < 0) continue;
        if (k >= l) system.tangent.emplace_back(k, l, K(a, b));
        if (k < 0 && pad_[row / 2] >= 0) system.border.emplace_back(row, l, K(a, b));
      }
    }
  }
  return energy;
}

bool SolidMembrane::solve(const MembraneVector& p, const std::vector<Vector2d>& motions,
                          State& state, bool with_slopes) const {
  const VectorXd begin = state.u.size() > 0 ? state.u : VectorXd::Zero(rest_.size());
  std::vector<Vector2d> from(motions.size(), Vector2d::Zero());
  for (int node = 0; node < node_count(); ++node) {
    if (pad_[node] >= 0) from.at(pad_[node]) = begin.segment<2>(2 * node);
  }
  for (int steps = 1; steps <= 16; steps *= 2) {
    state.u = begin;
    bool converged = true;
    for (int k = 1; k <= steps && converged; ++k) {
      std::vector<Vector2d> now = motions;
      for (std::size_t pad = 0; pad < now.size(); ++pad) {
        now[pad] = from[pad] + (motions[pad] - from[pad]) * k / steps;
      }
      converged = press_on(p, now, state, with_slopes && k == steps);
    }
    if (converged) return true;
  }
  return false;
}

bool SolidMembrane::press_on(const MembraneVector& p, const std::vector<Vector2d>& motions,
                             State& state, bool with_slopes) const {
  VectorXd& u = state.u;
  for (int node = 0; node < node_count(); ++node) {
    if (pad_[node] >= 0) u.segment<2>(2 * node) = motions.at(pad_[node]);
  }
  System system;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor;
  Eigen::SparseMatrix<double> K(size_, size_);
  const auto gathered = [&] {
    VectorXd r(size_);
    for (std::size_t c = 0; c < unknown_.size(); ++c) {
      if (unknown_[c] >= 0) r[unknown_[c]] = system.forces[c];
    }
    return r;
  };
  const auto moved = [&](const VectorXd& from, const VectorXd& step, double alpha) {
    VectorXd to = from;
    for (std::size_t c = 0; c < unknown_.size(); ++c) {
      if (unknown_[c] >= 0) to[c] += alpha * step[unknown_[c]];
    }
    return to;
  };
  // J; at small strain the energy is a small difference of large numbers, and rounding errors
  // exceed decreases below this; the forces decide then
  const double blind = 1e-14 * p[kShear] * (x_.back() - x_.front()) * (y_.back() - y_.front());
  bool converged = false;
  for (int iteration = 0; iteration < 60 && !converged; ++iteration) {
    const double energy = evaluate(u, p, system, true, with_slopes);
    if (!std::isfinite(energy)) return false;
    K.setFromTriplets(system.tangent.begin(), system.tangent.end());
    if (iteration == 0) factor.analyzePattern(K);
    factor.factorize(K);
    if (factor.info() != Eigen::Success || (factor.vectorD().array() <= 0).any()) return false;
    const VectorXd r = gathered();
    const double imbalance = r.cwiseAbs().maxCoeff();
    converged = imbalance <= 1e-11 * system.forces.cwiseAbs().maxCoeff();
    if (converged) break;
    const VectorXd step = factor.solve(-r), from = u;
    const double descent = r.dot(step);
    bool accepted = false;
    for (double alpha = 1; alpha > 1e-4 && !accepted; alpha /= 2) {
      u = moved(from, step, alpha);
      const double next = evaluate(u, p, system, false, false);
      accepted = next <= energy + 1e-4 * alpha * descent ||
                 (std::isfinite(next) && std::abs(descent) < 1e-10 * std::abs(energy) + blind &&
                  gathered().cwiseAbs().maxCoeff() < imbalance);
    }
    if (!accepted) {
      // converged to rounding accuracy
      u = from;
      evaluate(u, p, system, true, with_slopes);
      if (imbalance > 1e-8 * system.forces.cwiseAbs().maxCoeff()) return false;
      converged = true;
    }
  }
  if (!converged) return false;
  Eigen::Matrix<double, Eigen::Dynamic, kMembraneParameters> reaction = system.by_parameter;
  if (with_slopes) {
    Eigen::MatrixXd rhs(size_, static_cast<int>(kMembraneParameters));
    for (std::size_t c = 0; c < unknown_.size(); ++c) {
      if (unknown_[c] >= 0) {
        rhs.row(unknown_[c]) = -system.by_parameter.row(static_cast<Eigen::Index>(c));
      }
    }
    const Eigen::MatrixXd by = factor.solve(rhs);
    state.slopes.setZero(u.size(), kMembraneParameters);
    for (std::size_t c = 0; c < unknown_.size(); ++c) {
      if (unknown_[c] >= 0) state.slopes.row(static_cast<Eigen::Index>(c)) = by.row(unknown_[c]);
    }
    for (const auto& entry : system.border) {
      reaction.row(entry.row()) += entry.value() * by.row(entry.col());
    }
  }
  state.forces.assign(pad_count_, Vector2d::Zero());
  state.force_slopes.assign(pad_count_, decltype(state.force_slopes)::value_type::Zero());
  for (int node = 0; node < node_count(); ++node) {
    if (pad_[node] < 0) continue;
    state.forces[pad_[node]] += system.forces.segment<2>(2 * node);
    if (with_slopes) state.force_slopes[pad_[node]] += reaction.middleRows<2>(2 * node);
  }
  return true;
}

SolidMembrane::Place SolidMembrane::locate(const Vector2d& point) const {
  const auto cell = [](const std::vector<double>& lines, double at) {
    if (!(at >= lines.front() && at <= lines.back())) {
      throw std::invalid_argument("a point lies outside of the membrane");
    }
    const auto above = std::upper_bound(lines.begin() + 1, lines.end() - 1, at);
    return static_cast<int>(above - lines.begin()) - 1;
  };
  const int i = cell(x_, point.x()), j = cell(y_, point.y());
  const auto ns = line_shape(2 * (point.x() - x_[i]) / (x_[i + 1] - x_[i]) - 1);
  const auto nt = line_shape(2 * (point.y() - y_[j]) / (y_[j + 1] - y_[j]) - 1);
  Place place;
  place.nodes = elements_[i + j * (x_.size() - 1)].nodes;
  for (int a = 0; a < 9; ++a) place.weights[a] = ns[a % 3] * nt[a / 3];
  return place;
}

}  // namespace palpate::solid

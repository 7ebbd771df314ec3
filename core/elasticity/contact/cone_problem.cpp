#include "core/elasticity/contact/cone_problem.hpp"

#include <Eigen/LU>
#include <algorithm>

namespace palpate::elasticity {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// The larger eigenvalue of a point's tangential block lies between half its trace and its trace; a
// projection with this share of the trace converges for all of them.
constexpr double kTangentialShare = 0.6;

}  // namespace

ConeProblem::ConeProblem(int most)
    : compliance_(3 * most, 3 * most),
      displacement_(3 * most),
      displacement_before_(3 * most),
      before_(3 * most),
      direction_(3 * most),
      along_(3 * most),
      blocks_(most) {
  gathered_.reserve(most);
}

/// Copies what the sweeps need, so that it stays in the cache.
void ConeProblem::gather(const ComplianceColumns& table,
                         const std::vector<ConePoint>& points) noexcept {
  const int count = static_cast<int>(points.size());
  size_ = 3 * count;
  displacement_.head(size_).setZero();
  const bool is_held =
      std::equal(points.begin(), points.end(), gathered_.begin(), gathered_.end(),
                 [](const ConePoint& point, int place) { return point.place == place; });
  if (!is_held) {
    gathered_.clear();
    for (int k = 0; k < count; ++k) {
      gathered_.push_back(points[k].place);
      const auto column = table.among(points[k].place);
      for (int other = 0; other < count; ++other) {
        compliance_.block<3, 3>(3 * other, 3 * k) = column.middleRows<3>(3 * points[other].place);
      }
      blocks_[k].own = table.own(points[k].place).cast<double>();
      blocks_[k].inverse = blocks_[k].own.inverse();
    }
  }
  for (int k = 0; k < count; ++k) {
    Block& block = blocks_[k];
    block.normal = points[k].normal.dot(block.own * points[k].normal);
    block.tangential = kTangentialShare * std::max(block.own.trace() - block.normal, 0.0);
  }
}

/// Force of a point that cannot stick: `error` is gap and slip under its force. Projects the normal
/// force, then, with what that has changed, the tangential one.
Vector3d ConeProblem::slide(const ConePoint& point, const Block& block, Vector3d error) noexcept {
  const Vector3d& n = point.normal;
  const double before = n.dot(point.force);
  const double r_n = std::max(0.0, before - n.dot(error) / block.normal);
  if (r_n == 0) return Vector3d::Zero();
  if (point.friction == 0) return r_n * n;
  error += (r_n - before) * (block.own * n);
  Vector3d r_t = point.force - before * n;
  if (block.tangential > 0) r_t -= (error - n.dot(error) * n) / block.tangential;
  const double size = r_t.norm(), most = point.friction * r_n;
  if (size > most) r_t *= most / size;
  return r_n * n + r_t;
}

/// Solves the law of one point; returns the displacement that it causes there, m.
double ConeProblem::relax(int k, ConePoint& point) noexcept {
  const Vector3d& n = point.normal;
  const Vector3d error = point.offset + displacement_.segment<3>(3 * k).cast<double>();
  if (point.force.isZero(0) && n.dot(error) >= 0) return 0;
  const Block& block = blocks_[k];
  Vector3d next = point.force - block.inverse * error;
  const double r_n = n.dot(next), most = point.friction * r_n;
  if (!(r_n > 0 && (next - r_n * n).squaredNorm() <= most * most)) {
    next = slide(point, block, error);
  }
  const Vector3d change = next - point.force;
  if (change.isZero(0)) return 0;
  point.force = next;
  const Eigen::Vector3f by = change.cast<float>();
  displacement_.head(size_) += compliance_.col(3 * k).head(size_) * by[0] +
                               compliance_.col(3 * k + 1).head(size_) * by[1] +
                               compliance_.col(3 * k + 2).head(size_) * by[2];
  return (block.own * change).norm();
}

/// One sweep over all points, to or fro; returns the largest displacement by a change of force, m.
double ConeProblem::sweep(std::vector<ConePoint>& points, bool forward) noexcept {
  const int count = static_cast<int>(points.size());
  double largest = 0;
  for (int i = 0; i < count; ++i) {
    const int k = forward ? i : count - 1 - i;
    largest = std::max(largest, relax(k, points[k]));
  }
  return largest;
}

int ConeProblem::solve(const ComplianceColumns& table, const ConeOptions& options,
                       std::vector<ConePoint>& points) noexcept {
  gather(table, points);
  const int count = static_cast<int>(points.size());
  double last_size = 0;
  for (int k = 0; k < options.sweeps; ++k) {
    for (int i = 0; i < count; ++i) before_.segment<3>(3 * i) = points[i].force;
    displacement_before_.head(size_) = displacement_.head(size_);
    const double largest = sweep(points, k % 2 == 0);
    if (!(largest > options.tolerance) || k + 1 == options.sweeps) return k + 1;

    double size = 0;
    for (int i = 0; i < count; ++i) {
      const Vector3d change = points[i].force - before_.segment<3>(3 * i);
      before_.segment<3>(3 * i) = change;
      size += change.dot(blocks_[i].own * change);
    }
    displacement_before_.head(size_) = displacement_.head(size_) - displacement_before_.head(size_);
    const double share = last_size > 0 ? size / last_size : 2;
    last_size = size;
    if (share > 1) {
      direction_.head(size_) = before_.head(size_);
      along_.head(size_) = displacement_before_.head(size_);
      continue;
    }
    // change + share * last direction
    for (int i = 0; i < count; ++i) points[i].force += share * direction_.segment<3>(3 * i);
    displacement_.head(size_) += static_cast<float>(share) * along_.head(size_);
    direction_.head(size_) = share * direction_.head(size_) + before_.head(size_);
    along_.head(size_) =
        static_cast<float>(share) * along_.head(size_) + displacement_before_.head(size_);
  }
  return options.sweeps;
}

}  // namespace palpate::elasticity

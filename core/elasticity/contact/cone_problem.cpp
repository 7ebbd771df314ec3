#include "core/elasticity/contact/cone_problem.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/math/constants.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// The larger eigenvalue of a point's tangential block lies between half its trace and its trace; a
// projection with this share of the trace converges for all of them.
constexpr double kTangentialShare = 0.6;
// Friction times coupling above which projections in turn converge slowly, or, above 1, not at all.
constexpr double kStrongCoupling = 0.8;
constexpr int kDirections = 16;   // in which the direction of slip is sought
constexpr int kRefinements = 12;  // of a direction: to rounding

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
    const Vector3d motion = block.own * points[k].normal;
    block.coupling = (motion - block.normal * points[k].normal).norm() / block.normal;
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

/// The same, by the direction u of slip: with force r_n (n - friction u) and no gap, the slip is
/// along u. `force` is unchanged, and false returned, if no direction is found.
bool ConeProblem::slide_exactly(const ConePoint& point, const Block& block, const Vector3d& error,
                                Vector3d& force) noexcept {
  const Vector3d& n = point.normal;
  const Vector3d alone = error - block.own * point.force;  // gap and slip without this force
  const double closing = -n.dot(alone);
  if (closing <= 0) {
    force.setZero();
    return true;
  }
  const Vector3d t1 = n.unitOrthogonal(), t2 = n.cross(t1);
  const Vector3d by_normal = block.own * n;
  struct Slip {
    Vector3d u;
    double share;          // m/N, gap by a normal force with its friction
    double across, along;  // m^2/N, slip times share, across u and along it
  };
  const auto slip = [&](double angle) {
    Slip s;
    s.u = std::cos(angle) * t1 + std::sin(angle) * t2;
    const Vector3d by_force = by_normal - point.friction * (block.own * s.u);
    s.share = n.dot(by_force);
    const Vector3d way = s.share * alone + closing * by_force;
    s.across = n.cross(s.u).dot(way);
    s.along = s.u.dot(way);
    return s;
  };
  const auto accept = [&](const Slip& s) {
    if (!(s.share > 0 && s.along >= 0)) return false;
    force = closing / s.share * (n - point.friction * s.u);
    return true;
  };
  // From the last direction on: of several solutions the nearest.
  const double begin = std::atan2(-point.force.dot(t2), -point.force.dot(t1));
  constexpr double kStep = 2 * math::kPi / kDirections;
  for (int i = 0; i < kDirections; ++i) {
    const int away = (i + 1) / 2;
    double from = begin + kStep * (i % 2 == 0 ? away : -away) - 0.5 * kStep, to = from + kStep;
    Slip a = slip(from), b = slip(to);
    if (!(a.across > 0) == !(b.across > 0)) continue;
    for (int k = 0; k < kRefinements && a.across != 0; ++k) {
      const double at =
          k % 3 == 2 ? 0.5 * (from + to) : from + (to - from) * a.across / (a.across - b.across);
      const Slip next = slip(at);
      const bool is_behind = !(next.across > 0) == !(a.across > 0);
      (is_behind ? from : to) = at;
      (is_behind ? a : b) = next;
    }
    if (accept(std::abs(a.across) < std::abs(b.across) ? a : b)) return true;
  }
  return false;
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
    if (!(point.friction * block.coupling > kStrongCoupling) ||
        !slide_exactly(point, block, error, next))
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

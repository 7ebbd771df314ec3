#include "core/shape/material_feature.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "core/math/option_check.hpp"

namespace palpate::shape {
namespace {

constexpr double kFarthestOutside = 1e-3;  // m

}  // namespace

MaterialPoints::MaterialPoints(const mesh::ElementMesh& mesh,
                               std::vector<Eigen::Vector3d> rest_points)
    : rest_points_(std::move(rest_points)) {
  const mesh::PointLocator locator(mesh);
  for (const Eigen::Vector3d& point : rest_points_) {
    math::check_option(point.allFinite(), "rest_points", point.transpose(), "finite coordinates");
    weights_.push_back(locator.locate(point));
    const double outside = weights_.back().outside;
    math::check_option(
        outside <= kFarthestOutside, "rest_points", point.transpose(),
        "at most 1 mm outside the mesh, not " + std::to_string(1e3 * outside) + " mm");
  }

  for (const mesh::PointWeights& w : weights_) {
    support_.insert(support_.end(), w.nodes.begin(), w.nodes.begin() + w.count);
  }
  std::sort(support_.begin(), support_.end());
  support_.erase(std::unique(support_.begin(), support_.end()), support_.end());

  support_weights_.setZero(count(), static_cast<int>(support_.size()));
  for (int p = 0; p < count(); ++p) {
    for (int i = 0; i < weights_[p].count; ++i) {
      const auto at = std::lower_bound(support_.begin(), support_.end(), weights_[p].nodes[i]);
      support_weights_(p, at - support_.begin()) += weights_[p].weights[i];
    }
  }
}

MaterialFeature::MaterialFeature(const mesh::ElementMesh& mesh,
                                 std::vector<Eigen::Vector3d> rest_points)
    : points_(mesh, std::move(rest_points)) {
  const Eigen::MatrixXd& weights = points_.weights();
  for (int node = 0; node < weights.cols(); ++node) {
    for (int point = 0; point < weights.rows(); ++point) {
      if (weights(point, node) != 0) carriers_.push_back({point, node, weights(point, node)});
    }
  }
}

void MaterialFeature::set_constant(const Eigen::MatrixXd& by_points) {
  std::vector<Eigen::Triplet<double>> entries;
  for (const Carrier& carrier : carriers_) {
    for (int axis = 0; axis < 3; ++axis) {
      for (int row = 0; row < by_points.rows(); ++row) {
        const double factor = by_points(row, 3 * carrier.point + axis);
        if (factor == 0) continue;
        entries.emplace_back(row, 3 * carrier.node + axis, carrier.weight * factor);
      }
    }
  }
  jacobian_.resize(by_points.rows(), 3 * points_.weights().cols());
  jacobian_.setFromTriplets(entries.begin(), entries.end());
}

void MaterialFeature::set_dimension(int dimension) {
  jacobian_ = Eigen::MatrixXd::Ones(dimension, 3 * points_.weights().cols()).sparseView();
  jacobian_.coeffs().setZero();
}

void MaterialFeature::chain(const Eigen::Ref<const Eigen::MatrixXd>& by_points) noexcept {
  Eigen::Map<Eigen::MatrixXd> entries(jacobian_.valuePtr(), jacobian_.rows(), jacobian_.cols());
  entries.setZero();
  for (const Carrier& carrier : carriers_) {
    entries.middleCols<3>(3 * carrier.node) +=
        carrier.weight * by_points.middleCols<3>(3 * carrier.point);
  }
}

void MaterialFeature::error(const Eigen::Ref<const Eigen::VectorXd>& value,
                            const Eigen::Ref<const Eigen::VectorXd>& target,
                            Eigen::Ref<Eigen::VectorXd> error) const noexcept {
  error = target - value;
}

bool MaterialFeature::is_valid_target(const double* target, int count) const noexcept {
  return count == value_count() &&
         std::all_of(target, target + count, [](double v) { return std::isfinite(v); });
}

std::optional<Eigen::Vector3d> unit_axis(const char* kind,
                                         const std::optional<Eigen::Vector3d>& axis) {
  if (!axis) return {};
  math::check_option(axis->allFinite() && axis->norm() > 1e-6,
                     "feature " + std::string(kind) + ": axis", axis->transpose(),
                     "a direction, longer than 1e-6");
  return axis->normalized();
}

void reject_points(const char* kind, const std::vector<Eigen::Vector3d>& points,
                   const char* allowed) {
  std::ostringstream given;
  for (const Eigen::Vector3d& point : points) given << "(" << point.transpose() << ")";
  throw std::invalid_argument("feature " + std::string(kind) + ": rest_points: " + given.str() +
                              "; allowed: " + allowed);
}

const std::vector<Eigen::Vector3d>& checked_points(const char* kind,
                                                   const std::vector<Eigen::Vector3d>& points,
                                                   std::size_t least, std::size_t most) {
  math::check_option(
      points.size() >= least && points.size() <= most,
      "feature " + std::string(kind) + ": rest_points", points.size(),
      std::to_string(least) + (most > least ? " to " + std::to_string(most) : std::string()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if ((points[i] - points[k]).norm() < kNearestPair) {
        reject_points(kind, {points[k], points[i]}, "points at least 1 mm apart");
      }
    }
  }
  return points;
}

}  // namespace palpate::shape

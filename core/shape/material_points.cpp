#include "core/shape/material_points.hpp"

#include <algorithm>
#include <sstream>
#include <stdexcept>

namespace palpate::shape {
namespace {

constexpr double kFarthestOutside = 1e-3;  // m

[[noreturn]] void refuse(const Eigen::Vector3d& point, const std::string& why) {
  std::ostringstream text;
  text << "feature point (" << point.transpose() << ") " << why;
  throw std::invalid_argument(text.str());
}

}  // namespace

MaterialPoints::MaterialPoints(const mesh::ElementMesh& mesh,
                               std::vector<Eigen::Vector3d> rest_points)
    : rest_points_(std::move(rest_points)) {
  const mesh::PointLocator locator(mesh);
  for (const Eigen::Vector3d& point : rest_points_) {
    if (!point.allFinite()) refuse(point, "is not finite");
    weights_.push_back(locator.locate(point));
    const double outside = weights_.back().outside;
    if (outside > kFarthestOutside) {
      refuse(point, "lies " + std::to_string(1e3 * outside) + " mm outside the mesh");
    }
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

}  // namespace palpate::shape

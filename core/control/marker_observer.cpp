#include "core/control/marker_observer.hpp"

#include <Eigen/QR>

namespace palpate::control {

MarkerObserver::MarkerObserver(const mesh::ElementMesh& mesh,
                               const std::vector<Eigen::Vector3d>& rest_points,
                               const Options& options)
    : points_(mesh, rest_points), options_(options) {
  spread_ = points_.weights().completeOrthogonalDecomposition().pseudoInverse();
  seen_ = offset_ = Eigen::Matrix3Xd::Zero(3, points_.count());
  moved_ = Eigen::Matrix3Xd::Zero(3, points_.support().size());
  positions_ = mesh.nodes;
}

void MarkerObserver::look(bool fresh, double age, const Eigen::Ref<const Eigen::Matrix3Xd>& seen,
                          const Eigen::Matrix3Xd& model) noexcept {
  fresh_ = fresh && seen.cols() == points_.count();
  positions_ = model;
  if (fresh_) {
    seen_ = seen;
    known_ = true;
    for (int i = 0; i < points_.count(); ++i)
      offset_.col(i) = seen_.col(i) - points_.position(i, model);
  }
  sees_ = known_ && (fresh_ || age <= options_.patience);
  if (!known_) {
    sees_ = options_.kind == Kind::kOffset;
    return;
  }
  if (options_.kind == Kind::kOffset) {
    sees_ = true;
  } else {
    for (int i = 0; i < points_.count(); ++i)
      offset_.col(i) = seen_.col(i) - points_.position(i, model);
  }
  moved_.noalias() = offset_.lazyProduct(spread_.transpose());
  for (std::size_t n = 0; n < points_.support().size(); ++n)
    positions_.col(points_.support()[n]) += moved_.col(n);
}

}  // namespace palpate::control

#include "tools/fit/held/surface_marker.hpp"

namespace palpate::fit {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

SurfaceMarker::SurfaceMarker(const mesh::PointLocator& locator, const Vector3d& corner,
                             const Vector3d& size, const Vector3d& place) {
  const Vector3d far = corner + size;
  const Vector3d foot = place.cwiseMax(corner).cwiseMin(far);
  int normal = 0;
  (place - foot).cwiseAbs().maxCoeff(&normal);
  stand_ = place[normal] - foot[normal];
  foot_ = locator.locate(foot);
  const auto span = [&](int axis) {
    const Vector3d step = 1e-3 * size[axis] * Vector3d::Unit(axis);
    return Span{locator.locate((foot + step).cwiseMin(far)),
                locator.locate((foot - step).cwiseMax(corner))};
  };
  first_ = span((normal + 1) % 3);
  second_ = span((normal + 2) % 3);
}

Vector3d SurfaceMarker::position(const Matrix3Xd& x) const {
  return foot_.interpolate(x) + stand_ * first_.of(x).cross(second_.of(x)).normalized();
}

Vector3d SurfaceMarker::slope(const Matrix3Xd& x, const Matrix3Xd& dx) const {
  const Vector3d a = first_.of(x), b = second_.of(x), area = a.cross(b);
  const Vector3d turned = first_.of(dx).cross(b) + a.cross(second_.of(dx));
  const Vector3d n = area.normalized();
  return foot_.interpolate(dx) + stand_ / area.norm() * (turned - n * n.dot(turned));
}

}  // namespace palpate::fit

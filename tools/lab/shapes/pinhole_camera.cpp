#include "tools/lab/shapes/pinhole_camera.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace palpate::shapes {
namespace {

using Eigen::Matrix2Xd;
using Eigen::Vector2d;
using Eigen::Vector3d;

enum class Seen : char { kNothing, kMarked, kUnmarked };

/// What each pixel shows, with the inverse of its depth.
class Picture {
 public:
  Picture(int width, int height)
      : width_(width),
        height_(height),
        seen_(width * height, Seen::kNothing),
        nearness_(width * height, 0) {}

  /// Corners: pixels and inverse depth, which is linear in the picture.
  void draw(const std::array<Vector3d, 3>& corners, Seen what) {
    const auto range = [&corners](int axis, int size) {
      const auto [least, most] =
          std::minmax({corners[0][axis], corners[1][axis], corners[2][axis]});
      return std::pair(std::max(0, static_cast<int>(std::ceil(least))),
                       std::min(size - 1, static_cast<int>(std::floor(most))));
    };
    Eigen::Matrix3d m;
    for (int i = 0; i < 3; ++i) m.col(i) << corners[i].head<2>(), 1;
    if (std::abs(m.determinant()) < 1e-12) return;
    const Eigen::Matrix3d inverse = m.inverse();
    const auto [left, right] = range(0, width_);
    const auto [top, bottom] = range(1, height_);
    for (int v = top; v <= bottom; ++v) {
      for (int u = left; u <= right; ++u) {
        const Vector3d share = inverse * Vector3d(u, v, 1);
        if (share.minCoeff() < -1e-9) continue;
        const double nearness =
            share[0] * corners[0].z() + share[1] * corners[1].z() + share[2] * corners[2].z();
        const int pixel = v * width_ + u;
        if (nearness <= nearness_[pixel]) continue;
        nearness_[pixel] = nearness;
        seen_[pixel] = what;
      }
    }
  }

  Matrix2Xd outline(bool with_marked) const {
    const auto covered = [&](int u, int v) {
      if (u < 0 || v < 0 || u >= width_ || v >= height_) return false;
      const Seen what = seen_[v * width_ + u];
      return what == Seen::kUnmarked || (with_marked && what == Seen::kMarked);
    };
    std::vector<Vector2d> points;
    for (int v = 0; v < height_; ++v)
      for (int u = 0; u < width_; ++u)
        if (covered(u, v) &&
            !(covered(u - 1, v) && covered(u + 1, v) && covered(u, v - 1) && covered(u, v + 1)))
          points.emplace_back(u, v);
    Matrix2Xd matrix(2, points.size());
    for (std::size_t i = 0; i < points.size(); ++i) matrix.col(i) = points[i];
    return matrix;
  }

 private:
  int width_, height_;
  std::vector<Seen> seen_;
  std::vector<double> nearness_;  // 1/m
};

}  // namespace

Vector2d PinholeCamera::project(const Vector3d& p) const {
  const Vector3d c = in_camera(p);
  return focal.cwiseProduct(c.head<2>() / c.z()) + centre;
}

Vector3d PinholeCamera::onto_plane(const Vector3d& p, double z) const {
  const Vector3d eye = -rotation.transpose() * translation;
  return eye + (p - eye) * ((z - eye.z()) / (p.z() - eye.z()));
}

double PinholeCamera::obliquity() const {
  return std::acos(std::min(1.0, std::abs(rotation(2, 2))));
}

double distance_to_line(const Vector2d& point, const Matrix2Xd& line) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i + 1 < line.cols(); ++i) {
    const Vector2d along = line.col(i + 1) - line.col(i);
    const double square = along.squaredNorm();
    const double share =
        square > 0 ? std::clamp((point - line.col(i)).dot(along) / square, 0.0, 1.0) : 0;
    least = std::min(least, (point - line.col(i) - share * along).norm());
  }
  return least;
}

SurfaceOutline surface_outline(const PinholeCamera& camera, const Eigen::Matrix3Xd& positions,
                               const Eigen::Matrix3Xi& triangles, const std::vector<bool>& marked) {
  Picture picture(camera.width, camera.height);
  for (int t = 0; t < triangles.cols(); ++t) {
    std::array<Vector3d, 3> corners;
    for (int i = 0; i < 3; ++i) {
      const Vector3d p = positions.col(triangles(i, t));
      corners[i] << camera.project(p), 1 / camera.in_camera(p).z();
    }
    picture.draw(corners, marked[t] ? Seen::kMarked : Seen::kUnmarked);
  }
  return {picture.outline(true), picture.outline(false)};
}

}  // namespace palpate::shapes

#include "sim/draw/solids.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/math/constants.hpp"

namespace palpate::draw {
namespace {

using math::kPi;
constexpr int kSegments = 40;

}  // namespace

TriangleMesh make_box(const Eigen::Vector3d& size) {
  TriangleMesh mesh;
  mesh.points.resize(3, 8);
  for (int i = 0; i < 8; ++i) {
    mesh.points.col(i) =
        Eigen::Vector3d((i & 1) - 0.5, (i >> 1 & 1) - 0.5, (i >> 2) - 0.5).cwiseProduct(size);
  }
  mesh.triangles.resize(3, 12);
  int t = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = 1 << (axis + 1) % 3;  // bit of the corner number that selects the side
    const int v = 1 << (axis + 2) % 3;
    const int upper = 1 << axis;
    mesh.triangles.col(t++) << 0, v, u + v;
    mesh.triangles.col(t++) << 0, u + v, u;
    mesh.triangles.col(t++) << upper, upper + u, upper + u + v;
    mesh.triangles.col(t++) << upper, upper + u + v, upper + v;
  }
  return mesh;
}

TriangleMesh make_revolution(const Eigen::Matrix2Xd& profile, int segments) {
  const int rings = static_cast<int>(profile.cols());
  TriangleMesh mesh;
  mesh.points.resize(3, rings * segments + 2);
  for (int r = 0; r < rings; ++r) {
    for (int s = 0; s < segments; ++s) {
      const double angle = 2 * kPi * s / segments;
      mesh.points.col(r * segments + s) << profile(0, r) * std::cos(angle),
          profile(0, r) * std::sin(angle), profile(1, r);
    }
  }
  const int bottom = rings * segments;
  const int top = bottom + 1;
  mesh.points.col(bottom) << 0, 0, profile(1, 0);
  mesh.points.col(top) << 0, 0, profile(1, rings - 1);

  mesh.triangles.resize(3, 2 * rings * segments);
  int t = 0;
  for (int s = 0; s < segments; ++s) {
    const int next = (s + 1) % segments;
    mesh.triangles.col(t++) << bottom, next, s;
    for (int r = 0; r + 1 < rings; ++r) {
      const int lower = r * segments;
      const int upper = lower + segments;
      mesh.triangles.col(t++) << lower + s, lower + next, upper + next;
      mesh.triangles.col(t++) << lower + s, upper + next, upper + s;
    }
    mesh.triangles.col(t++) << top, (rings - 1) * segments + s, (rings - 1) * segments + next;
  }
  return mesh;
}

TriangleMesh make_cylinder(double radius, double length) {
  Eigen::Matrix2Xd profile(2, 2);
  profile << radius, radius, -0.5 * length, 0.5 * length;
  return make_revolution(profile, kSegments);
}

TriangleMesh make_sphere(double radius) {
  constexpr int kRings = kSegments / 2 - 1;
  Eigen::Matrix2Xd profile(2, kRings + 2);
  for (int r = 0; r < kRings + 2; ++r) {
    // The first and last circles lie so close to the poles that the closing discs are not visible.
    const double polar = std::clamp(kPi * r / (kRings + 1), 1e-3, kPi - 1e-3);
    profile.col(r) << radius * std::sin(polar), -radius * std::cos(polar);
  }
  return make_revolution(profile, kSegments);
}

TriangleMesh make_arrow(double length, double shaft_radius) {
  const double head = std::min(0.5 * length, 6 * shaft_radius);
  Eigen::Matrix2Xd profile(2, 4);
  profile << shaft_radius, shaft_radius, 2.5 * shaft_radius, 1e-3 * shaft_radius,  //
      0, length - head, length - head, length;
  return make_revolution(profile, kSegments);
}

Eigen::Matrix3Xd corner_normals(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xi& triangles,
                                double crease) {
  const Eigen::Index count = triangles.cols();
  Eigen::Matrix3Xd areas(3, count);  // normal times twice the area
  std::vector<std::vector<Eigen::Index>> around(points.cols());
  for (Eigen::Index t = 0; t < count; ++t) {
    const Eigen::Vector3d a = points.col(triangles(0, t));
    const Eigen::Vector3d b = points.col(triangles(1, t));
    const Eigen::Vector3d c = points.col(triangles(2, t));
    areas.col(t) = (b - a).cross(c - a);
    for (int i = 0; i < 3; ++i) around[triangles(i, t)].push_back(t);
  }
  const Eigen::Matrix3Xd units = areas.colwise().normalized();

  const double least_cosine = std::cos(crease);
  Eigen::Matrix3Xd normals(3, 3 * count);
  for (Eigen::Index t = 0; t < count; ++t) {
    for (int i = 0; i < 3; ++i) {
      Eigen::Vector3d sum = areas.col(t);
      for (const Eigen::Index other : around[triangles(i, t)]) {
        if (other != t && units.col(t).dot(units.col(other)) > least_cosine)
          sum += areas.col(other);
      }
      normals.col(3 * t + i) = sum.normalized();
    }
  }
  return normals;
}

}  // namespace palpate::draw

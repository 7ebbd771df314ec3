#include "core/contact/surface_match.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/mesh/closest_point.hpp"

namespace palpate::contact {
namespace {

using Eigen::Vector3d;

/// Corners 0 to 2 and the midpoints of edges 01, 12, 20 form four flat triangles.
constexpr int kParts[4][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}};
constexpr double kAreal[6][3] = {{1, 0, 0},   {0, 1, 0},   {0, 0, 1},
                                 {.5, .5, 0}, {0, .5, .5}, {.5, 0, .5}};

struct Shape {
  std::array<double, 6> values{};
  std::array<Vector3d, 6> slopes;  // derivatives with respect to the three areal coordinates
};

Shape shape_at(const Vector3d& l, int count) noexcept {
  Shape s;
  for (int i = 0; i < 3; ++i) {
    s.values[i] = count == 3 ? l[i] : l[i] * (2 * l[i] - 1);
    s.slopes[i] = (count == 3 ? 1 : 4 * l[i] - 1) * Vector3d::Unit(i);
  }
  for (int i = 3; i < count; ++i) {
    const int a = i - 3, b = (i - 2) % 3;
    s.values[i] = 4 * l[a] * l[b];
    s.slopes[i] = 4 * (l[b] * Vector3d::Unit(a) + l[a] * Vector3d::Unit(b));
  }
  return s;
}

using Eigen::Vector3d;

// rad; adjacent faces of a coarse mesh of a rounded object turn by less
const double kFlat = std::cos(0.7);

Vector3d normal_of(const Eigen::Vector3i& triangle, const Eigen::Matrix3Xd& nodes) {
  const Vector3d a = nodes.col(triangle[0]);
  return (nodes.col(triangle[1]) - a).cross(nodes.col(triangle[2]) - a).normalized();
}

}  // namespace

SurfaceMatcher::SurfaceMatcher(const mesh::Surface& surface, int steps) : steps_(steps) {
  for (const std::vector<int>& nodes : surface.triangle_nodes) {
    Face face;
    face.count = static_cast<int>(nodes.size());
    std::copy(nodes.begin(), nodes.end(), face.nodes.begin());
    faces_.push_back(face);
  }
  const auto count = static_cast<Eigen::Index>(faces_.size());
  centers_.setZero(3, count);
  radii_.setZero(count);
  squared_.setZero(count);
}

void SurfaceMatcher::take(const Eigen::Matrix3Xd& positions) noexcept {
  positions_ = &positions;
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    const Face& face = faces_[f];
    const auto k = static_cast<Eigen::Index>(f);
    Vector3d center = Vector3d::Zero();
    for (int i = 0; i < face.count; ++i) center += positions.col(face.nodes[i]) / face.count;
    double squared = 0;
    for (int i = 0; i < face.count; ++i)
      squared = std::max(squared, (positions.col(face.nodes[i]) - center).squaredNorm());
    centers_.col(k) = center;
    radii_[k] = std::sqrt(squared);
  }
}

SurfaceMatch SurfaceMatcher::find(const Vector3d& p) const noexcept {
  if (faces_.empty() || positions_ == nullptr) return {};
  squared_ = (centers_.colwise() - p.array()).square().colwise().sum().transpose();
  Eigen::Index nearest = 0;
  squared_.minCoeff(&nearest);
  Place best;
  best.squared = 1e300;
  look_closely(static_cast<int>(nearest), p, best);
  double reach = std::sqrt(best.squared);
  for (Eigen::Index f = 0; f < squared_.size(); ++f) {
    const double bound = reach + radii_[f];
    if (f == nearest || squared_[f] > bound * bound) continue;
    look_closely(static_cast<int>(f), p, best);
    reach = std::sqrt(best.squared);
  }
  return on(best, p);
}

void SurfaceMatcher::look_closely(int index, const Vector3d& p, Place& best) const noexcept {
  const Face& face = faces_[static_cast<std::size_t>(index)];
  const Eigen::Matrix3Xd& x = *positions_;
  const int parts = face.count == 6 ? 4 : 1;
  for (int part = 0; part < parts; ++part) {
    const int whole[3] = {0, 1, 2};
    const int* corners = parts == 4 ? kParts[part] : whole;
    const mesh::SurfacePoint found = mesh::closest_point_on_triangle(
        p, x.col(face.nodes[corners[0]]), x.col(face.nodes[corners[1]]),
        x.col(face.nodes[corners[2]]));
    const double squared = found.distance * found.distance;
    if (!(squared < best.squared)) continue;
    best.squared = squared;
    best.face = index;
    best.areal.setZero();
    for (int i = 0; i < 3; ++i)
      best.areal += found.weights[i] * Eigen::Map<const Vector3d>(kAreal[corners[i]]);
  }
}

/// Gauss-Newton steps from the flat triangle to the curved face. The remaining error is
/// perpendicular to the normal, along which points are compared.
SurfaceMatch SurfaceMatcher::on(const Place& place, const Vector3d& p) const noexcept {
  if (place.face < 0) return {};
  const Face& face = faces_[static_cast<std::size_t>(place.face)];
  const Eigen::Matrix3Xd& x = *positions_;
  SurfaceMatch match;
  match.count = face.count;
  match.nodes = face.nodes;
  Vector3d areal = place.areal;
  for (int pass = 0; pass <= steps_; ++pass) {
    const Shape shape = shape_at(areal, face.count);
    Eigen::Matrix3d by_areal = Eigen::Matrix3d::Zero();
    match.position.setZero();
    for (int i = 0; i < face.count; ++i) {
      match.position += shape.values[i] * x.col(face.nodes[i]);
      by_areal.noalias() += x.col(face.nodes[i]) * shape.slopes[i].transpose();
    }
    match.weights = shape.values;
    Eigen::Matrix<double, 3, 2> along;
    along << by_areal.col(1) - by_areal.col(0), by_areal.col(2) - by_areal.col(0);
    const Vector3d across = along.col(0).cross(along.col(1));
    const double area = across.norm();
    match.normal = area > 0 ? Vector3d(across / area) : Vector3d::Zero();
    if (pass == steps_ || face.count == 3 || !(area > 0)) break;
    const Eigen::Matrix2d metric = along.transpose() * along;
    const Eigen::Vector2d step = metric.inverse() * (along.transpose() * (p - match.position));
    areal += Vector3d(-step.sum(), step[0], step[1]);
    areal = areal.cwiseMax(0.0);
    areal /= areal.sum();
  }
  match.distance = (p - match.position).norm();
  return match;
}

SurfaceEdges::SurfaceEdges(const Eigen::Matrix3Xd& rest, const mesh::Surface& surface)
    : rest_(rest) {
  std::map<std::pair<int, int>, Vector3d> sides;  // normal of the face processed first
  std::vector<std::pair<int, int>> edges;
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    const Eigen::Vector3i triangle = surface.triangles.col(t);
    const Vector3d normal = normal_of(triangle, rest);
    for (int i = 0; i < 3; ++i) {
      const std::pair<int, int> side = std::minmax(triangle[i], triangle[(i + 1) % 3]);
      const auto [known, is_first] = sides.emplace(side, normal);
      if (!is_first && known->second.dot(normal) < kFlat) edges.push_back(side);
    }
  }
  const auto count = static_cast<Eigen::Index>(edges.size());
  from_.resize(3, count);
  along_.resize(3, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto& [a, b] = edges[static_cast<std::size_t>(k)];
    from_.col(k) = rest.col(a);
    along_.col(k) = rest.col(b) - rest.col(a);
  }
  squared_ = along_.colwise().squaredNorm().transpose();
}

bool SurfaceEdges::is_near(const SurfaceMatch& match, double distance) const noexcept {
  Vector3d p = Vector3d::Zero();
  for (int i = 0; i < match.count; ++i) p += match.weights[i] * rest_.col(match.nodes[i]);
  for (Eigen::Index k = 0; k < from_.cols(); ++k) {
    const Vector3d way = p - from_.col(k);
    const Vector3d along = along_.col(k);
    const double share = std::clamp(way.dot(along) / squared_[k], 0.0, 1.0);
    if ((way - share * along).squaredNorm() < distance * distance) return true;
  }
  return false;
}

}  // namespace palpate::contact

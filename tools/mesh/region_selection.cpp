#include "tools/mesh/region_selection.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "core/mesh/closest_point.hpp"
#include "core/mesh/connectivity.hpp"

namespace palpate::mesh_tool {
namespace {

using Eigen::Vector3d;

constexpr double kOnBound = 1e-9;  // m, as of mesh::nodes_in_box

template <class Wanted>
std::vector<int> those_of(int count, const Wanted& wanted) {
  std::vector<int> found;
  for (int i = 0; i < count; ++i)
    if (wanted(i)) found.push_back(i);
  return found;
}

Vector3d unit_direction(const Vector3d& direction) {
  const double length = direction.norm();
  if (!(std::isfinite(length) && length > 0))
    throw std::invalid_argument("the direction has no length");
  return direction / length;
}

}  // namespace

Space box_space(const Vector3d& lower, const Vector3d& upper) {
  if (!(lower.array() <= upper.array()).all())
    throw std::invalid_argument("the lower corner of the box is not below the upper one");
  return [lower, upper](const Vector3d& p) {
    return (p.array() >= lower.array() - kOnBound).all() &&
           (p.array() <= upper.array() + kOnBound).all();
  };
}

Space ball_space(const Vector3d& centre, double radius) {
  if (!(radius > 0)) throw std::invalid_argument("the radius of the sphere is not positive");
  return [centre, radius](const Vector3d& p) { return (p - centre).norm() <= radius + kOnBound; };
}

Space half_space(const Vector3d& point, const Vector3d& direction) {
  const Vector3d normal = unit_direction(direction);
  return [point, normal](const Vector3d& p) { return normal.dot(p - point) >= -kOnBound; };
}

RegionSelection::RegionSelection(const mesh::TetrahedralMesh& mesh, const Eigen::Matrix3Xi& faces)
    : mesh_(mesh), faces_(faces) {
  const auto count = static_cast<int>(faces.cols());
  normals_.resize(3, count);
  for (int f = 0; f < count; ++f) {
    const Vector3d a = mesh.nodes.col(faces(0, f)), b = mesh.nodes.col(faces(1, f)),
                   c = mesh.nodes.col(faces(2, f));
    const Vector3d twice = (b - a).cross(c - a);
    areas_.push_back(0.5 * twice.norm());
    normals_.col(f) = twice.stableNormalized();
  }
  neighbours_.setConstant(3, count, -1);
  for (const auto& [edge, at] : mesh::triangles_by_edge(faces)) {
    if (at.size() != 2) continue;
    for (const int side : {0, 1}) {
      for (int i = 0; i < 3; ++i) {
        if (mesh::Edge(std::minmax(faces(i, at[side]), faces((i + 1) % 3, at[side]))) == edge)
          neighbours_(i, at[side]) = at[1 - side];
      }
    }
  }
}

Vector3d RegionSelection::face_centroid(int face) const {
  Vector3d sum = Vector3d::Zero();
  for (const int n : faces_.col(face)) sum += mesh_.nodes.col(n);
  return sum / 3;
}

Vector3d RegionSelection::element_centroid(int element) const {
  Vector3d sum = Vector3d::Zero();
  for (const int n : mesh_.tetrahedra.col(element)) sum += mesh_.nodes.col(n);
  return sum / 4;
}

std::vector<int> RegionSelection::all(RegionKind kind) const {
  const bool are_faces = kind == RegionKind::kFaces;
  std::vector<int> every(are_faces ? faces_.cols() : mesh_.tetrahedra.cols());
  std::iota(every.begin(), every.end(), 0);
  return every;
}

std::vector<int> RegionSelection::inside(RegionKind kind, const Space& space) const {
  if (kind == RegionKind::kElements)
    return those_of(mesh_.tetrahedron_count(), [&](int t) { return space(element_centroid(t)); });
  return those_of(static_cast<int>(faces_.cols()), [&](int f) {
    const auto corners = faces_.col(f);
    return std::all_of(corners.begin(), corners.end(),
                       [&](int n) { return space(mesh_.nodes.col(n)); });
  });
}

std::vector<int> RegionSelection::facing(const Vector3d& direction, double angle) const {
  constexpr double kRounding = 1e-9;  // of a cosine
  const Vector3d wanted = unit_direction(direction);
  return those_of(static_cast<int>(faces_.cols()), [&](int f) {
    return wanted.dot(normals_.col(f)) >= std::cos(angle) - kRounding;
  });
}

std::vector<int> RegionSelection::connected(int start, double angle) const {
  return connected(start, angle, [](const Vector3d&) { return true; });
}

std::vector<int> RegionSelection::connected(int start, double angle, const Space& space) const {
  if (start < 0 || start >= faces_.cols())
    throw std::invalid_argument("there is no face " + std::to_string(start));
  constexpr double kRounding = 1e-9;  // of a cosine
  const double least = std::cos(angle) - kRounding;
  std::vector<bool> found(faces_.cols(), false);
  std::vector<int> waiting{start};
  found[start] = true;
  while (!waiting.empty()) {
    const int face = waiting.back();
    waiting.pop_back();
    for (const int next : neighbours_.col(face)) {
      if (next < 0 || found[next] || normals_.col(face).dot(normals_.col(next)) < least) continue;
      if (!space(face_centroid(next))) continue;
      found[next] = true;
      waiting.push_back(next);
    }
  }
  return mesh::indices_of(found);
}

std::vector<int> RegionSelection::seen(RegionKind kind, const Eigen::Matrix4d& clip_from_object,
                                       const Eigen::Vector2d& lower,
                                       const Eigen::Vector2d& upper) const {
  const Space frustum = [&](const Vector3d& p) {
    const Eigen::Vector4d clip = clip_from_object * p.homogeneous();
    if (!(clip.w() > 0)) return false;
    const Eigen::Array2d at = clip.head<2>().array() / clip.w();
    return (at >= lower.array()).all() && (at <= upper.array()).all();
  };
  std::vector<int> found = inside(kind, frustum);
  if (kind == RegionKind::kElements) return found;
  // Corners that are counter-clockwise from outside are so in the image of a face turned to it.
  const auto is_turned_away = [&](int f) {
    Eigen::Matrix<double, 2, 3> corners;
    for (int i = 0; i < 3; ++i) {
      const Vector3d p = mesh_.nodes.col(faces_(i, f));
      const Eigen::Vector4d clip = clip_from_object * p.homogeneous();
      corners.col(i) = clip.head<2>() / clip.w();
    }
    const Eigen::Vector2d a = corners.col(1) - corners.col(0), b = corners.col(2) - corners.col(0);
    return a.x() * b.y() - a.y() * b.x() <= 0;
  };
  found.erase(std::remove_if(found.begin(), found.end(), is_turned_away), found.end());
  return found;
}

std::vector<int> RegionSelection::elements_at(const std::vector<int>& faces) const {
  const auto elements = mesh::tetrahedra_by_face(mesh_);
  std::vector<int> found;
  for (const int f : faces) {
    mesh::Face corners{faces_(0, f), faces_(1, f), faces_(2, f)};
    std::sort(corners.begin(), corners.end());
    const auto at = elements.find(corners);
    if (at != elements.end()) found.insert(found.end(), at->second.begin(), at->second.end());
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

std::vector<int> RegionSelection::grown(RegionKind kind, std::vector<int> members,
                                        int rounds) const {
  const bool are_faces = kind == RegionKind::kFaces;
  const auto count = static_cast<int>(are_faces ? faces_.cols() : mesh_.tetrahedra.cols());
  const auto any_corner = [&](int item, const auto& is_wanted) {
    for (int i = 0; i < (are_faces ? 3 : 4); ++i)
      if (is_wanted(are_faces ? faces_(i, item) : mesh_.tetrahedra(i, item))) return true;
    return false;
  };
  std::vector<bool> reached(mesh_.node_count(), false);
  for (int round = 0; round < rounds; ++round) {
    for (const int item : members)
      any_corner(item, [&](int n) {
        reached[n] = true;
        return false;
      });
    members = those_of(count, [&](int item) {
      return any_corner(item, [&](int n) -> bool { return reached[n]; });
    });
  }
  return members;
}

int RegionSelection::nearest_face(const Vector3d& point) const {
  return mesh::closest_point_on_surface(point, faces_, mesh_.nodes).triangle;
}

}  // namespace palpate::mesh_tool

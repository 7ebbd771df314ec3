#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "core/mesh/connectivity.hpp"
#include "core/mesh/node_motion.hpp"
#include "core/mesh/repair.hpp"
#include "core/mesh/tetrahedron_quality.hpp"

namespace palpate::mesh {
namespace {

using Eigen::Vector3d;
using Faces = std::map<Face, std::vector<int>>;

/// same criterion as check()
bool is_flat(const TetrahedralMesh& mesh, int t) { return measure(mesh, t).radius_ratio == 0; }

/// A flat tetrahedron has two sides, each of one to three faces. If all faces of one side and none
/// of the other are on the surface, it covers the surface.
bool lies_on_surface(const TetrahedralMesh& mesh, int t, const Faces& faces) {
  std::array<Vector3d, 4> normals;  // oriented by the corner opposite to the face
  const auto corner = [&](int i) -> Vector3d { return mesh.nodes.col(mesh.tetrahedra(i, t)); };
  constexpr int kFaces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  Vector3d up = Vector3d::Zero();
  for (int i = 0; i < 4; ++i) {
    const auto& f = kFaces[i];
    normals[i] = (corner(f[1]) - corner(f[0])).cross(corner(f[2]) - corner(f[0]));
    if (normals[i].norm() > up.norm()) up = normals[i];
  }
  int inside[2] = {0, 0}, outside[2] = {0, 0};
  for (int i = 0; i < 4; ++i) {
    const double along = normals[i].dot(up);
    if (std::abs(along) < 1e-9 * up.squaredNorm()) return false;  // three collinear corners
    const int side = along > 0 ? 1 : 0;
    ++(faces.at(face_of(mesh, t, i)).size() == 1 ? outside : inside)[side];
  }
  return (inside[0] == 0 && outside[1] == 0) || (inside[1] == 0 && outside[0] == 0);
}

/// Collapse of an edge to one of its ends.
class Collapse {
 public:
  explicit Collapse(const TetrahedralMesh& mesh) : mesh_(mesh), around_(mesh.node_count()) {
    for (int t = 0; t < mesh.tetrahedron_count(); ++t) {
      for (const int n : mesh.tetrahedra.col(t)) around_[n].push_back(t);
    }
    const Surface surface = extract_surface(mesh);
    normals_.resize(mesh.node_count());
    for (int t = 0; t < surface.triangles.cols(); ++t) {
      const Eigen::Vector3i c = surface.triangles.col(t);
      for (int i = 0; i < 3; ++i) edges_.insert(std::minmax(c[i], c[(i + 1) % 3]));
      const Vector3d a = mesh.nodes.col(c[0]);
      const Vector3d normal =
          (Vector3d(mesh.nodes.col(c[1])) - a).cross(Vector3d(mesh.nodes.col(c[2])) - a);
      for (const int n : c) {
        if (normal.norm() > 0) normals_[n].push_back(normal.normalized());
        on_surface_.insert(n);
      }
    }
  }

  /// Worst radius ratio around `from` after its replacement by `to`; empty if that is not
  /// permitted.
  std::optional<double> worst_after(int from, int to) const {
    const Vector3d way = mesh_.nodes.col(to) - mesh_.nodes.col(from);
    if (on_surface_.count(from) > 0) {
      if (edges_.count(std::minmax(from, to)) == 0) return {};
      // The surface is unchanged only if the node moves within it.
      for (const Vector3d& normal : normals_[from]) {
        if (std::abs(normal.dot(way)) > 1e-9 * way.norm()) return {};
      }
    }
    if (!keeps_topology(from, to)) return {};
    double worst = 1;
    TetrahedralMesh one{mesh_.nodes, Eigen::Matrix4Xi(4, 1)};
    for (const int t : around_[from]) {
      one.tetrahedra.col(0) = mesh_.tetrahedra.col(t);
      if ((one.tetrahedra.array() == to).any()) continue;
      const bool was_flat = is_flat(one, 0);
      for (int& n : one.tetrahedra.reshaped()) n = n == from ? to : n;
      if (is_flat(one, 0) && was_flat) continue;  // handled separately
      if (is_flat(one, 0) || volume(one, 0) < 0) return {};
      worst = std::min(worst, measure(one, 0).radius_ratio);
    }
    return worst;
  }

 private:
  /// The ends of an edge must have no common neighbours except those in the elements around it.
  bool keeps_topology(int from, int to) const {
    std::set<int> near_from, near_to, common, round;
    for (const int t : around_[from]) {
      const auto c = mesh_.tetrahedra.col(t);
      near_from.insert(c.begin(), c.end());
      if ((c.array() == to).any()) round.insert(c.begin(), c.end());
    }
    for (const int t : around_[to]) {
      const auto c = mesh_.tetrahedra.col(t);
      near_to.insert(c.begin(), c.end());
    }
    std::set_intersection(near_from.begin(), near_from.end(), near_to.begin(), near_to.end(),
                          std::inserter(common, common.end()));
    return common == round;
  }

  const TetrahedralMesh& mesh_;
  std::vector<std::vector<int>> around_;
  std::vector<std::vector<Vector3d>> normals_;
  std::set<std::pair<int, int>> edges_;
  std::set<int> on_surface_;
};

bool collapse(MeshWithGroups& mesh, int t) {
  const Collapse collapse(mesh.mesh);
  double best = 0;
  int from = -1, to = -1;
  for (const auto& [a, b] : kTetrahedronEdges) {
    for (const bool forth : {true, false}) {
      const int f = mesh.mesh.tetrahedra(forth ? a : b, t),
                g = mesh.mesh.tetrahedra(forth ? b : a, t);
      const std::optional<double> worst = collapse.worst_after(f, g);
      if (!worst || *worst <= best) continue;
      best = *worst;
      from = f;
      to = g;
    }
  }
  if (from < 0) return false;
  std::vector<int> by(mesh.mesh.node_count());
  for (int n = 0; n < mesh.mesh.node_count(); ++n) by[n] = n == from ? to : n;
  replace_nodes(mesh, by);
  std::vector<bool> gone(mesh.mesh.tetrahedron_count(), false);
  for (int e = 0; e < mesh.mesh.tetrahedron_count(); ++e) {
    gone[e] = (mesh.mesh.tetrahedra.col(e).array() == to).count() > 1;
  }
  drop(mesh, gone);
  return true;
}

std::vector<int> flat_ones(const TetrahedralMesh& mesh) {
  std::vector<int> flat;
  for (int t = 0; t < mesh.tetrahedron_count(); ++t) {
    if (is_flat(mesh, t)) flat.push_back(t);
  }
  return flat;
}

void peel(MeshWithGroups& mesh, FlatElements& result) {
  for (bool again = true; again;) {
    again = false;
    const Faces faces = tetrahedra_by_face(mesh.mesh);
    for (const int t : flat_ones(mesh.mesh)) {
      if (!lies_on_surface(mesh.mesh, t, faces)) continue;
      result.peeled.push_back(mesh.tetrahedron_number(t));
      std::vector<bool> gone(mesh.mesh.tetrahedron_count(), false);
      gone[t] = true;
      drop(mesh, gone);
      again = true;
      break;  // the set of elements on the surface may have changed
    }
  }
}

void inflate(MeshWithGroups& mesh, FlatElements& result) {
  const std::vector<int> flat = flat_ones(mesh.mesh);
  if (flat.empty()) return;
  std::set<int> nodes;
  for (const int t : flat) {
    for (const int n : mesh.mesh.tetrahedra.col(t)) nodes.insert(n);
  }
  NodeMotionOptions options;
  options.only.assign(nodes.begin(), nodes.end());
  move_nodes(mesh, options);
  for (const int t : flat) {
    if (!is_flat(mesh.mesh, t)) result.inflated.push_back(mesh.tetrahedron_number(t));
  }
}

}  // namespace

FlatElements remove_flat_elements(MeshWithGroups& mesh) {
  FlatElements result;
  peel(mesh, result);
  inflate(mesh, result);
  std::set<long> hopeless;
  for (bool again = true; again;) {
    again = false;
    for (const int t : flat_ones(mesh.mesh)) {
      const long number = mesh.tetrahedron_number(t);
      if (hopeless.count(number) > 0) continue;
      again = true;
      if (collapse(mesh, t)) {
        result.collapsed.push_back(number);
      } else {
        hopeless.insert(number);
      }
      break;
    }
  }
  result.left.assign(hopeless.begin(), hopeless.end());
  return result;
}

}  // namespace palpate::mesh

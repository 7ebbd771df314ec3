#include "core/mesh/node_motion.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>

#include "core/mesh/connectivity.hpp"

namespace palpate::mesh {
namespace {

using Eigen::Vector3d;

// Sine of the angle between sides that count as coplanar; deviation of an edge's midpoint, relative
// to its length, for which it counts as straight.
constexpr double kFlatFace = 1e-6, kStraight = 1e-7;
constexpr double kFlatQuality = 1e-3;

/// Orthonormal directions in which a node may move.
using Freedom = std::vector<Vector3d>;

class NodeMotion {
 public:
  NodeMotion(MeshWithGroups& mesh, const std::vector<int>& only) : mesh_(mesh) {
    const int count = mesh.mesh.node_count();
    around_.resize(count);
    for (int t = 0; t < mesh.mesh.tetrahedron_count(); ++t) {
      for (const int n : mesh.mesh.tetrahedra.col(t)) around_[n].push_back(t);
    }
    freedom_.assign(count, {});
    std::vector<char> wanted(count, only.empty());
    for (const int n : only) wanted[n] = 1;
    for (int n = 0; n < count; ++n) {
      if (wanted[n]) freedom_[n] = {Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()};
    }
    keep_shape();
    keep_groups();
  }

  /// One pass over all nodes; true if any was moved.
  bool sweep() {
    bool better = false;
    for (int n = 0; n < mesh_.mesh.node_count(); ++n) {
      if (freedom_[n].empty() || around_[n].empty() || !improve(n)) continue;
      moved_.insert(n);
      better = true;
    }
    return better;
  }

  int finish() {
    for (auto edge = mesh_.middles.begin(); edge != mesh_.middles.end();) {
      const bool gone = moved_.count(edge->first.first) + moved_.count(edge->first.second) > 0;
      edge = gone ? mesh_.middles.erase(edge) : std::next(edge);
    }
    return static_cast<int>(moved_.size());
  }

 private:
  void keep_shape() {
    const TetrahedralMesh& mesh = mesh_.mesh;
    // the orientation of a face is irrelevant here, so that inverted elements do no harm
    const Surface surface = extract_surface(mesh);
    std::vector<std::vector<Vector3d>> normals(mesh.node_count());
    for (int t = 0; t < surface.triangles.cols(); ++t) {
      const Eigen::Vector3i c = surface.triangles.col(t);
      const Vector3d a = mesh.nodes.col(c[0]), b = mesh.nodes.col(c[1]), d = mesh.nodes.col(c[2]);
      const Vector3d normal = (b - a).cross(d - a);
      for (const int n : c) {
        // a side without area defines no plane: its nodes are fixed
        if (!(normal.norm() > kFlatFace * (b - a).norm() * (d - a).norm())) freedom_[n].clear();
        if (!freedom_[n].empty()) normals[n].push_back(normal.normalized());
      }
    }
    for (int n = 0; n < mesh.node_count(); ++n) {
      for (Vector3d normal : normals[n]) take_away(normal, freedom_[n]);
    }
    for (const auto& [edge, middle] : mesh_.middles) {
      const Vector3d a = mesh.nodes.col(edge.first), b = mesh.nodes.col(edge.second);
      if ((middle - 0.5 * (a + b)).norm() < kStraight * (b - a).norm()) continue;
      freedom_[edge.first].clear();
      freedom_[edge.second].clear();
    }
  }

  /// Removes a direction from a node's freedom.
  static void take_away(Vector3d normal, Freedom& freedom) {
    Vector3d inside = Vector3d::Zero();
    for (const Vector3d& d : freedom) inside += d.dot(normal) * d;
    if (inside.norm() < kFlatFace) return;
    inside.normalize();
    Freedom left;
    for (Vector3d d : freedom) {
      d -= d.dot(inside) * inside;
      for (const Vector3d& other : left) d -= d.dot(other) * other;
      if (d.norm() > 0.3) left.push_back(d.normalized());
    }
    left.resize(std::min(left.size(), freedom.size() - 1));
    freedom = std::move(left);
  }

  void keep_groups() {
    std::vector<std::vector<int>> groups(mesh_.mesh.tetrahedron_count());
    int number = 0;
    for (const auto& [name, group] : mesh_.groups) {
      for (const int t : group.tetrahedra) groups[t].push_back(number);
      ++number;
      // the edge of a marked part of the surface must be preserved as well
      std::vector<char> marked(mesh_.mesh.node_count(), 0);
      for (const int n : group.triangles.reshaped()) marked[n] = 1;
      for (int n = 0; n < mesh_.mesh.node_count(); ++n) {
        if (marked[n] && freedom_[n].size() == 2 && on_rim(n, group.triangles)) freedom_[n].clear();
      }
    }
    for (int n = 0; n < mesh_.mesh.node_count(); ++n) {
      for (const int t : around_[n]) {
        if (groups[t] != groups[around_[n].front()]) freedom_[n].clear();
      }
    }
  }

  /// Whether an edge that belongs to only one of these triangles contains the node.
  static bool on_rim(int n, const Eigen::Matrix3Xi& triangles) {
    std::vector<int> ends;
    for (int t = 0; t < triangles.cols(); ++t) {
      if (!(triangles.col(t).array() == n).any()) continue;
      for (const int other : triangles.col(t)) {
        if (other != n) ends.push_back(other);
      }
    }
    return std::any_of(ends.begin(), ends.end(),
                       [&](int end) { return std::count(ends.begin(), ends.end(), end) != 2; });
  }

  /// 1 for a regular tetrahedron, negative for an inverted one; smooth through zero.
  double quality(int t) const {
    double squares = 0;
    for (const auto& [a, b] : kTetrahedronEdges) {
      const Vector3d from = mesh_.mesh.nodes.col(mesh_.mesh.tetrahedra(a, t));
      squares += (mesh_.mesh.nodes.col(mesh_.mesh.tetrahedra(b, t)) - from).squaredNorm() / 6;
    }
    return squares > 0 ? 6 * std::sqrt(2.0) * volume(mesh_.mesh, t) / std::pow(squares, 1.5) : 0;
  }

  /// Quality of the elements around a node: the worst one as long as any is flat or inverted,
  /// otherwise their power mean with exponent -4, which is close to the worst but still sensitive
  /// to the others.
  double goodness(int n) const {
    double worst = 1, sum = 0;
    for (const int t : around_[n]) {
      const double q = quality(t);
      worst = std::min(worst, q);
      sum += 1 / (q * q * q * q);
    }
    if (!(worst > kFlatQuality)) return worst - kFlatQuality;
    return std::pow(static_cast<double>(around_[n].size()) / sum, 0.25);
  }

  bool improve(int n) {
    auto place = mesh_.mesh.nodes.col(n);
    double reach = 0;  // mean distance from the neighbours
    Vector3d centre = Vector3d::Zero();
    for (const int t : around_[n]) {
      for (const int other : mesh_.mesh.tetrahedra.col(t)) {
        reach += (mesh_.mesh.nodes.col(other) - place).norm();
        centre += mesh_.mesh.nodes.col(other);
      }
    }
    const double neighbours = 4.0 * static_cast<double>(around_[n].size());
    reach /= neighbours;
    centre /= neighbours;

    const double before = goodness(n);
    double best = before;
    const auto try_place = [&](const Vector3d& at) {
      const Vector3d old = place;
      place = at;
      const double q = goodness(n);
      if (q > best) {
        best = q;
        return true;
      }
      place = old;
      return false;
    };
    const Vector3d to_centre = centre - place;
    Vector3d allowed = Vector3d::Zero();
    for (const Vector3d& d : freedom_[n]) allowed += d.dot(to_centre) * d;
    try_place(place + allowed);
    for (double step = 0.3 * reach; step > 2e-3 * reach; step *= 0.5) {
      for (const Vector3d& d : freedom_[n]) {
        if (!try_place(place + step * d)) try_place(place - step * d);
      }
    }
    return best > before + 1e-3;
  }

  MeshWithGroups& mesh_;
  std::vector<std::vector<int>> around_;  // tetrahedra around each node
  std::vector<Freedom> freedom_;
  std::set<int> moved_;
};

}  // namespace

int move_nodes(MeshWithGroups& mesh, const NodeMotionOptions& options) {
  NodeMotion motion(mesh, options.only);
  for (int i = 0; i < options.sweeps && motion.sweep(); ++i) {
  }
  return motion.finish();
}

}  // namespace palpate::mesh

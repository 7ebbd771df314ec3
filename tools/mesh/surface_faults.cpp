#include <algorithm>
#include <set>

#include "core/mesh/surface_report.hpp"
#include "tools/mesh/faults.hpp"

namespace palpate::mesh_tool {
namespace {

class SurfaceFaults {
 public:
  explicit SurfaceFaults(const mesh::TriangleSurface& surface)
      : surface_(surface), report_(mesh::check(surface)) {}

  std::vector<Fault> find() {
    if (surface_.triangle_count() == 0) start("empty", "there are no triangles");
    add_triangles("out_of_range", "triangles that name a point which is not there",
                  report_.index_out_of_range);
    add_not_finite();
    if (report_.not_finite.empty() && report_.index_out_of_range.empty()) add_geometry();
    add_size_fault(surface_.points, faults_);
    return std::move(faults_);
  }

 private:
  Fault& start(const std::string& kind, const std::string& what) {
    Fault& fault = faults_.emplace_back();
    fault.kind = kind;
    fault.text = what;
    return fault;
  }

  void add_geometry() {
    add_triangles("no_area", "triangles without area", report_.no_area);
    add_triangles("repeated", "triangles that are there twice", report_.repeated);
    add_points("duplicate_point", "points that lie on another", report_.duplicate_points);
    add_points("unused_point", "points in no triangle", report_.unused_points);
    add_holes();
    add_crowded_edges();
    add_points("pinched", "points in which the surface touches itself (non-manifold)",
               report_.non_manifold_points);
    add_triangles("turned", "triangles turned against their neighbours", report_.turned);
    add_parts("one_sided", "triangles of a surface with a single side", report_.one_sided);
    add_parts("inside_out", "triangles of a surface that is inside out", report_.inside_out);
    add_intersections();
    add_bodies();
  }

  void show(int t, Fault& fault) const {
    Eigen::Matrix3Xd face(3, 0);
    for (const int n : surface_.triangles.col(t)) {
      if (n < 0 || n >= surface_.point_count() || !surface_.points.col(n).allFinite()) continue;
      face.conservativeResize(3, face.cols() + 1);
      face.rightCols<1>() = surface_.points.col(n);
    }
    if (face.cols() == 0) return;
    fault.points.emplace_back(face.rowwise().mean());
    if (face.cols() == 3) fault.faces.push_back(face);
    if (face.cols() == 2) fault.lines.emplace_back(face.col(0), face.col(1));
  }

  void add_triangles(const std::string& kind, const std::string& what,
                     const std::vector<int>& triangles) {
    if (triangles.empty()) return;
    Fault& fault = start(kind, what);
    for (const int t : triangles) {
      fault.numbers.push_back(surface_.number(t));
      show(t, fault);
    }
  }

  void add_points(const std::string& kind, const std::string& what,
                  const std::vector<int>& points) {
    if (points.empty()) return;
    Fault& fault = start(kind, what);
    for (const int n : points) {
      fault.numbers.push_back(n + 1);
      if (surface_.points.col(n).allFinite()) fault.points.emplace_back(surface_.points.col(n));
    }
  }

  /// A nonexistent point is reported and shown by the triangles that reference it.
  void add_not_finite() {
    const std::vector<int>& bad = report_.not_finite;
    std::vector<int> triangles;
    for (int t = 0; t < surface_.triangle_count(); ++t) {
      const auto c = surface_.triangles.col(t);
      if (std::any_of(c.begin(), c.end(),
                      [&](int n) { return std::binary_search(bad.begin(), bad.end(), n); }))
        triangles.push_back(t);
    }
    add_triangles("not_finite", "triangles with a coordinate that is not finite", triangles);
    // A point that no triangle references.
    if (triangles.empty()) add_points("not_finite", "points that are not finite", bad);
  }

  void add_holes() {
    if (report_.holes.empty()) return;
    Fault& fault = start("hole", "");
    std::size_t edges = 0;
    for (const std::vector<int>& loop : report_.holes) {
      Eigen::Vector3d centre = Eigen::Vector3d::Zero();
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const Eigen::Vector3d a = surface_.points.col(loop[i]),
                              b = surface_.points.col(loop[(i + 1) % loop.size()]);
        fault.lines.emplace_back(a, b);
        centre += a / static_cast<double>(loop.size());
      }
      fault.points.push_back(centre);
      edges += loop.size();
    }
    fault.text = std::to_string(report_.holes.size()) +
                 (report_.holes.size() == 1 ? " hole" : " holes") + " with " +
                 std::to_string(edges) + " edges round";
  }

  void add_crowded_edges() {
    if (report_.non_manifold_edges.empty()) return;
    Fault& fault = start("non_manifold_edge", "");
    for (const auto& [a, b] : report_.non_manifold_edges) {
      fault.lines.emplace_back(surface_.points.col(a), surface_.points.col(b));
      fault.points.emplace_back(0.5 * (surface_.points.col(a) + surface_.points.col(b)));
    }
    fault.text = std::to_string(report_.non_manifold_edges.size()) +
                 " edges of more than two triangles (non-manifold)";
  }

  void add_parts(const std::string& kind, const std::string& what, const std::vector<int>& parts) {
    std::vector<int> triangles;
    for (int t = 0; t < surface_.triangle_count(); ++t) {
      if (std::binary_search(parts.begin(), parts.end(), report_.part[t])) triangles.push_back(t);
    }
    add_triangles(kind, what, triangles);
  }

  void add_intersections() {
    std::set<int> triangles;
    for (const auto& [s, t] : report_.intersections) triangles.insert({s, t});
    add_triangles("self_intersection", "triangles that go through one another",
                  {triangles.begin(), triangles.end()});
  }

  void add_bodies() {
    // For an open surface, nesting of its parts is undefined.
    if (report_.bodies < 2 && (report_.is_closed() || report_.parts() < 2)) return;
    std::vector<double> area(report_.parts(), 0);
    for (int t = 0; t < surface_.triangle_count(); ++t) area[report_.part[t]] += 1;
    const auto largest = std::max_element(area.begin(), area.end()) - area.begin();
    std::vector<int> others;
    for (int t = 0; t < surface_.triangle_count(); ++t) {
      const int part = report_.part[t];
      if (part != largest && report_.depth[part] % 2 == 0) others.push_back(t);
    }
    add_triangles("parts", "triangles of parts other than the largest", others);
  }

  const mesh::TriangleSurface& surface_;
  mesh::SurfaceReport report_;
  std::vector<Fault> faults_;
};

}  // namespace

std::vector<Fault> find_faults(const mesh::TriangleSurface& surface) {
  return SurfaceFaults(surface).find();
}

}  // namespace palpate::mesh_tool

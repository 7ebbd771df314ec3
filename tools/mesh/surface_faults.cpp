#include <algorithm>
#include <set>

#include "core/mesh/surface_report.hpp"
#include "tools/mesh/fault_finder.hpp"

namespace palpate::mesh_tool {
namespace {

class SurfaceFaults : FaultFinder {
 public:
  explicit SurfaceFaults(const mesh::TriangleSurface& surface)
      : FaultFinder(
            surface.points, surface.triangles, [&surface](int t) { return surface.number(t); },
            [](int n) { return n + 1; }),
        surface_(surface),
        report_(mesh::check(surface)) {}

  std::vector<Fault> find() {
    if (surface_.triangle_count() == 0) start("empty", "there are no triangles");
    add_cells("out_of_range", "triangles that name a point which is not there",
              report_.index_out_of_range);
    add_not_finite();
    if (report_.not_finite.empty() && report_.index_out_of_range.empty()) add_geometry();
    add_size();
    return std::move(faults_);
  }

 private:
  void add_geometry() {
    add_cells("no_area", "triangles without area", report_.no_area);
    add_cells("repeated", "triangles that are there twice", report_.repeated);
    add_points("duplicate_point", "points that lie on another", report_.duplicate_points);
    add_points("unused_point", "points in no triangle", report_.unused_points);
    add_holes();
    add_crowded_edges();
    add_points("pinched", "points in which the surface touches itself (non-manifold)",
               report_.non_manifold_points);
    add_cells("turned", "triangles turned against their neighbours", report_.turned);
    add_parts("one_sided", "triangles of a surface with a single side", report_.one_sided);
    add_parts("inside_out", "triangles of a surface that is inside out", report_.inside_out);
    add_intersections();
    add_bodies();
  }

  /// A nonexistent point is reported and shown by the triangles that reference it.
  void add_not_finite() {
    const std::vector<int>& bad = report_.not_finite;
    const std::vector<int> triangles = cells_at(bad);
    add_cells("not_finite", "triangles with a coordinate that is not finite", triangles);
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
    show_edges(report_.non_manifold_edges, fault);
    fault.text = std::to_string(report_.non_manifold_edges.size()) +
                 " edges of more than two triangles (non-manifold)";
  }

  void add_parts(const std::string& kind, const std::string& what, const std::vector<int>& parts) {
    std::vector<int> triangles;
    for (int t = 0; t < surface_.triangle_count(); ++t) {
      if (std::binary_search(parts.begin(), parts.end(), report_.part[t])) triangles.push_back(t);
    }
    add_cells(kind, what, triangles);
  }

  void add_intersections() {
    std::set<int> triangles;
    for (const auto& [s, t] : report_.intersections) triangles.insert({s, t});
    add_cells("self_intersection", "triangles that go through one another",
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
    add_cells("parts", "triangles of parts other than the largest", others);
  }

  const mesh::TriangleSurface& surface_;
  mesh::SurfaceReport report_;
};

}  // namespace

std::vector<Fault> find_faults(const mesh::TriangleSurface& surface) {
  return SurfaceFaults(surface).find();
}

}  // namespace palpate::mesh_tool

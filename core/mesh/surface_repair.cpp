#include "core/mesh/surface_repair.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "core/mesh/mesh_writer.hpp"
#include "core/mesh/near_nodes.hpp"
#include "core/mesh/surface_report.hpp"
#include "core/mesh/surface_topology.hpp"

namespace palpate::mesh {
namespace {

using Eigen::Vector3d;

class SurfaceRepair {
 public:
  SurfaceRepair(TriangleSurface& surface, const SurfaceRepairOptions& options)
      : surface_(surface), options_(options) {
    if (surface.numbers.empty()) {
      for (int t = 0; t < surface.triangle_count(); ++t) surface.numbers.push_back(t);
    }
  }

  std::vector<RepairStep> run() {
    std::vector<long> unused = unused_points();
    drop({});
    add("points dropped that are in no triangle", std::move(unused));
    if (!out_of_range(surface_.triangles, surface_.point_count()).empty() ||
        !not_finite(surface_.points).empty())
      return std::move(steps_);
    merge();
    turn_thin_triangles();
    drop_useless();
    drop_bodies();
    close_holes();
    turn();
    return std::move(steps_);
  }

 private:
  void add(const std::string& what, std::vector<long> numbers) {
    if (!numbers.empty()) steps_.push_back({what, std::move(numbers)});
  }
  std::vector<long> numbers(const std::vector<int>& triangles) const {
    std::vector<long> result;
    for (const int t : triangles) result.push_back(surface_.number(t));
    return result;
  }
  std::vector<long> unused_points() const {
    std::vector<long> result;
    const auto used = used_nodes(surface_.triangles, surface_.point_count());
    for (const int n : indices_of(used, false)) result.push_back(n + 1);
    return result;
  }

  /// Drops triangles, and points that are then unused.
  void drop(const std::vector<int>& triangles) {
    std::vector<bool> stays(surface_.triangle_count(), true);
    for (const int t : triangles) stays[t] = false;
    const std::vector<int> kept = indices_of(stays);
    surface_.triangles = surface_.triangles(Eigen::all, kept).eval();
    for (std::size_t k = 0; k < kept.size(); ++k) surface_.numbers[k] = surface_.numbers[kept[k]];
    surface_.numbers.resize(kept.size());
    const std::vector<bool> used = used_nodes(surface_.triangles, surface_.point_count());
    surface_.points = surface_.points(Eigen::all, indices_of(used)).eval();
    const std::vector<int> point = new_numbers(used);
    for (int& n : surface_.triangles.reshaped()) {
      if (n >= 0) n = point[n];
    }
  }

  void merge() {
    const double tolerance = options_.merge_tolerance * diagonal(surface_.points);
    const std::vector<int> by = near_nodes(surface_.points, tolerance);
    std::vector<long> merged;
    for (int n = 0; n < surface_.point_count(); ++n) {
      if (by[n] != n) merged.push_back(n + 1);
    }
    for (int& n : surface_.triangles.reshaped()) n = by[n];
    add("points merged into others within " + shortest(tolerance) + " m", std::move(merged));
  }

  bool names_twice(int t) const {
    const auto c = surface_.triangles.col(t);
    return c[0] == c[1] || c[1] == c[2] || c[2] == c[0];
  }

  /// For a triangle with one corner on the opposite edge: that edge is flipped, so that the
  /// neighbour behind it is divided at the corner.
  void turn_thin_triangles() {
    std::vector<long> done;
    for (int round = 0; round < 10; ++round) {
      const std::vector<int> thin = check(surface_).no_area;
      bool any = false;
      for (const int t : thin) any = (!names_twice(t) && turn_thin(t, done)) || any;
      if (!any) break;
    }
    add("triangles without area removed by turning their longest edge", std::move(done));
  }

  bool turn_thin(int t, std::vector<long>& done) {
    int longest = 0;
    double most = -1;
    for (int i = 0; i < 3; ++i) {
      const double length = (surface_.points.col(surface_.triangles((i + 1) % 3, t)) -
                             surface_.points.col(surface_.triangles(i, t)))
                                .norm();
      if (length > most) longest = i;
      most = std::max(most, length);
    }
    const int a = surface_.triangles(longest, t), b = surface_.triangles((longest + 1) % 3, t),
              c = surface_.triangles((longest + 2) % 3, t);
    int other = -1, opposite = -1;
    for (int s = 0; s < surface_.triangle_count(); ++s) {
      for (int i = 0; i < 3 && s != t; ++i) {
        if (surface_.triangles(i, s) != b || surface_.triangles((i + 1) % 3, s) != a) continue;
        if (other >= 0) return false;
        other = s;
        opposite = surface_.triangles((i + 2) % 3, s);
      }
    }
    if (other < 0 || opposite == c) return false;
    surface_.triangles.col(t) << a, opposite, c;
    surface_.triangles.col(other) << opposite, b, c;
    done.push_back(surface_.number(t));
    return true;
  }

  void drop_useless() {
    std::vector<int> thin, repeated;
    for (int t = 0; t < surface_.triangle_count(); ++t) {
      if (names_twice(t)) thin.push_back(t);
    }
    add("triangles dropped that name a point twice", numbers(thin));
    drop(thin);
    repeated = check(surface_).repeated;
    add("triangles dropped that are there twice", numbers(repeated));
    drop(repeated);
  }

  void drop_bodies() {
    if (options_.parts != Parts::kKeepLargest) return;
    // By area, because an open part has no volume. If all parts are closed, cavities are kept.
    const SurfaceReport report = check(surface_);
    std::vector<double> areas(report.parts(), 0);
    for (int t = 0; t < surface_.triangle_count(); ++t)
      areas[report.part[t]] += area(surface_.triangles.col(t));
    const auto largest =
        static_cast<int>(std::max_element(areas.begin(), areas.end()) - areas.begin());
    const bool nested = report.is_closed() && report.bodies == 1;
    std::vector<int> gone;
    for (int t = 0; t < surface_.triangle_count() && !nested; ++t) {
      if (report.part[t] != largest) gone.push_back(t);
    }
    add("triangles dropped that are not of the largest part", numbers(gone));
    drop(gone);
  }

  void close_holes() {
    std::vector<long> added;
    std::size_t holes = 0;
    double closed = 0;
    const SurfaceTopology topology(surface_);
    const SurfaceReport before_closing = check(surface_);
    for (const std::vector<int>& loop : before_closing.holes) {
      if (static_cast<int>(loop.size()) > options_.largest_hole || loop.size() < 3) continue;
      if (is_rim_of_sheet(loop, topology)) continue;
      const Eigen::Matrix3Xi closing = close_loop(surface_.points, loop);
      const int before = surface_.triangle_count();
      surface_.triangles.conservativeResize(3, before + closing.cols());
      surface_.triangles.rightCols(closing.cols()) = closing;
      for (int t = 0; t < closing.cols(); ++t) {
        closed += area(closing.col(t));
        surface_.numbers.push_back(before + t + 1);
        added.push_back(surface_.numbers.back());
      }
      ++holes;
    }
    add("triangles added to close " + std::to_string(holes) + (holes == 1 ? " hole" : " holes") +
            " by " + shortest(std::round(1e4 * closed / before_closing.area) / 100) +
            " % of the area that was there",
        std::move(added));
  }

  double area(const Eigen::Vector3i& corners) const {
    const Vector3d a = surface_.points.col(corners[0]), b = surface_.points.col(corners[1]),
                   c = surface_.points.col(corners[2]);
    return 0.5 * (b - a).cross(c - a).norm();
  }

  /// A loop attached to an edge of three triangles bounds a protruding sheet, not a hole.
  static bool is_rim_of_sheet(const std::vector<int>& loop, const SurfaceTopology& topology) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const auto edge = topology.edges().find(std::minmax(loop[i], loop[j]));
        if (edge != topology.edges().end() && edge->second.size() > 2) return true;
      }
    }
    return false;
  }

  void turn() {
    SurfaceReport report = check(surface_);
    if (!report.one_sided.empty() || !report.is_closed()) return;
    std::vector<bool> wrong(surface_.triangle_count(), false);
    for (const int t : report.turned) wrong[t] = true;
    add("triangles turned like their neighbours", numbers(report.turned));
    std::vector<int> whole;
    for (int t = 0; t < surface_.triangle_count(); ++t) {
      if (std::find(report.inside_out.begin(), report.inside_out.end(), report.part[t]) ==
          report.inside_out.end())
        continue;
      wrong[t] = !wrong[t];
      whole.push_back(t);
    }
    add("triangles turned: the surface was inside out", numbers(whole));
    for (int t = 0; t < surface_.triangle_count(); ++t) {
      if (wrong[t]) std::swap(surface_.triangles(1, t), surface_.triangles(2, t));
    }
  }

  TriangleSurface& surface_;
  const SurfaceRepairOptions& options_;
  std::vector<RepairStep> steps_;
};

}  // namespace

Eigen::Matrix3Xi close_loop(const Eigen::Matrix3Xd& points, const std::vector<int>& loop) {
  // best triangulation of each section of the loop from those of shorter sections
  const int n = static_cast<int>(loop.size());
  if (n < 3) return {};
  std::vector<std::vector<double>> area(n, std::vector<double>(n, 0));
  std::vector<std::vector<int>> third(n, std::vector<int>(n, 0));
  for (int length = 2; length < n; ++length) {
    for (int i = 0; i + length < n; ++i) {
      const int j = i + length;
      area[i][j] = std::numeric_limits<double>::infinity();
      third[i][j] = i + 1;
      const Vector3d a = points.col(loop[i]), b = points.col(loop[j]);
      for (int k = i + 1; k < j; ++k) {
        const Vector3d c = points.col(loop[k]);
        // among equal areas, prefer triangulations without needles
        const double sides = (b - a).squaredNorm() + (c - a).squaredNorm() + (c - b).squaredNorm();
        const double sum =
            area[i][k] + area[k][j] + 0.5 * (c - a).cross(b - a).norm() + 1e-6 * sides;
        if (sum < area[i][j]) {
          area[i][j] = sum;
          third[i][j] = k;
        }
      }
    }
  }
  Eigen::Matrix3Xi triangles(3, n - 2);
  std::vector<std::array<int, 2>> open{{0, n - 1}};
  int count = 0;
  while (!open.empty()) {
    const auto [i, j] = open.back();
    open.pop_back();
    if (j - i < 2) continue;
    const int k = third[i][j];
    triangles.col(count++) << loop[i], loop[k], loop[j];
    open.push_back({i, k});
    open.push_back({k, j});
  }
  return triangles;
}

std::vector<RepairStep> repair(TriangleSurface& surface, const SurfaceRepairOptions& options) {
  return SurfaceRepair(surface, options).run();
}

}  // namespace palpate::mesh

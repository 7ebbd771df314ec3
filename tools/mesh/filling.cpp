#include "tools/mesh/filling.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <optional>
#include <stdexcept>

#include "core/mesh/curved_sides.hpp"
#include "core/mesh/node_motion.hpp"
#include "core/mesh/report.hpp"
#include "tools/common/progress.hpp"
#include "tools/common/table.hpp"
#include "tools/mesh/faults.hpp"
#include "tools/mesh/quality.hpp"

namespace palpate::mesh_tool {
namespace {

/// Fills a valid surface; if new triangles of the requested size are not possible, with its own.
mesh::MeshWithGroups fill(const mesh::TriangleSurface& surface, const MeshingOptions& options) {
  common::Progress progress(1, 1, "gmsh fills the surface");
  const auto show = [&progress](double share, const std::string& note) {
    progress.show(share, note);
  };
  const auto is_good = [](const mesh::MeshWithGroups& filled) {
    return !has_errors(find_faults(filled));
  };
  mesh::MeshWithGroups filled;
  std::string why;
  try {
    filled = fill_by_gmsh(surface, options, show);
    if (!is_good(filled)) why = "its elements are broken\n" + text(find_faults(filled));
  } catch (const std::runtime_error& error) {
    if (options.triangles == SurfaceTriangles::kKeep) throw;
    why = error.what();
    if (why.find("not installed") != std::string::npos ||
        why.find("--time-limit") != std::string::npos)
      throw;
  }
  if (!why.empty() && options.triangles == SurfaceTriangles::kRemesh) {
    std::cerr << "new triangles could not be made: " << why
              << "so the surface's own are kept, whatever their size\n";
    MeshingOptions kept = options;
    kept.triangles = SurfaceTriangles::kKeep;
    filled = fill_by_gmsh(surface, kept, show);
  }
  progress.finish(true, std::to_string(filled.mesh.tetrahedron_count()) + " tetrahedra");
  return filled;
}

}  // namespace

mesh::MeshWithGroups fill_and_refine(const mesh::TriangleSurface& surface,
                                     const MeshingOptions& options, int order, std::ostream& out) {
  mesh::MeshWithGroups filled = fill(surface, options);
  const Quality before = measure_quality(filled.mesh);
  const int moved = mesh::move_nodes(filled);
  out << "nodes moved for quality: " << moved << "; "
      << compare(before, measure_quality(filled.mesh)) << '\n';
  if (options.triangles == SurfaceTriangles::kKeep) return filled;
  follow_surface(surface, filled);
  const double wanted = mesh::enclosed_volume(surface);
  const double straight = mesh::check(filled.mesh).volume;
  if (order == 1) {
    try {
      mesh::keep_curved_volume(filled.mesh, filled.middles);
    } catch (const std::invalid_argument& error) {
      out << "sides stay as they are: " << error.what() << '\n';
    }
    filled.middles.clear();
  }
  out << common::formatted(
      "volume by that of the surface: %.3f %% with corners on it, %.3f %% written\n",
      100 * straight / wanted, 100 * mesh::check(filled.mesh).volume / wanted);
  return filled;
}

int quadratic_node_count(const mesh::TetrahedralMesh& mesh) {
  return measure_quality(mesh).quadratic_nodes;
}

BudgetedMesh fill_within_budget(double edge, int most,
                                const std::function<mesh::MeshWithGroups(double)>& make) {
  constexpr int kTrials = 8;
  constexpr double kEnough = 0.75;     // of the budget
  constexpr double kGoodEnough = 0.2;  // radius ratio at which the search ends
  constexpr double kAimed = 0.9;       // of the budget, as the count is not smooth in the edge
  BudgetedMesh best;
  double best_score = -1;
  int least = std::numeric_limits<int>::max();
  std::string why;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::optional<mesh::MeshWithGroups> made;
    try {
      made = make(edge);
    } catch (const std::runtime_error& error) {
      why = error.what();
      // A missing program or a time-out does not depend on the edge.
      if (why.find("not installed") != std::string::npos ||
          why.find("--time-limit") != std::string::npos)
        throw;
    }
    if (!made) {
      edge *= 0.93;
      continue;
    }
    const int nodes = quadratic_node_count(made->mesh);
    const double ratio = mesh::check(made->mesh).quality_min;
    least = std::min(least, nodes);
    if (nodes <= most) {
      const bool is_enough = nodes >= kEnough * most;
      const double score = is_enough ? 1 + ratio : static_cast<double>(nodes) / most;
      if (score > best_score) {
        best_score = score;
        best = {std::move(*made), edge};
      }
      if (is_enough && ratio >= kGoodEnough) break;
    }
    // Nodes on the surface grow with the inverse square of the edge, inner ones with its cube.
    const double wanted = nodes > most || nodes < kEnough * most
                              ? std::pow(nodes / (kAimed * most), 0.4)
                              : 1 + 0.02 * (trial % 2 == 0 ? trial + 1 : -trial - 1);
    edge *= std::clamp(wanted, 0.5, 2.0);
  }
  if (best_score >= 0) return best;
  throw std::runtime_error(least == std::numeric_limits<int>::max()
                               ? why
                               : "no mesh of at most " + std::to_string(most) +
                                     " quadratic nodes (--nodes) was found; " +
                                     "the smallest has " + std::to_string(least));
}

}  // namespace palpate::mesh_tool

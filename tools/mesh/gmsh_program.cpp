#include "tools/mesh/gmsh_program.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "core/mesh/closest_point.hpp"
#include "core/mesh/connectivity.hpp"
#include "core/mesh/mesh_formats.hpp"
#include "core/mesh/mesh_writer.hpp"
#include "core/mesh/surface_files.hpp"
#include "tools/common/interruption.hpp"
#include "tools/common/output_files.hpp"
#include "tools/common/process.hpp"
#include "tools/mesh/mesh_files.hpp"

namespace palpate::mesh_tool {
namespace {

namespace fs = std::filesystem;

/// Options of gmsh. It works in units of the requested edge length, so that its absolute tolerances
/// suit bodies of any size.
std::string script(const MeshingOptions& options) {
  std::ostringstream out;
  out << "Merge \"surface.stl\";\n";
  if (options.triangles == SurfaceTriangles::kRemesh) {
    out << "ClassifySurfaces{" << options.feature_angle
        << " * Pi / 180, 1, 1, Pi};\nCreateGeometry;\n";
  }
  out << "Surface Loop(1) = Surface{:};\nVolume(1) = {1};\n"
      << "Mesh.MeshSizeMin = 1;\nMesh.MeshSizeMax = 1;\nMesh.MeshSizeExtendFromBoundary = "
      << (options.triangles == SurfaceTriangles::kRemesh ? 0 : 1) << ";\n"
      << "Mesh.Algorithm = 6;\nMesh.Algorithm3D = 1;\nMesh.Optimize = 1;\n"
      << "Mesh.OptimizeThreshold = 0.4;\nMesh.SaveAll = 1;\n";
  return out.str();
}

/// Progress of gmsh from its output: it prints the percentage of each dimension.
void report_progress(const fs::path& log, const MeshingProgress& progress) {
  static const std::regex kPercent("\\[ *([0-9]+)%\\] Meshing (curve|surface)");
  std::ifstream in(log);
  double share = 0.02;
  std::string note = "reading the surface";
  for (std::string line; std::getline(in, line);) {
    std::smatch match;
    if (std::regex_search(line, match, kPercent)) {
      const bool surface = match[2] == "surface";
      share = (surface ? 0.2 : 0.05) + (surface ? 0.3 : 0.1) * std::stod(match[1]) / 100;
      note = surface ? "surfaces" : "edges";
    } else if (line.find("Meshing 3D") != std::string::npos) {
      share = 0.5;
      note = "tetrahedra";
    } else if (line.find("Optimizing mesh") != std::string::npos) {
      share = 0.85;
      note = "optimising";
    }
  }
  progress(share, note);
}

/// gmsh's errors, or its last lines if it printed none.
std::string messages(const fs::path& log) {
  std::ifstream in(log);
  std::string errors;
  int lines = 0;
  for (std::string line; std::getline(in, line);) {
    if (line.rfind("Error", 0) == 0 && line.find("----") == std::string::npos && ++lines <= 12)
      errors += line + "\n";
  }
  return errors.empty() ? common::tail(log, 8) : errors;
}

using Eigen::Vector3d;

/// Triangles in a grid of cells, to look up those near a point.
class Lookup {
 public:
  Lookup(const mesh::TriangleSurface& surface, double cell) : surface_(surface), cell_(cell) {
    for (int t = 0; t < surface.triangle_count(); ++t) {
      Eigen::AlignedBox3d box;
      for (const int n : surface.triangles.col(t)) box.extend(Vector3d(surface.points.col(n)));
      visit(box, [&](const Key& key) { cells_[key].push_back(t); });
    }
  }

  /// The closest point within `reach` of p; false if there is none.
  bool find(const Vector3d& p, double reach, Vector3d& nearest) const {
    const Vector3d around = Vector3d::Constant(reach);
    double best = reach;
    bool found = false;
    visit(Eigen::AlignedBox3d(p - around, p + around), [&](const Key& key) {
      const auto members = cells_.find(key);
      if (members == cells_.end()) return;
      for (const int t : members->second) {
        const auto corner = [&](int i) { return surface_.points.col(surface_.triangles(i, t)); };
        const mesh::SurfacePoint q =
            mesh::closest_point_on_triangle(p, corner(0), corner(1), corner(2));
        if (!(q.distance < best)) continue;
        best = q.distance;
        nearest = q.position;
        found = true;
      }
    });
    return found;
  }

 private:
  using Key = std::array<long, 3>;
  template <typename Visit>
  void visit(const Eigen::AlignedBox3d& box, Visit&& visit_cell) const {
    Key low{}, high{};
    for (int i = 0; i < 3; ++i) {
      low[i] = static_cast<long>(std::floor(box.min()[i] / cell_));
      high[i] = static_cast<long>(std::floor(box.max()[i] / cell_));
    }
    for (long x = low[0]; x <= high[0]; ++x)
      for (long y = low[1]; y <= high[1]; ++y)
        for (long z = low[2]; z <= high[2]; ++z) visit_cell({x, y, z});
  }

  const mesh::TriangleSurface& surface_;
  double cell_;
  std::map<Key, std::vector<int>> cells_;
};

}  // namespace

mesh::MeshWithGroups fill_by_gmsh(const mesh::TriangleSurface& surface,
                                  const MeshingOptions& options, const MeshingProgress& progress) {
  if (!common::is_installed(options.program)) {
    throw std::runtime_error("the program " + options.program +
                             " is not installed; on Debian: apt-get install gmsh");
  }
  const common::TemporaryFolder folder("palpate-mesh");
  const fs::path log = folder.path() / "gmsh.log", output = folder.path() / "mesh.msh";
  mesh::TriangleSurface scaled = surface;
  scaled.points /= options.edge;
  write_surface(scaled, folder.path() / "surface.stl");
  write_file(folder.path() / "mesh.geo", script(options));
  common::Process gmsh("gmsh",
                       {options.program, (folder.path() / "mesh.geo").string(), "-3", "-format",
                        "msh41", "-nt", "1", "-o", output.string()},
                       log);
  const auto start = std::chrono::steady_clock::now();
  std::optional<int> code;
  while (!code) {
    common::throw_if_interrupted();
    code = gmsh.wait(0.1);
    report_progress(log, progress);
    const double elapsed =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (!code && elapsed > options.time_limit) {
      gmsh.stop(1);
      throw std::runtime_error("gmsh did not end within " + mesh::shortest(options.time_limit) +
                               " s (--time-limit); it said:\n" + common::tail(log, 5));
    }
  }
  if (*code != 0 || !fs::exists(output)) {
    throw std::runtime_error("gmsh failed (exit code " + std::to_string(*code) + "); it said:\n" +
                             messages(log));
  }
  std::ifstream in(output, std::ios::binary);
  mesh::MeshWithGroups result;
  try {
    result = mesh::read_gmsh(in, "mesh of gmsh");
  } catch (const mesh::ParseError&) {
    throw std::runtime_error("gmsh made no tetrahedra; it said:\n" + messages(log));
  }
  result.mesh.nodes *= options.edge;
  mesh::orient(result.mesh);
  result.groups.clear();
  result.middles.clear();
  result.node_numbers.clear();
  result.tetrahedron_numbers.clear();
  return result;
}

int follow_surface(const mesh::TriangleSurface& surface, mesh::MeshWithGroups& mesh) {
  // Below this it is rounding; above, another part of the surface, and too much for
  // keep_curved_volume.
  constexpr double kLeast = 1e-5, kMost = 0.15;  // relative to an edge's length
  const auto edges = mesh::triangles_by_edge(mesh::extract_surface(mesh.mesh).triangles);
  double longest = 0;
  for (const auto& [edge, triangles] : edges)
    longest = std::max(longest,
                       (mesh.mesh.nodes.col(edge.first) - mesh.mesh.nodes.col(edge.second)).norm());
  if (!(longest > 0)) return 0;
  const Lookup lookup(surface, longest);
  int count = 0;
  for (const auto& [edge, triangles] : edges) {
    const Vector3d from = mesh.mesh.nodes.col(edge.first), to = mesh.mesh.nodes.col(edge.second);
    const double length = (to - from).norm();
    const Vector3d middle = 0.5 * (from + to);
    Vector3d nearest;
    if (!lookup.find(middle, kMost * length, nearest)) continue;
    if ((nearest - middle).norm() < kLeast * length) continue;
    mesh.middles[edge] = nearest;
    ++count;
  }
  return count;
}

}  // namespace palpate::mesh_tool

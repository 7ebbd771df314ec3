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

#include "core/mesh/mesh_formats.hpp"
#include "core/mesh/mesh_writer.hpp"
#include "core/mesh/surface.hpp"
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

/// The closest point of a triangle to p (Ericson 2005, 5.1.5).
Vector3d nearest_on(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& p) {
  const Vector3d ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp),
               d6 = ac.dot(cp);
  if (d1 <= 0 && d2 <= 0) return a;
  if (d3 >= 0 && d4 <= d3) return b;
  if (d6 >= 0 && d5 <= d6) return c;
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  const double sum = va + vb + vc;
  return a + vb / sum * ab + vc / sum * ac;
}

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
        const Vector3d q = nearest_on(surface_.points.col(surface_.triangles(0, t)),
                                      surface_.points.col(surface_.triangles(1, t)),
                                      surface_.points.col(surface_.triangles(2, t)), p);
        if (!((q - p).norm() < best)) continue;
        best = (q - p).norm();
        nearest = q;
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
  const mesh::Surface outside =
      mesh::extract_surface(make_element_mesh(mesh.mesh, mesh::ElementOrder::kLinear));
  double longest = 0;
  for (int t = 0; t < outside.triangles.cols(); ++t) {
    for (int i = 0; i < 3; ++i) {
      longest = std::max(longest, (mesh.mesh.nodes.col(outside.triangles(i, t)) -
                                   mesh.mesh.nodes.col(outside.triangles((i + 1) % 3, t)))
                                      .norm());
    }
  }
  if (!(longest > 0)) return 0;
  const Lookup lookup(surface, longest);
  int count = 0;
  for (int t = 0; t < outside.triangles.cols(); ++t) {
    for (int i = 0; i < 3; ++i) {
      const int a = outside.triangles(i, t), b = outside.triangles((i + 1) % 3, t);
      if (a > b) continue;  // the neighbour's turn
      const Vector3d from = mesh.mesh.nodes.col(a), to = mesh.mesh.nodes.col(b);
      const double length = (to - from).norm();
      const Vector3d middle = 0.5 * (from + to);
      Vector3d nearest;
      if (!lookup.find(middle, kMost * length, nearest)) continue;
      if ((nearest - middle).norm() < kLeast * length) continue;
      mesh.middles[{a, b}] = nearest;
      ++count;
    }
  }
  return count;
}

}  // namespace palpate::mesh_tool

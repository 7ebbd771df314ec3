#include "tools/mesh/gmsh_program.hpp"

#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <stdexcept>

#include "core/mesh/mesh_formats.hpp"
#include "core/mesh/mesh_writer.hpp"
#include "core/mesh/surface_files.hpp"
#include "tools/common/interruption.hpp"
#include "tools/common/process.hpp"
#include "tools/mesh/mesh_files.hpp"

namespace palpate::mesh_tool {
namespace {

namespace fs = std::filesystem;

class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "palpate-mesh-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error(name + ": cannot be made");
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

bool is_installed(const std::string& program) {
  if (program.find('/') != std::string::npos) return access(program.c_str(), X_OK) == 0;
  const char* folders = std::getenv("PATH");
  std::istringstream list(folders == nullptr ? "" : folders);
  for (std::string folder; std::getline(list, folder, ':');)
    if (access((fs::path(folder) / program).c_str(), X_OK) == 0) return true;
  return false;
}

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
void tell(const fs::path& log, const MeshingProgress& progress) {
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

}  // namespace

mesh::MeshWithGroups fill_by_gmsh(const mesh::TriangleSurface& surface,
                                  const MeshingOptions& options, const MeshingProgress& progress) {
  if (!is_installed(options.program)) {
    throw std::runtime_error("the program " + options.program +
                             " is not installed; on Debian: apt-get install gmsh");
  }
  const TemporaryFolder folder;
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
    tell(log, progress);
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

}  // namespace palpate::mesh_tool

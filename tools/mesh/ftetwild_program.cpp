#include "tools/mesh/ftetwild_program.hpp"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <optional>
#include <stdexcept>

#include "core/mesh/mesh_formats.hpp"
#include "core/mesh/mesh_writer.hpp"
#include "core/mesh/surface_files.hpp"
#include "tools/common/interruption.hpp"
#include "tools/common/output_files.hpp"
#include "tools/common/process.hpp"
#include "tools/common/progress.hpp"
#include "tools/mesh/mesh_files.hpp"

namespace palpate::mesh_tool {

mesh::MeshWithGroups fill_by_ftetwild(const mesh::TriangleSurface& surface,
                                      const FtetwildOptions& options) {
  namespace files = std::filesystem;
  if (!common::is_installed(options.program)) {
    throw std::runtime_error(
        "the program " + options.program +
        " of fTetWild is not installed; it is built from github.com/wildmeshing/fTetWild, and "
        "--ftetwild names another place");
  }
  const common::TemporaryFolder folder("palpate-mesh");
  const files::path log = folder.path() / "ftetwild.log", output = folder.path() / "mesh.msh";
  write_surface(surface, folder.path() / "surface.stl");
  common::Progress progress(1, 1, "fTetWild fills the triangles");
  common::Process program("fTetWild",
                          {options.program, "--input", (folder.path() / "surface.stl").string(),
                           "--output", output.string(), "--la", mesh::shortest(options.edge),
                           "--epsr", mesh::shortest(options.envelope), "--manifold-surface",
                           "--max-threads", "1", "--level", "3"},
                          log);
  const auto start = std::chrono::steady_clock::now();
  std::optional<int> code;
  while (!code) {
    common::throw_if_interrupted();
    code = program.wait(0.1);
    const double elapsed =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    progress.show(0.5, "no percentage known");
    if (!code && elapsed > options.time_limit) {
      program.stop(1);
      throw std::runtime_error("fTetWild did not end within " + mesh::shortest(options.time_limit) +
                               " s (--time-limit); it said:\n" + common::tail(log, 5));
    }
  }
  if (*code != 0 || !files::exists(output)) {
    throw std::runtime_error("fTetWild failed (exit code " + std::to_string(*code) +
                             "); it said:\n" + common::tail(log, 8));
  }
  mesh::MeshWithGroups result;
  try {
    std::ifstream in(output, std::ios::binary);
    result = mesh::read_gmsh(in, "mesh of fTetWild");
  } catch (const mesh::ParseError& error) {
    throw std::runtime_error(std::string("fTetWild made no tetrahedra (") + error.what() +
                             "); it said:\n" + common::tail(log, 8));
  }
  mesh::orient(result.mesh);
  result.groups.clear();
  result.node_numbers.clear();
  result.tetrahedron_numbers.clear();
  progress.finish(true, std::to_string(result.mesh.tetrahedron_count()) + " tetrahedra");
  return result;
}

}  // namespace palpate::mesh_tool

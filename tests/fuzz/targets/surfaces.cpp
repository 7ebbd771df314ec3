// Surface files (the first byte is the format), the faults reported for them, and their repair.

#include <cmath>
#include <sstream>

#include "core/mesh/surface_files.hpp"
#include "core/mesh/surface_repair.hpp"
#include "core/mesh/surface_report.hpp"
#include "tests/fuzz/target.hpp"

namespace palpate::fuzz {
namespace {

constexpr int kMostTriangles = 300;  // intersections are tested pairwise

mesh::TriangleSurface read(char format, const std::string& text) {
  std::istringstream stream(text);
  return format == 's' ? mesh::read_stl(stream, "a.stl") : mesh::read_obj(stream, "a.obj");
}

}  // namespace

std::vector<std::string> seeds() {
  const std::string obj =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2/1 3/1/1 4//1\nf -4 -1 -2\n";
  std::istringstream stream(obj);
  std::ostringstream stl;
  mesh::write_stl(mesh::read_obj(stream, "a.obj"), stl);
  std::string binary(84, ' ');
  binary[80] = 1;
  binary[81] = binary[82] = binary[83] = 0;
  binary.append(50, '\0');
  return {"o" + obj, "o" + obj + "f 1 2 3 4\n", "s" + stl.str(), "s" + binary};
}

}  // namespace palpate::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  if (size == 0) return 0;
  const std::string text(reinterpret_cast<const char*>(data) + 1, size - 1);
  try {
    mesh::TriangleSurface surface = fuzz::read(static_cast<char>(data[0]), text);
    if (surface.triangle_count() > fuzz::kMostTriangles) return 0;
    mesh::check(surface);
    mesh::repair(surface, {});
    const mesh::SurfaceReport report = mesh::check(surface);
    fuzz::require(surface.numbers.size() == static_cast<std::size_t>(surface.triangle_count()),
                  "numbers of all triangles");
    fuzz::require(report.unused_points.empty(), "no stray points");
    if (report.ok()) {
      fuzz::require(mesh::enclosed_volume(surface) > 0, "a good surface holds a volume");
    }
  } catch (const mesh::ParseError& error) {
    fuzz::require(std::string(error.what()).find("a.") == 0, "an error names its file");
  }
  return 0;
}

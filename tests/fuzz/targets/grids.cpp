// VTK's unstructured grids in XML.

#include <cmath>
#include <sstream>

#include "core/mesh/report.hpp"
#include "core/mesh/round_mesh.hpp"
#include "tests/fuzz/target.hpp"
#include "tools/mesh/mesh_files.hpp"

namespace palpate::fuzz {

std::vector<std::string> seeds() {
  std::vector<std::string> all;
  const mesh::MeshWithGroups ball = mesh::make_ellipsoid({1, 1, 1}, 1, mesh::RoundSides::kCurved);
  for (const auto encoding : {mesh_tool::VtuEncoding::kAscii, mesh_tool::VtuEncoding::kBase64}) {
    for (const auto order : {mesh::ElementOrder::kLinear, mesh::ElementOrder::kQuadratic}) {
      std::ostringstream out;
      mesh_tool::write_vtu(ball, order, encoding, out);
      all.push_back("t" + out.str());
      all.push_back("k" + out.str());
    }
  }
  return all;
}

}  // namespace palpate::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  if (size == 0) return 0;
  std::istringstream stream(std::string(reinterpret_cast<const char*>(data) + 1, size - 1));
  const bool keeps = data[0] == 'k';
  try {
    const mesh::MeshWithGroups read =
        mesh_tool::read_vtu(stream, "a.vtu", keeps ? mesh::OnFault::kKeep : mesh::OnFault::kThrow);
    const mesh::MeshReport report = mesh::check(read.mesh);
    fuzz::require(keeps || report.index_out_of_range.empty(), "indices in range");
    fuzz::require(keeps || report.not_finite.empty(), "finite coordinates");
    for (const auto& [name, group] : read.groups) {
      for (const int t : group.tetrahedra)
        fuzz::require(t >= 0 && t < read.mesh.tetrahedron_count(), "tetrahedra of a group");
    }
  } catch (const mesh::ParseError& error) {
    fuzz::require(std::string(error.what()).find("a.vtu") == 0, "an error names its file");
  }
  return 0;
}

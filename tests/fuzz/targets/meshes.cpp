// Mesh files: the first byte is the format, '%' separates the two files of TetGen and the includes
// of a .veg. A capital letter reads faulty meshes too, and repairs them.

#include <cctype>
#include <cmath>
#include <sstream>

#include "core/mesh/mesh_formats.hpp"
#include "core/mesh/mesh_writer.hpp"
#include "core/mesh/repair.hpp"
#include "core/mesh/report.hpp"
#include "tests/fuzz/target.hpp"

namespace palpate::fuzz {
namespace {

const char* kNode = "5 3 1 1\n1 0 0 0 9 1\n2 1 0 0 9 1\n3 0 1 0 9 1\n4 0 0 1 9 1\n5 1 1 1 9 0\n";
const char* kEle = "2 4 0\n1 1 2 3 4\n2 5 3 2 4\n";

const char* kGmsh2 =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 3 \"held face\"\n3 1 \"body\"\n"
    "$EndPhysicalNames\n$Nodes\n6\n10 0 0 0\n20 1 0 0\n30 0 1 0\n40 0 0 1\n50 1 1 1\n60 9 9 9\n"
    "$EndNodes\n$Elements\n4\n1 15 2 0 1 60\n2 2 2 3 5 10 30 20\n3 4 2 1 5 10 20 30 40\n"
    "4 4 2 1 5 50 30 20 40\n$EndElements\n";
const char* kGmsh4 =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 7 \"body\"\n$EndPhysicalNames\n"
    "$Entities\n1 0 1 1\n1 0 0 0 0\n2 0 0 0 1 1 1 1 7 0\n3 0 0 0 1 1 1 1 7 1 2\n$EndEntities\n"
    "$Nodes\n1 5 1 5\n3 3 0 5\n1\n2\n3\n4\n5\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n$EndNodes\n"
    "$Elements\n2 3 1 3\n2 2 2 1\n1 1 3 2\n3 3 4 2\n2 1 2 3 4\n3 5 3 2 4\n$EndElements\n";
const char* kTenNodes =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n10\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n"
    "5 .5 0 0\n6 .53 .53 0\n7 0 .5 0\n8 0 0 .5\n9 0 .53 .53\n10 .53 0 .53\n$EndNodes\n"
    "$Elements\n1\n1 11 2 1 1 1 2 3 4 5 6 7 8 9 10\n$EndElements\n";

mesh::MeshWithGroups read(char format, const std::string& first, const std::string& second) {
  std::istringstream stream(first), other(second);
  const bool keeps = std::isupper(static_cast<unsigned char>(format)) != 0;
  const auto on_fault = keeps ? mesh::OnFault::kKeep : mesh::OnFault::kThrow;
  const int kind = std::tolower(static_cast<unsigned char>(format));
  if (kind == 'g') return mesh::read_gmsh(stream, "a.msh", on_fault);
  if (kind == 'v')
    return mesh::read_vega(
        stream, "a.veg", [&second](const std::string&) { return second; }, on_fault);
  return mesh::read_tetgen(stream, "a.node", other, "a.ele", on_fault);
}

/// A binary .msh of a box of six tetrahedra.
std::string binary_gmsh(mesh::GmshVersion version, mesh::ElementOrder order) {
  mesh::MeshWithGroups box{mesh::make_box({1, 1, 1}, {1, 1, 1}), {}, {}};
  box.groups["half"].tetrahedra = {0, 1, 2};
  std::ostringstream out;
  mesh::write_gmsh(box, {version, mesh::Encoding::kBinary, order}, out);
  return "g" + out.str();
}

const char* kMixed =
    "G$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n9\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n"
    "5 0 0 1\n6 1 0 1\n7 1 1 1\n8 0 1 1\n9 .5 .5 2\n$EndNodes\n$Elements\n3\n"
    "9 5 0 1 2 3 4 5 6 7 8\n10 7 0 5 6 7 8 9\n11 4 0 1 2 3 77\n$EndElements\n";

/// Guarantees of a reader for the mesh that it returns.
void check(const mesh::MeshWithGroups& read) {
  const mesh::TetrahedralMesh& mesh = read.mesh;
  const mesh::MeshReport report = mesh::check(mesh);
  require(report.index_out_of_range.empty(), "indices in range");
  require(report.not_finite.empty(), "finite coordinates");
  if (report.ok()) {
    require(report.volume > 0 && std::isfinite(report.volume), "a good mesh has a volume");
    require(report.quality_min > 0, "a good mesh has no flat tetrahedron");
  }
  require(!report.text().empty(), "a report says something");
  for (const auto& [name, group] : read.groups) {
    for (const int t : group.tetrahedra)
      require(t >= 0 && t < mesh.tetrahedron_count(), "tetrahedra of a group");
    for (const int n : group.nodes) require(n >= 0 && n < mesh.node_count(), "nodes of a group");
    if (group.triangles.size() > 0)
      require(group.triangles.minCoeff() >= 0 && group.triangles.maxCoeff() < mesh.node_count(),
              "triangles of a group");
  }
}

/// Guarantees of a repair, for any input.
void check_repaired(const mesh::MeshWithGroups& repaired) {
  const mesh::MeshReport report = mesh::check(repaired.mesh);
  require(report.unused_nodes.empty() || !repaired.others.empty(), "no stray nodes");
  require(repaired.node_numbers.size() == static_cast<std::size_t>(repaired.mesh.node_count()) &&
              repaired.tetrahedron_numbers.size() ==
                  static_cast<std::size_t>(repaired.mesh.tetrahedron_count()),
          "numbers of all nodes and elements");
  for (const auto& [name, group] : repaired.groups) {
    for (const int t : group.tetrahedra)
      require(t >= 0 && t < repaired.mesh.tetrahedron_count(), "tetrahedra of a group");
    for (const int n : group.nodes)
      require(n >= 0 && n < repaired.mesh.node_count(), "nodes of a group");
  }
}

}  // namespace

std::vector<std::string> seeds() {
  const std::string node = kNode, ele = kEle;
  return {"t" + node + "%" + ele,
          "t" + node + "%1 10 0\n1 1 2 3 4 5 5 5 5 5 5\n",
          std::string("g") + kGmsh2,
          std::string("g") + kGmsh4,
          std::string("G") + kGmsh4,
          kMixed,
          "T" + node + "%" + ele,
          binary_gmsh(mesh::GmshVersion::k2_2, mesh::ElementOrder::kLinear),
          binary_gmsh(mesh::GmshVersion::k4_1, mesh::ElementOrder::kLinear),
          binary_gmsh(mesh::GmshVersion::k4_1, mesh::ElementOrder::kQuadratic),
          std::string("g") + kTenNodes,
          "v*VERTICES\n" + node + "*ELEMENTS\nTETS\n" + ele + "*SET middle\n1, 2\n*REGION\n",
          "v*VERTICES\n*INCLUDE a.node\n*ELEMENTS\nTET\n" + ele + "%" + node};
}

}  // namespace palpate::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  if (size == 0) return 0;
  const std::string text(reinterpret_cast<const char*>(data) + 1, size - 1);
  const std::size_t cut = text.find('%');
  const std::string second = cut == std::string::npos ? "" : text.substr(cut + 1);
  try {
    mesh::MeshWithGroups read = fuzz::read(static_cast<char>(data[0]), text.substr(0, cut), second);
    if (std::isupper(data[0]) != 0) {
      mesh::repair(read, {});
      fuzz::check_repaired(read);
      return 0;
    }
    mesh::orient(read.mesh);
    try {
      mesh::keep_curved_volume(read.mesh, read.middles);
    } catch (const std::invalid_argument&) {
    }
    fuzz::check(read);
  } catch (const mesh::ParseError& error) {
    const std::string what = error.what();
    // The name of a file included by a .veg may contain any bytes, including zero.
    fuzz::require(std::tolower(data[0]) == 'v' || what.find("a.") == 0, "an error names its file");
  }
  return 0;
}

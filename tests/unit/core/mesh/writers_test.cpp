// Written files read back bit-identically, in every format and variant.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "core/mesh/mesh_formats.hpp"
#include "core/mesh/mesh_writer.hpp"
#include "core/mesh/report.hpp"
#include "core/mesh/round_mesh.hpp"
#include "tests/unit/core/mesh/random_meshes.hpp"

namespace palpate::mesh {
namespace {

constexpr int kWritersMeshes = 50;

MeshWithGroups gmsh_trip(const MeshWithGroups& mesh, const GmshFormat& format) {
  std::stringstream stream;
  write_gmsh(mesh, format, stream);
  return read_gmsh(stream, "a.msh");
}

class GmshForms : public ::testing::TestWithParam<std::tuple<GmshVersion, Encoding>> {
 protected:
  GmshFormat format(ElementOrder order = ElementOrder::kLinear) const {
    return {std::get<0>(GetParam()), std::get<1>(GetParam()), order};
  }
};

TEST_P(GmshForms, RandomMeshesComeBackToTheBit) {
  RandomMeshes random(1);
  for (int i = 0; i < kWritersMeshes; ++i) {
    const TetrahedralMesh mesh = random.make();
    ASSERT_EQ(hash(gmsh_trip({mesh, {}, {}}, format()).mesh), hash(mesh)) << i;
  }
}

TEST_P(GmshForms, GroupsComeBack) {
  const MeshWithGroups mesh = make_cylinder(0.02, 0.1, 2, 4, RoundSides::kFull);
  const MeshWithGroups back = gmsh_trip(mesh, format());
  EXPECT_EQ(hash(back.mesh), hash(mesh.mesh));
  ASSERT_EQ(back.groups.size(), mesh.groups.size());
  for (const auto& [name, group] : mesh.groups) {
    EXPECT_EQ(back.groups.at(name).nodes, group.nodes) << name;
    EXPECT_EQ(back.groups.at(name).tetrahedra, group.tetrahedra) << name;
    EXPECT_EQ(back.groups.at(name).triangles.cols(), group.triangles.cols()) << name;
  }
}

TEST_P(GmshForms, MiddlesOfCurvedEdgesComeBackToTheBit) {
  const MeshWithGroups mesh = make_ellipsoid({0.05, 0.03, 0.03}, 2, RoundSides::kCurved);
  const MeshWithGroups back = gmsh_trip(mesh, format(ElementOrder::kQuadratic));
  EXPECT_EQ(hash(back.mesh), hash(mesh.mesh));
  const ElementMesh before = element_mesh(mesh, ElementOrder::kQuadratic),
                    after = element_mesh(back, ElementOrder::kQuadratic);
  EXPECT_EQ(before.nodes, after.nodes);
  EXPECT_EQ(before.elements, after.elements);
  EXPECT_GT(curved_volume(back.mesh, back.middles), check(back.mesh).volume * 1.01);
}

TEST_P(GmshForms, OfATetrahedronInTwoGroupsVersionFourKeepsBoth) {
  MeshWithGroups mesh{make_box({1, 1, 1}, {1, 1, 1}), {}, {}};
  mesh.groups["a"].tetrahedra = {0, 1, 2};
  mesh.groups["b"].tetrahedra = {2, 3};
  const MeshWithGroups back = gmsh_trip(mesh, format());
  const bool is_old = format().version == GmshVersion::k2_2;
  EXPECT_EQ(back.groups.at("a").tetrahedra.size(), 3u);
  EXPECT_EQ(back.groups.at("b").tetrahedra.size(), is_old ? 1u : 2u);
  EXPECT_EQ(back.mesh.tetrahedron_count(), 6);
}

INSTANTIATE_TEST_SUITE_P(All, GmshForms,
                         ::testing::Combine(::testing::Values(GmshVersion::k2_2, GmshVersion::k4_1),
                                            ::testing::Values(Encoding::kText, Encoding::kBinary)));

TEST(GmshBinary, CutAnywhereItIsRefused) {
  std::ostringstream out;
  write_gmsh(make_cylinder(0.02, 0.1, 1, 2, RoundSides::kFull),
             {GmshVersion::k4_1, Encoding::kBinary, ElementOrder::kLinear}, out);
  const std::string whole = out.str();
  const std::size_t needed = whole.find("$EndElements");
  for (std::size_t length = 0; length < needed; length += 7) {
    std::istringstream stream(whole.substr(0, length));
    EXPECT_THROW(read_gmsh(stream, "a.msh"), ParseError) << length;
  }
}

TEST(TetgenWriter, MeshesComeBackToTheBitFromEitherBase) {
  RandomMeshes random(2);
  for (int i = 0; i < kWritersMeshes; ++i) {
    const TetrahedralMesh mesh = random.make();
    std::stringstream node, ele;
    write_tetgen(mesh, i % 2, node, ele);
    ASSERT_EQ(hash(read_tetgen(node, "a.node", ele, "a.ele").mesh), hash(mesh)) << i;
  }
}

TEST(VegaWriter, MeshesAndSetsComeBackFromEitherBase) {
  RandomMeshes random(3);
  for (int i = 0; i < kWritersMeshes; ++i) {
    MeshWithGroups mesh{random.make(), {}, {}};
    for (int t = 0; t < mesh.mesh.tetrahedron_count(); t += 2)
      mesh.groups["half of it"].tetrahedra.push_back(t);
    std::stringstream stream;
    write_vega(mesh, {}, i % 2, stream);
    const MeshWithGroups back =
        read_vega(stream, "a.veg", [](const std::string&) { return std::string(); });
    ASSERT_EQ(hash(back.mesh), hash(mesh.mesh)) << i;
    ASSERT_EQ(back.groups.at("half_of_it").tetrahedra, mesh.groups["half of it"].tetrahedra) << i;
  }
}

TEST(Writers, RefuseWhatCannotBeWritten) {
  MeshWithGroups mesh{make_box({1, 1, 1}, {1, 1, 1}), {}, {}};
  mesh.mesh.tetrahedra(0, 0) = -1;
  std::ostringstream out;
  EXPECT_THROW(write_gmsh(mesh, {}, out), std::invalid_argument);
  EXPECT_THROW(write_tetgen(mesh.mesh, 2, out, out), std::invalid_argument);
}

TEST(MixedCells, AreRefusedByNumberUnlessFaultsAreKept) {
  const std::string text =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n"
      "5 0 0 1\n6 1 0 1\n7 1 1 1\n8 0 1 1\n$EndNodes\n$Elements\n1\n9 5 0 1 2 3 4 5 6 7 8\n"
      "$EndElements\n";
  std::istringstream strict(text), kept(text);
  try {
    read_gmsh(strict, "a.msh");
    FAIL();
  } catch (const ParseError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("a.msh:17: element 9 is a hexahedron"));
  }
  const MeshWithGroups mesh = read_gmsh(kept, "a.msh", OnFault::kKeep);
  ASSERT_EQ(mesh.others.size(), 1u);
  EXPECT_EQ(mesh.others[0].number, 9);
}

}  // namespace
}  // namespace palpate::mesh

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "core/mesh/mesh_formats.hpp"

namespace palpate::mesh {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

// Every format holds the same mesh: two tetrahedra on the triangle 1 2 3.
const char* kNodes0 =
    "# made by hand\n5 3 0 0\n0 0 0 0\n1 1 0 0 # x\n2 0 1 0\n\n3 0 0 1\n4 1 1 1\n";
const char* kElements0 = "2 4 1\n0 0 1 2 3 7\n1 4 2 1 3 7\n";
const char* kNodes1 = "5 3 1 1\n1 0 0 0 9 1\n2 1 0 0 9 1\n3 0 1 0 9 1\n4 0 0 1 9 1\n5 1 1 1 9 0\n";
const char* kElements1 = "2 4 0\n1 1 2 3 4\n2 5 3 2 4\n";

void expect_two_tetrahedra(const TetrahedralMesh& mesh) {
  Eigen::Matrix3Xd nodes(3, 5);
  nodes << 0, 1, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 0, 1, 1;
  Eigen::Matrix4Xi tetrahedra(4, 2);
  tetrahedra << 0, 4, 1, 2, 2, 1, 3, 3;
  ASSERT_EQ(mesh.node_count(), 5);
  ASSERT_EQ(mesh.tetrahedron_count(), 2);
  EXPECT_EQ(mesh.nodes, nodes);
  EXPECT_EQ(mesh.tetrahedra, tetrahedra);
}

/// Error text of the parser for an invalid text; empty if it was accepted.
template <typename Read>
std::string error_of(Read read) {
  try {
    read();
  } catch (const ParseError& error) {
    return error.what();
  }
  return "";
}

TetrahedralMesh tetgen(const std::string& node, const std::string& ele) {
  std::istringstream nodes(node), elements(ele);
  return read_tetgen(nodes, "a.node", elements, "a.ele").mesh;
}

MeshWithGroups gmsh(const std::string& text) {
  std::istringstream stream(text);
  return read_gmsh(stream, "a.msh");
}

MeshWithGroups vega(const std::string& text) {
  std::istringstream stream(text);
  return read_vega(stream, "a.veg", [](const std::string& name) -> std::string {
    if (name == "nodes file") return kNodes1;
    if (name == "a.ele") return kElements1;
    if (name == "bad.ele") return "2 4 0\n1 1 2 3 9\n";
    throw std::runtime_error(name + " is not there");
  });
}

TEST(TetGen, ReadsBothNumberings) {
  expect_two_tetrahedra(tetgen(kNodes0, kElements0));
  expect_two_tetrahedra(tetgen(kNodes1, kElements1));
}

TEST(TetGen, TakesTheCornersOfQuadraticElements) {
  const TetrahedralMesh mesh = tetgen(kNodes0, "1 10 0\n0 0 1 2 3 4 4 4 4 4 4\n");
  EXPECT_EQ(mesh.tetrahedra, Eigen::Vector4i(0, 1, 2, 3));
}

TEST(TetGen, ErrorsNameFileAndLine) {
  const std::string n = kNodes0, e = kElements0;
  EXPECT_THAT(error_of([&] { tetgen("", e); }), StartsWith("a.node:0: "));
  EXPECT_THAT(error_of([&] { tetgen("2 3\n0 0 0 0\n", e); }),
              AllOf(StartsWith("a.node:2: "), HasSubstr("node 2 of 2")));
  EXPECT_THAT(error_of([&] { tetgen("1 3\n0 0 zero 0\n", e); }),
              AllOf(StartsWith("a.node:2: "), HasSubstr("zero")));
  EXPECT_THAT(error_of([&] { tetgen("1 3\n0 0 0\n", e); }), HasSubstr("columns"));
  EXPECT_THAT(error_of([&] { tetgen("1 3\n0 0 nan 0\n", e); }), HasSubstr("finite"));
  EXPECT_THAT(error_of([&] { tetgen("1 3\n2 0 0 0\n", e); }), HasSubstr("0 or 1"));
  EXPECT_THAT(error_of([&] { tetgen("2 3\n0 0 0 0\n2 0 0 0", e); }), StartsWith("a.node:3: "));
  EXPECT_THAT(error_of([&] { tetgen("1 2\n0 0 0\n", e); }), HasSubstr("dimensions"));
  EXPECT_THAT(error_of([&] { tetgen("-1 3\n", e); }), HasSubstr("count"));
  EXPECT_THAT(error_of([&] { tetgen("99999999 3\n", e); }), HasSubstr("ends"));
  EXPECT_THAT(error_of([&] { tetgen(n, "1 4\n0 0 1 2 5\n"); }),
              AllOf(StartsWith("a.ele:2: "), HasSubstr("no node 5")));
  EXPECT_THAT(error_of([&] { tetgen(kNodes1, "1 4\n0 0 1 2 3\n"); }), HasSubstr("no node 0"));
  EXPECT_THAT(error_of([&] { tetgen(n, "1 3\n0 0 1 2\n"); }), HasSubstr("4 or 10"));
}

const char* kGmsh2 = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
2 3 "held face"
3 1 "body"
$EndPhysicalNames
$Comments
4 anything
$EndComments
$Nodes
6
10 0 0 0
20 1 0 0
30 0 1 0
40 0 0 1
50 1 1 1
60 9 9 9
$EndNodes
$Elements
5
1 15 2 0 1 60
2 2 2 3 5 10 30 20
3 2 2 4 6 10 20 40
4 4 2 1 1 10 20 30 40
5 4 2 1 1 50 30 20 40
$EndElements
)";

const char* kGmsh4 = R"($MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
2
2 3 "held face"
3 1 "body"
$EndPhysicalNames
$Entities
1 0 2 1
7 9 9 9 0
5 0 0 0 1 1 0 1 3 0
6 0 0 0 1 0 1 1 4 0
1 0 0 0 1 1 1 1 1 2 5 6
$EndEntities
$Nodes
2 6 10 60
2 5 0 3
10
20
30
0 0 0
1 0 0
0 1 0
3 1 0 3
40
50
60
0 0 1
1 1 1
9 9 9
$EndNodes
$Elements
3 4 1 4
2 5 2 1
1 10 30 20
2 6 2 1
2 10 20 40
3 1 4 2
3 10 20 30 40
4 50 30 20 40
$EndElements
)";

class Gmsh : public ::testing::TestWithParam<const char*> {};

TEST_P(Gmsh, ReadsMeshAndGroups) {
  const MeshWithGroups result = gmsh(GetParam());
  expect_two_tetrahedra(result.mesh);
  ASSERT_EQ(result.groups.size(), 3u);
  const MeshGroup& held = result.groups.at("held face");
  EXPECT_EQ(held.triangles, Eigen::Vector3i(0, 2, 1));
  EXPECT_THAT(held.nodes, ElementsAre(0, 1, 2));
  EXPECT_TRUE(held.tetrahedra.empty());
  EXPECT_THAT(result.groups.at("4").nodes, ElementsAre(0, 1, 3));  // a group without a name
  EXPECT_THAT(result.groups.at("body").tetrahedra, ElementsAre(0, 1));
  EXPECT_THAT(result.groups.at("body").nodes, ElementsAre(0, 1, 2, 3, 4));
}

TEST_P(Gmsh, CutAnywhereItIsRefused) {
  const std::string text = GetParam();
  // Up to the last line, whose end marks the file as complete.
  const std::size_t last = text.rfind("$EndElements");
  for (std::size_t size = 0; size < last + 5; ++size) {
    EXPECT_NE(error_of([&] { gmsh(text.substr(0, size)); }), "") << text.substr(0, size);
  }
}

INSTANTIATE_TEST_SUITE_P(Versions, Gmsh, ::testing::Values(kGmsh2, kGmsh4));

TEST(GmshTenNodes, MiddlesOfEdgesAreKept) {
  std::string text =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n10\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n";
  // Edges 12, 23, 31, 41, 43, 42.
  text += "5 0.5 -1 0\n6 0.5 0.5 0\n7 0 0.5 0\n8 0 0 0.5\n9 0 0.5 0.5\n10 0.5 0 0.5\n$EndNodes\n";
  text += "$Elements\n1\n1 11 2 1 1 1 2 3 4 5 6 7 8 9 10\n$EndElements\n";
  const MeshWithGroups result = gmsh(text);
  EXPECT_EQ(result.mesh.node_count(), 4);
  ASSERT_EQ(result.middles.size(), 6u);
  EXPECT_EQ(result.middles.at({0, 1}), Eigen::Vector3d(0.5, -1, 0));
  EXPECT_EQ(result.middles.at({2, 3}), Eigen::Vector3d(0, 0.5, 0.5));
  EXPECT_EQ(result.middles.at({1, 3}), Eigen::Vector3d(0.5, 0, 0.5));
  text.replace(text.find("8 9 10\n"), 7, "8 9 11\n");
  EXPECT_THAT(error_of([&] { gmsh(text); }), HasSubstr("no node 11"));
}

TEST(GmshErrors, AnEntityInManyGroupsIsRefusedBeforeEachElementIs) {
  std::string entities =
      "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 1\n1 0 0 0 1 1 1 101";
  for (int i = 0; i < 101; ++i) entities += " " + std::to_string(i + 1);
  EXPECT_THAT(error_of([&] { gmsh(entities + " 0\n$EndEntities\n"); }),
              AllOf(StartsWith("a.msh:6: "), HasSubstr("too many physical groups")));
}

TEST(GmshErrors, NameFileAndLine) {
  const std::string good = kGmsh2;
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    return text.replace(text.find(from), from.size(), to);
  };
  EXPECT_THAT(error_of([&] { gmsh(changed("2.2 0", "3 0")); }),
              AllOf(StartsWith("a.msh:2: "), HasSubstr("2.x, 4.1")));
  EXPECT_THAT(error_of([&] { gmsh(changed("2.2 0", "2.2 1")); }), HasSubstr("binary"));
  EXPECT_THAT(error_of([&] { gmsh(changed("50 30 20 40", "50 30 20 41")); }),
              AllOf(StartsWith("a.msh:27: "), HasSubstr("no node 41")));
  EXPECT_THAT(error_of([&] { gmsh(changed("20 1 0 0", "10 1 0 0")); }), HasSubstr("twice"));
  EXPECT_THAT(error_of([&] { gmsh(changed("$EndNodes", "70 0 0 0")); }), HasSubstr("$EndNodes"));
  EXPECT_THAT(error_of([&] { gmsh(changed("\"body\"", "body")); }), HasSubstr("quotes"));
  EXPECT_THAT(error_of([&] { gmsh(changed("$MeshFormat", "$Nodes")); }), HasSubstr("$MeshFormat"));
  EXPECT_THAT(error_of([&] { gmsh(changed("20 1 0 0", "20 1 inf 0")); }), HasSubstr("finite"));
}

const std::string kMaterial = "*MATERIAL BODY\nENU, 26, 3000, 0.15\n\n*REGION\nallElements, BODY\n";

TEST(Vega, ReadsBothNumberingsInPlace) {
  expect_two_tetrahedra(
      vega("*VERTICES\n" + std::string(kNodes0) + "*ELEMENTS\nTETS\n" + kElements0 + kMaterial)
          .mesh);
  expect_two_tetrahedra(
      vega(kMaterial + "*VERTICES\n" + std::string(kNodes1) + "*ELEMENTS\nTET\n" + kElements1)
          .mesh);
}

TEST(Vega, FollowsIncludes) {
  expect_two_tetrahedra(
      vega("*VERTICES\n*INCLUDE nodes file \n*ELEMENTS\nTETS\n*INCLUDE a.ele\n" + kMaterial).mesh);
}

TEST(Vega, ReadsSets) {
  const MeshWithGroups result = vega("*VERTICES\n" + std::string(kNodes1) + "*ELEMENTS\nTETS\n" +
                                     kElements1 + "*SET stiff\n2,\n*SET all\n1, 2\n" + kMaterial);
  EXPECT_THAT(result.groups.at("stiff").tetrahedra, ElementsAre(1));
  EXPECT_THAT(result.groups.at("stiff").nodes, ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(result.groups.at("all").tetrahedra, ElementsAre(0, 1));
}

TEST(Vega, ErrorsNameFileAndLine) {
  const std::string vertices = "*VERTICES\n*INCLUDE nodes file\n";
  EXPECT_THAT(error_of([&] { vega("*VERTICES\n*INCLUDE none.node\n"); }),
              AllOf(StartsWith("a.veg:2: "), HasSubstr("none.node")));
  EXPECT_THAT(error_of([&] { vega(vertices + "*ELEMENTS\nTETS\n*INCLUDE bad.ele\n"); }),
              AllOf(StartsWith("bad.ele:2: "), HasSubstr("no node 9")));
  EXPECT_THAT(error_of([&] { vega(vertices + "*ELEMENTS\nCUBIC\n"); }),
              AllOf(StartsWith("a.veg:4: "), HasSubstr("CUBIC")));
  EXPECT_THAT(error_of([&] { vega("*ELEMENTS\nTETS\n"); }), HasSubstr("before *VERTICES"));
  EXPECT_THAT(error_of([&] { vega(vertices); }), HasSubstr("no *ELEMENTS"));
  // Fewer vertices than the elements name, fewer elements than a set.
  const std::string whole = vertices + "*ELEMENTS\nTETS\n*INCLUDE a.ele\n";
  EXPECT_THAT(error_of([&] { vega(whole + "*VERTICES\n1 3\n1 0 0 0\n"); }),
              AllOf(StartsWith("a.veg:6: "), HasSubstr("twice")));
  EXPECT_THAT(error_of([&] { vega(whole + "*ELEMENTS\nTETS\n0 4\n"); }), HasSubstr("twice"));
  EXPECT_THAT(error_of([&] { vega(""); }), HasSubstr("no *VERTICES"));
  EXPECT_THAT(error_of([&] { vega(vertices + "*ELEMENTS\nTETS\n*INCLUDE a.ele\n*SET s\n1, 3\n"); }),
              AllOf(StartsWith("a.veg:7: "), HasSubstr("no element 3")));
}

}  // namespace
}  // namespace palpate::mesh

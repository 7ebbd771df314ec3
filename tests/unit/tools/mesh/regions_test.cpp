// Groups of a mesh while they are changed, and the program that changes them, read by the daemon.

#include "tools/mesh/regions.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <stdexcept>

#include "core/mesh/grid_mesh.hpp"
#include "core/mesh/round_mesh.hpp"
#include "rt/config/node.hpp"
#include "rt/registry/frames.hpp"
#include "rt/registry/object.hpp"
#include "sim/draw/image.hpp"
#include "tests/unit/tools/mesh/mesh_folder.hpp"
#include "tools/mesh/mesh_files.hpp"

namespace palpate::mesh_tool {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

mesh::MeshWithGroups bar_mesh() {
  mesh::MeshWithGroups made;
  made.mesh = mesh::make_box({0.4, 0.1, 0.1}, {8, 2, 2});
  return made;
}

std::vector<int> part_of(const Regions& regions, RegionKind kind, double from, double to) {
  return regions.selection().inside(kind, box_space({from, 0, 0}, {to, 1, 1}));
}

std::string fault_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(Regions, MembersAreReplacedAddedAndRemoved) {
  Regions regions(bar_mesh());
  constexpr auto kFaces = RegionKind::kFaces;
  regions.edit("clamp", kFaces, RegionEdit::kReplace, part_of(regions, kFaces, 0, 0.1));
  RegionSize size = regions.size("clamp");
  EXPECT_EQ(size.faces, 40);
  EXPECT_EQ(size.elements, 0);
  EXPECT_NEAR(size.area, 0.05, 1e-12);
  EXPECT_EQ(size.nodes, 9 + 8 + 8) << "those of the end, and of the outline of two sections";
  regions.edit("clamp", kFaces, RegionEdit::kAdd, part_of(regions, kFaces, 0.1, 0.2));
  EXPECT_EQ(regions.members("clamp", kFaces), part_of(regions, kFaces, 0, 0.2));
  regions.edit("clamp", kFaces, RegionEdit::kRemove, part_of(regions, kFaces, 0, 0.15));
  EXPECT_EQ(regions.members("clamp", kFaces), part_of(regions, kFaces, 0.15, 0.2));
  regions.edit("clamp", kFaces, RegionEdit::kRemove, regions.selection().all(kFaces));
  EXPECT_EQ(regions.groups().count("clamp"), 0u) << "no empty group remains";

  regions.edit("core", RegionKind::kElements, RegionEdit::kReplace,
               part_of(regions, RegionKind::kElements, 0.1, 0.3));
  size = regions.size("core");
  EXPECT_EQ(size.elements, 4 * 2 * 2 * 6);
  EXPECT_NEAR(size.volume, 0.002, 1e-12);
  EXPECT_EQ(size.nodes, 5 * 9);
  EXPECT_EQ(regions.kind_of("core"), RegionKind::kElements);
  // Seen from outside by its four sides.
  EXPECT_EQ(regions.outer_faces("core").size(), 4u * 4 * 2 * 2);
  EXPECT_NEAR(regions.whole().area, 0.18, 1e-12);
  EXPECT_NEAR(regions.whole().volume, 0.004, 1e-12);
}

TEST(Regions, TrianglesInsideTheBodyAreKept) {
  mesh::MeshWithGroups bar = bar_mesh();
  const Eigen::Vector3i inside(bar.mesh.tetrahedra(0, 0), bar.mesh.tetrahedra(3, 0),
                               bar.mesh.tetrahedra(1, 0));
  bar.groups["wall"].triangles = inside;
  bar.groups["wall"].nodes = {inside[0], inside[1], inside[2]};
  Regions regions(std::move(bar));
  ASSERT_TRUE(regions.members("wall", RegionKind::kFaces).empty()) << "not of the boundary";
  const std::vector<int> end = part_of(regions, RegionKind::kFaces, 0, 0);
  regions.edit("wall", RegionKind::kFaces, RegionEdit::kAdd, end);
  EXPECT_EQ(regions.groups().at("wall").triangles.cols(), 9);
  regions.edit("wall", RegionKind::kFaces, RegionEdit::kReplace, end);
  EXPECT_EQ(regions.groups().at("wall").triangles.cols(), 8);
}

TEST(Regions, FaultsAreNamedAndChangeNothing) {
  Regions regions(bar_mesh());
  const auto edit = [&](const std::string& name, RegionEdit how, std::vector<int> members) {
    return fault_of([&] { regions.edit(name, RegionKind::kFaces, how, members); });
  };
  EXPECT_THAT(edit("clamp", RegionEdit::kReplace, {}), HasSubstr("no face of the surface"));
  EXPECT_THAT(edit("clamp", RegionEdit::kRemove, {1}), HasSubstr("no group 'clamp'; it has none"));
  for (const std::string name : {"", "a\"b", "a\nb", " a", "a "})
    EXPECT_THAT(edit(name, RegionEdit::kReplace, {1}), HasSubstr("not a name")) << name;
  EXPECT_TRUE(regions.groups().empty());
  EXPECT_EQ(edit("clamp", RegionEdit::kReplace, {1}), "");
  EXPECT_THAT(fault_of([&] { regions.erase("clamps"); }),
              HasSubstr("no group 'clamps'; it has clamp"));
}

TEST(Regions, PlacesHeldTwiceAreFound) {
  Regions regions(bar_mesh());
  constexpr auto kFaces = RegionKind::kFaces;
  const auto set = [&](const std::string& name, double from, double to) {
    regions.edit(name, kFaces, RegionEdit::kReplace, part_of(regions, kFaces, from, to));
  };
  set("clamp", 0, 0.1);
  set("grasp", 0.3, 0.4);
  set("surface", 0, 0.4);
  EXPECT_EQ(regions.conflict(), "");
  set("grasp", 0.1, 0.2);  // the eight nodes of the outline at 0.1
  EXPECT_THAT(regions.conflict(), HasSubstr("clamp and grasp share 8 nodes"));
  set("second_grasp", 0.2, 0.3);
  EXPECT_THAT(regions.conflict(), HasSubstr("grasp and second_grasp share 8 nodes"));
}

TEST(Regions, ConfigurationNamesTheGroups) {
  Regions regions(bar_mesh());
  EXPECT_EQ(regions.configuration("bar.msh"), "object: {mesh: {file: bar.msh}}");
  const auto set = [&](const std::string& name, RegionKind kind, double from, double to) {
    regions.edit(name, kind, RegionEdit::kReplace, part_of(regions, kind, from, to));
  };
  set("clamp", RegionKind::kFaces, 0, 0.1);
  set("grasp", RegionKind::kFaces, 0.3, 0.4);
  set("surface", RegionKind::kFaces, 0.1, 0.3);
  set("hard half", RegionKind::kElements, 0, 0.2);
  set("body", RegionKind::kElements, 0, 0.4);  // another stiffness of all is none of a part
  EXPECT_EQ(regions.configuration("a bar.msh"),
            "object: {mesh: {file: 'a bar.msh'}, fixed_group: clamp, grasp_group: grasp, "
            "material: {regions: [{group: 'hard half', factor: 1}]}}");
}

TEST(Regions, CurvedEdgesAreKeptInTheFile) {
  support::ScratchFolder folder;
  const std::string file = (folder.path() / "rod.msh").string();
  const mesh::MeshWithGroups rod = mesh::make_cylinder(0.02, 0.1, 2, 4, mesh::RoundSides::kCurved);
  ASSERT_FALSE(rod.middles.empty());
  Regions regions(rod);
  regions.edit("clamp", RegionKind::kFaces, RegionEdit::kReplace,
               regions.selection().facing({-1, 0, 0}, 0.1));
  write_regions(regions, file);
  const mesh::MeshWithGroups again = read_volume(file, 1);
  EXPECT_EQ(again.mesh.nodes, rod.mesh.nodes);
  for (const auto& [edge, middle] : rod.middles) EXPECT_EQ(again.middles.at(edge), middle);
  EXPECT_EQ(Regions(again).size("clamp").faces, regions.size("clamp").faces);
  EXPECT_NEAR(Regions(again).size("clamp").area, regions.size("x_min").area, 1e-15);
  EXPECT_THROW(write_regions(regions, (folder.path() / "rod.vtu").string()), std::runtime_error);
}

/// The program, and the daemon's loader on what it wrote.
class RegionProgram : public MeshFolder {
 protected:
  void SetUp() override {
    ASSERT_EQ(
        run({"box", path("bar.msh"), "--size", "0.4", "0.1", "0.1", "--cells", "8", "2", "2"}), 0)
        << output();
  }
  int regions(std::vector<std::string> more) const {
    more.insert(more.begin(), {"regions", path("bar.msh")});
    return run(more);
  }
  int make(const std::string& group, const std::vector<std::string>& selection) const {
    std::vector<std::string> words{"--group", group, "--output", path("bar.msh")};
    words.insert(words.end(), selection.begin(), selection.end());
    return regions(words);
  }
  registry::Object load(const std::string& more) const {
    return registry::read_object(
        config::Node::from_text("object:\n  mesh: {file: " + path("bar.msh") +
                                    "}\n  material: {young_modulus: 30e3, poisson_ratio: 0.3, "
                                    "density: 26, regions: [{group: core, factor: 3}]}\n" +
                                    more,
                                "bar.yaml"),
        registry::Frames());
  }
};

TEST_F(RegionProgram, GroupsAreReadByTheDaemonAsBoxesAre) {
  ASSERT_EQ(make("clamp", {"--side", "-1", "0", "0"}), 0) << output();
  ASSERT_EQ(make("grasp", {"--connected", "0.4", "0.05", "0.05"}), 0) << output();
  ASSERT_EQ(make("core", {"--of", "elements", "--box", "0.1", "0", "0", "0.2", "1", "1"}), 0)
      << output();
  EXPECT_THAT(output(), HasSubstr("fixed_group: clamp, grasp_group: grasp, material: {regions: "
                                  "[{group: core, factor: 1}]}"));
  const registry::Object by_group = load("  fixed_group: clamp\n  grasp_group: grasp\n");
  const registry::Object by_box = load(
      "  fixed_box: {lower: [0, 0, 0], upper: [0, 1, 1]}\n"
      "  grasp_box: {lower: [0.4, 0, 0], upper: [0.4, 1, 1]}\n");
  EXPECT_EQ(by_group.body.fixed_nodes.size(), 25u) << "9 corners, 16 middles of edges";
  EXPECT_EQ(by_group.body.fixed_nodes, by_box.body.fixed_nodes);
  EXPECT_EQ(by_group.body.grasps[0].nodes, by_box.body.grasps[0].nodes);
  int stiff = 0;
  for (int e = 0; e < by_group.body.mesh.element_count(); ++e)
    stiff += by_group.body.material_of(e).young_modulus > 30e3 ? 1 : 0;
  EXPECT_EQ(stiff, 2 * 2 * 2 * 6);
}

TEST_F(RegionProgram, OptionsSelectWhatTheyHaveInCommon) {
  const auto faces = [&](const std::vector<std::string>& selection) {
    std::vector<std::string> words{"regions", path("bar.msh"), "--group", "part"};
    words.insert(words.end(), selection.begin(), selection.end());
    const nlohmann::json group = run_json(words)["groups"]["part"];
    return std::make_pair(group["faces"].get<int>(), group["area_m2"].get<double>());
  };
  EXPECT_EQ(faces({"--all"}).first, 144);
  const auto top = faces({"--side", "0", "0", "1", "--half-space", "0.2", "0", "0", "1", "0", "0"});
  EXPECT_EQ(top.first, 16);
  EXPECT_NEAR(top.second, 0.02, 1e-12);
  EXPECT_EQ(faces({"--side", "0", "0", "1", "--sphere", "0", "0", "0.1", "0.071"}).first, 2);
  EXPECT_EQ(faces({"--box", "0", "0", "0", "0", "1", "1", "--grow", "2"}).first, 40);
  EXPECT_EQ(faces({"--connected", "0.2", "0.05", "0.1", "--angle", "90"}).first, 144);
  const nlohmann::json elements = run_json({"regions", path("bar.msh"), "--group", "part", "--of",
                                            "elements", "--side", "-1", "0", "0"});
  EXPECT_EQ(elements["groups"]["part"]["elements"], 8);
  EXPECT_NEAR(elements["whole"]["volume_m3"], 0.004, 1e-12);
  EXPECT_EQ(regions({"--list"}), 0);
  EXPECT_THAT(output(), testing::Not(HasSubstr("part"))) << "nothing was written";
}

TEST_F(RegionProgram, GroupsAreExtendedReducedAndDeleted) {
  ASSERT_EQ(make("pad", {"--box", "0", "0", "0", "0.1", "1", "1"}), 0);
  ASSERT_EQ(make("pad", {"--box", "0.1", "0", "0", "0.2", "1", "1", "--add"}), 0);
  ASSERT_EQ(make("pad", {"--side", "-1", "0", "0", "--remove"}), 0);
  EXPECT_EQ(run_json({"regions", path("bar.msh"), "--list"})["groups"]["pad"]["faces"], 4 * 16);
  EXPECT_EQ(make("pad", {"--side", "1", "0", "0", "--delete", "pad"}), 0);
  EXPECT_EQ(run_json({"regions", path("bar.msh")})["groups"]["pad"]["faces"], 8);
  EXPECT_EQ(regions({"--delete", "pad", "--delete", "x_min", "--output", path("less.msh")}), 0);
  const mesh::MeshWithGroups less = read_volume(path("less.msh"), 1);
  EXPECT_EQ(less.groups.count("pad") + less.groups.count("x_min"), 0u);
  EXPECT_EQ(less.groups.at("x_max").triangles.cols(), 8);
}

TEST_F(RegionProgram, FaultsAreNamedAndNothingIsWritten) {
  const std::string before = text_of("bar.msh");
  const auto says = [&](int code, const std::vector<std::string>& words, const std::string& what) {
    EXPECT_EQ(regions(words), code) << output();
    EXPECT_THAT(output(), HasSubstr(what));
    EXPECT_EQ(text_of("bar.msh"), before);
  };
  const std::string out = path("bar.msh");
  says(1, {"--group", "clamp", "--box", "5", "0", "0", "6", "1", "1", "--output", out},
       "the selection holds no whole face; the mesh extends x from 0 to 0.4, y from 0 to 0.1");
  says(1, {"--group", "clamp", "--output", out}, "needs a selection");
  says(1, {"--group", "clamp", "--all", "--remove", "--output", out}, "no group 'clamp'; it has");
  says(1, {"--delete", "clamp", "--output", out}, "no group 'clamp'; it has");
  says(1, {"--group", "clamp", "--all", "--output", path("bar.vtu")}, "allowed: .msh");
  says(1, {"--group", "clamp", "--sphere", "0", "0", "0", "0", "--output", out}, "not positive");
  says(64, {"--grow", "1"}, "--grow");
  says(64, {"--group", "clamp", "--of", "nodes", "--all"}, "--of");
  says(64, {"--list", "--group", "clamp", "--all"}, "--list");
  ASSERT_EQ(regions({"--group", "clamp", "--side", "-1", "0", "0", "--output", path("c.msh")}), 0);
  EXPECT_EQ(run({"regions", path("c.msh"), "--group", "grasp", "--side", "0", "0", "1", "--output",
                 path("d.msh")}),
            1);
  EXPECT_THAT(output(), HasSubstr("clamp and grasp share 3 nodes"));
  EXPECT_FALSE(std::filesystem::exists(path("d.msh")));
  write("broken.msh",
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 "
        "0\n4 1 1 0\n$EndNodes\n$Elements\n1\n1 4 2 0 1 1 2 3 4\n$EndElements\n");
  EXPECT_EQ(run({"regions", path("broken.msh")}), 65);
  EXPECT_THAT(output(), AllOf(HasSubstr("rejected"), HasSubstr("palpate-mesh repair")));
}

TEST_F(RegionProgram, APictureShowsTheGroupsInTheirColours) {
  ASSERT_EQ(make("clamp", {"--box", "0", "0", "0", "0.2", "1", "1"}), 0);
  const auto coloured = [&](const std::vector<std::string>& words) {
    std::vector<std::string> all{"--picture", path("picture.png")};
    all.insert(all.end(), words.begin(), words.end());
    EXPECT_EQ(regions(all), 0) << output();
    const draw::Image image = draw::read_png(path("picture.png"));
    int red = 0;
    for (int y = 34; y < image.height - 200; ++y)  // neither title nor legend
      for (int x = 0; x < image.width; ++x) {
        const std::uint8_t* c = image.pixel(x, y);
        red += c[0] > 90 && c[0] > 1.8 * c[1] && c[0] > 1.8 * c[2] ? 1 : 0;
      }
    return red;
  };
  const int half = coloured({}), none = coloured({"--delete", "clamp"});
  EXPECT_GT(half, 10000);
  EXPECT_EQ(none, 0);
  const int quarter = coloured({"--group", "clamp", "--box", "0", "0", "0", "0.1", "1", "1"});
  EXPECT_NEAR(static_cast<double>(quarter) / half, 0.55, 0.2);
}

}  // namespace
}  // namespace palpate::mesh_tool

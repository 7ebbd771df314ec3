// The program from the user's view: its messages, files and images for valid and faulty meshes.

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <filesystem>

#include "core/mesh/grid_mesh.hpp"
#include "core/mesh/mesh_writer.hpp"
#include "core/mesh/report.hpp"
#include "core/mesh/round_mesh.hpp"
#include "sim/draw/image.hpp"
#include "tests/unit/tools/mesh/mesh_folder.hpp"
#include "tools/mesh/faults.hpp"
#include "tools/mesh/mesh_files.hpp"

namespace palpate::mesh_tool {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// Number of pixels with the colour of faults in images, under any lighting.
int red_pixels(const std::string& png) {
  const draw::Image image = draw::read_png(png);
  int count = 0;
  for (int y = 34; y < image.height - 60; ++y) {  // neither title nor legend
    for (int x = 0; x < image.width; ++x) {
      const std::uint8_t* c = image.pixel(x, y);
      count += c[0] > 100 && c[0] > 2 * c[1] && c[0] > 2 * c[2] ? 1 : 0;
    }
  }
  return count;
}

class Program : public MeshFolder {
 protected:
  /// A bar of 4 x 2 x 2 cells, nodes and elements numbered from 1, of which a test changes a line.
  mesh::MeshWithGroups bar() const { return {mesh::make_box({0.2, 0.1, 0.1}, {4, 2, 2}), {}, {}}; }
  std::string write_mesh(const std::string& name, const mesh::MeshWithGroups& mesh) const {
    FileFormat format;
    format.gmsh.version = mesh::GmshVersion::k2_2;
    write_volume(mesh, path(name), format);
    return path(name);
  }
  static void add(mesh::TetrahedralMesh& mesh, const Eigen::Vector4i& corners) {
    Eigen::Matrix4Xi more(4, mesh.tetrahedron_count() + 1);
    more << mesh.tetrahedra, corners;
    mesh.tetrahedra = more;
  }
  static int add_node(mesh::TetrahedralMesh& mesh, const Eigen::Vector3d& p) {
    Eigen::Matrix3Xd more(3, mesh.node_count() + 1);
    more << mesh.nodes, p;
    mesh.nodes = more;
    return mesh.node_count() - 1;
  }

  /// check finds the fault, by name and number, and draws it; repair fixes it.
  void expect_repaired(const std::string& file, const std::string& kind,
                       const std::vector<long>& numbers, const std::string& step, double volume,
                       bool can_be_seen = true) {
    expect_found(file, kind, numbers, can_be_seen);
    const std::string repaired_file = path("repaired.msh");
    const nlohmann::json result = run_json({"repair", path(file), repaired_file});
    EXPECT_THAT(result["repaired"].dump(), HasSubstr(step));
    EXPECT_TRUE(result["good"]);
    const mesh::MeshWithGroups read = read_volume(repaired_file, 1);
    EXPECT_TRUE(mesh::check(read.mesh).ok()) << mesh::check(read.mesh).text();
    EXPECT_NEAR(mesh::check(read.mesh).volume, volume, 1e-12 * volume);
  }

  /// check finds the fault; repair rejects the mesh with an image and writes nothing.
  void expect_rejected(const std::string& file, const std::string& kind,
                       const std::vector<long>& numbers) {
    expect_found(file, kind, numbers, true);
    const std::string out = path("never" + std::filesystem::path(file).extension().string());
    EXPECT_EQ(run({"repair", path(file), out}), 65) << output();
    EXPECT_THAT(output(),
                AllOf(HasSubstr(path(file)), HasSubstr("rejected"), HasSubstr("error: ")));
    for (const long number : numbers) EXPECT_THAT(output(), HasSubstr(std::to_string(number)));
    EXPECT_FALSE(std::filesystem::exists(out));
    EXPECT_GT(red_pixels(out + ".faults.png"), 100);
    std::filesystem::remove(out + ".faults.png");
  }

  void expect_found(const std::string& file, const std::string& kind,
                    const std::vector<long>& numbers, bool can_be_seen) {
    const nlohmann::json result =
        run_json({"check", path(file), "--picture", path("faults.png")}, 65);
    bool found = false;
    for (const nlohmann::json& fault : result["faults"]) {
      if (fault["kind"] != kind) continue;
      found = true;
      EXPECT_EQ(fault["numbers"].get<std::vector<long>>(), numbers) << kind;
    }
    EXPECT_TRUE(found) << kind << " is not in " << result.dump(1);
    if (can_be_seen) {
      EXPECT_GT(red_pixels(path("faults.png")), 100) << kind;
    }
  }
};

constexpr double kVolume = 0.2 * 0.1 * 0.1;

TEST_F(Program, InvertedElementsAreTurned) {
  mesh::MeshWithGroups mesh = bar();
  std::swap(mesh.mesh.tetrahedra(0, 17), mesh.mesh.tetrahedra(1, 17));
  std::swap(mesh.mesh.tetrahedra(0, 60), mesh.mesh.tetrahedra(1, 60));
  write_mesh("a.msh", mesh);
  expect_repaired("a.msh", "inverted", {18, 61}, "order of corners", kVolume);
}

TEST_F(Program, AStrayedNodeIsPutBack) {
  mesh::MeshWithGroups mesh = bar();
  mesh.mesh.nodes.col(22) += Eigen::Vector3d(0.08, 0.01, 0.02);
  write_mesh("a.msh", mesh);
  expect_repaired("a.msh", "inverted", {14, 18, 39, 65, 85, 88}, "strayed", kVolume);
}

TEST_F(Program, FlatElementsArePeeled) {
  mesh::MeshWithGroups mesh = bar();
  add(mesh.mesh, Eigen::Vector4i(30, 31, 36, 35));  // the corners of a square of the upper side
  write_mesh("a.msh", mesh);
  expect_repaired("a.msh", "flat", {97}, "peeled", kVolume);
}

TEST_F(Program, NodesThatLieOnAnotherAreMerged) {
  mesh::MeshWithGroups mesh = bar();
  mesh.mesh.tetrahedra(0, 9) = add_node(mesh.mesh, mesh.mesh.nodes.col(mesh.mesh.tetrahedra(0, 9)));
  write_mesh("a.msh", mesh);
  expect_repaired("a.msh", "duplicate_node", {46}, "merged", kVolume);
}

TEST_F(Program, NodesInNoElementAreDropped) {
  mesh::MeshWithGroups mesh = bar();
  add_node(mesh.mesh, Eigen::Vector3d(0.1, 0.05, 0.2));
  write_mesh("a.msh", mesh);
  expect_repaired("a.msh", "unused_node", {46}, "in no element", kVolume);
}

TEST_F(Program, RepeatedElementsAreDropped) {
  mesh::MeshWithGroups mesh = bar();
  add(mesh.mesh, Eigen::Vector4i(mesh.mesh.tetrahedra.col(5)));
  write_mesh("a.msh", mesh);
  expect_repaired("a.msh", "repeated", {97}, "there twice", kVolume);
}

TEST_F(Program, HexahedraAreCut) {
  std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n12\n";
  for (int n = 0; n < 12; ++n) {
    text += std::to_string(n + 1) + " " + std::to_string(0.1 * (n % 3)) + " " +
            std::to_string(0.1 * (n / 3 % 2)) + " " + std::to_string(0.1 * (n / 6)) + "\n";
  }
  write("a.msh", text +
                     "$EndNodes\n$Elements\n2\n7 5 0 1 2 5 4 7 8 11 10\n"
                     "8 5 0 2 3 6 5 8 9 12 11\n$EndElements\n");
  expect_repaired("a.msh", "mixed", {7, 8}, "cut into tetrahedra", 0.2 * 0.1 * 0.1);
}

TEST_F(Program, PartsAreRejectedOrDropped) {
  mesh::MeshWithGroups mesh = bar();
  const Eigen::Vector4i first = mesh.mesh.tetrahedra.col(0);
  Eigen::Vector4i corners;
  for (int i = 0; i < 4; ++i)
    corners[i] = add_node(mesh.mesh, mesh.mesh.nodes.col(first[i]) + Eigen::Vector3d(0.3, 0, 0));
  add(mesh.mesh, corners);
  write_mesh("a.msh", mesh);
  expect_rejected("a.msh", "parts", {97});
  EXPECT_EQ(run({"repair", path("a.msh"), path("b.msh"), "--largest-part"}), 0) << output();
  EXPECT_EQ(read_volume(path("b.msh"), 1).mesh.tetrahedron_count(), 96);
}

TEST_F(Program, HingedPartsAreRejectedOrDropped) {
  mesh::MeshWithGroups mesh = bar();
  const int far = 44;
  const Eigen::Vector3d at = mesh.mesh.nodes.col(far);
  const int a = add_node(mesh.mesh, at + Eigen::Vector3d(0.05, 0, 0));
  const int b = add_node(mesh.mesh, at + Eigen::Vector3d(0, 0.05, 0));
  const int c = add_node(mesh.mesh, at + Eigen::Vector3d(0, 0, 0.05));
  add(mesh.mesh, Eigen::Vector4i(far, a, b, c));
  write_mesh("a.msh", mesh);
  expect_rejected("a.msh", "hinged_parts", {97});
  EXPECT_EQ(run({"repair", path("a.msh"), path("b.msh"), "--largest-part"}), 0) << output();
}

TEST_F(Program, OverlapsAreRejected) {
  mesh::MeshWithGroups mesh = bar();
  const Eigen::Vector4i first = mesh.mesh.tetrahedra.col(0);
  const Eigen::Vector3d middle = mesh.mesh.nodes(Eigen::all, first).rowwise().mean();
  add(mesh.mesh, Eigen::Vector4i(first[0], first[1], first[2], add_node(mesh.mesh, middle)));
  write_mesh("a.msh", mesh);
  const nlohmann::json result = run_json({"repair", path("a.msh"), path("b.msh")}, 65);
  EXPECT_EQ(result["faults"][0]["kind"], "overlap");
  EXPECT_GT(red_pixels(path("b.msh.faults.png")), 100);
}

TEST_F(Program, NumbersThatAreNoneAreRejected) {
  mesh::MeshWithGroups mesh = bar();
  mesh.mesh.nodes(1, 30) = NAN;
  write_mesh("a.msh", mesh);
  expect_rejected("a.msh", "not_finite", {31});
}

TEST_F(Program, NodesThatAreNotThereAreRejectedInEveryFormat) {
  // The last node of element 41 is replaced by a nonexistent one.
  const auto lose = [this](const std::string& name, const std::string& line) {
    std::string text = text_of(name);
    const std::size_t end = text.find('\n', text.find(line) + 1);
    text.replace(text.rfind(' ', end), end - text.rfind(' ', end), " 99");
    write(name, text);
  };
  write_mesh("a.node", bar());
  lose("a.ele", "\n41 ");
  expect_rejected("a.ele", "out_of_range", {41});
  write_mesh("b.msh", bar());
  lose("b.msh", "\n41 4 ");
  expect_rejected("b.msh", "out_of_range", {41});
  ASSERT_EQ(run({"box", path("c.veg"), "--size", "0.2", "0.1", "0.1", "--edge", "0.05"}), 0);
  std::string veg = text_of("c.veg");
  const std::size_t line = veg.find("\n41 ", veg.find("TETS"));
  const std::size_t end = veg.find('\n', line + 1);
  write("c.veg", veg.replace(veg.rfind(' ', end), end - veg.rfind(' ', end), " 99"));
  EXPECT_EQ(run({"repair", path("c.veg"), path("d.msh")}), 65);
  EXPECT_THAT(output(), HasSubstr("not there: 1 (41)"));
}

TEST_F(Program, AnotherOrderOfCornersIsNoFaultToConvert) {
  mesh::MeshWithGroups mesh = bar();
  for (int t = 0; t < mesh.mesh.tetrahedron_count(); ++t)
    std::swap(mesh.mesh.tetrahedra(0, t), mesh.mesh.tetrahedra(1, t));
  write_mesh("a.msh", mesh);
  const nlohmann::json result = run_json({"convert", path("a.msh"), path("b.veg")});
  EXPECT_THAT(result["repaired"][0]["what"], HasSubstr("order of corners"));
  EXPECT_NEAR(result["quality"]["volume_m3"], kVolume, 1e-15);
}

TEST_F(Program, UnitsThatCannotBeMeantAreWarnedOf) {
  ASSERT_EQ(run({"box", path("a.msh"), "--size", "10", "1", "1", "--cells", "10", "1", "1"}), 0);
  EXPECT_THAT(output(),
              AllOf(HasSubstr("warning: the body is 10.1 m across"), HasSubstr("--scale 0.001")));
  ASSERT_EQ(run({"check", path("a.msh"), "--scale", "cm"}), 0);
  EXPECT_THAT(output(), Not(HasSubstr("warning")));
}

TEST_F(Program, SurfacesAreRepairedOrRejected) {
  const mesh::TriangleSurface ball =
      boundary(mesh::make_ellipsoid({0.05, 0.05, 0.05}, 3, mesh::RoundSides::kFull).mesh);
  const auto expect_surface_repaired = [&](const mesh::TriangleSurface& broken,
                                           const std::string& kind, const std::string& step) {
    write_surface(broken, path("a.stl"));
    const nlohmann::json found =
        run_json({"check", path("a.stl"), "--picture", path("faults.png")}, 65);
    EXPECT_THAT(found["faults"].dump(), HasSubstr("\"" + kind + "\""));
    EXPECT_GT(red_pixels(path("faults.png")), 100) << kind;
    const nlohmann::json result = run_json({"repair", path("a.stl"), path("b.obj")});
    EXPECT_THAT(result["repaired"].dump(), HasSubstr(step));
    EXPECT_NEAR(result["volume_m3"], mesh::enclosed_volume(ball), 2e-6);
  };
  mesh::TriangleSurface hole = ball, turned = ball, inside_out = ball, twice = ball;
  hole.triangles = ball.triangles.rightCols(ball.triangle_count() - 2);
  expect_surface_repaired(hole, "hole", "close 1 hole");
  std::swap(turned.triangles(0, 7), turned.triangles(1, 7));
  expect_surface_repaired(turned, "turned", "like their neighbours");
  inside_out.triangles.row(0).swap(inside_out.triangles.row(1));
  expect_surface_repaired(inside_out, "inside_out", "inside out");
  twice.triangles.resize(3, ball.triangle_count() + 1);
  twice.triangles << ball.triangles, ball.triangles.col(3);
  expect_surface_repaired(twice, "repeated", "there twice");

  const auto reject = [&](const mesh::TriangleSurface& broken, const std::string& kind) {
    write_surface(broken, path("c.stl"));
    EXPECT_EQ(run({"repair", path("c.stl"), path("d.stl")}), 65) << output();
    const nlohmann::json found =
        run_json({"surface", path("c.stl"), path("d.msh"), "--edge", "0.02"}, 65);
    EXPECT_THAT(found["faults"].dump(), HasSubstr("\"" + kind + "\""));
    EXPECT_FALSE(std::filesystem::exists(path("d.msh")));
    EXPECT_GT(red_pixels(path("d.msh.faults.png")), 100) << kind;
  };
  mesh::TriangleSurface crossed = ball, sheet = ball, nowhere = ball;
  crossed.points.resize(3, 2 * ball.point_count());
  crossed.points << ball.points, ball.points.colwise() + Eigen::Vector3d(0.06, 0.002, 0.001);
  crossed.triangles.resize(3, 2 * ball.triangle_count());
  crossed.triangles << ball.triangles, (ball.triangles.array() + ball.point_count()).matrix();
  reject(crossed, "self_intersection");
  sheet.points.resize(3, ball.point_count() + 1);
  sheet.points << ball.points, 2 * ball.points.col(ball.triangles(0, 0));
  sheet.triangles.resize(3, ball.triangle_count() + 1);
  sheet.triangles << ball.triangles,
      Eigen::Vector3i(ball.triangles(0, 0), ball.triangles(1, 0), ball.point_count());
  reject(sheet, "non_manifold_edge");
  nowhere.points(0, 5) = INFINITY;
  reject(nowhere, "not_finite");
  mesh::TriangleSurface pinched = crossed;
  int top = 0;
  ball.points.row(0).maxCoeff(&top);
  pinched.points.rightCols(ball.point_count()) =
      ball.points.colwise() + Eigen::Vector3d(2 * ball.points(0, top), 0, 0);
  reject(pinched, "pinched");
  mesh::TriangleSurface two = crossed;
  two.points.rightCols(ball.point_count()).row(0).array() += 0.1;
  reject(two, "parts");
}

TEST_F(Program, ReportsThatGmshIsMissingSlowOrFailing) {
  ASSERT_EQ(run({"box", path("a.stl"), "--size", "0.1", "0.1", "0.1", "--edge", "0.05"}), 0);
  const auto surface = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"surface", path("a.stl"), path("b.msh"), "--edge", "0.05"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  };
  EXPECT_EQ(surface({"--gmsh", "gmsh-of-another-name"}), 1);
  EXPECT_THAT(output(), AllOf(HasSubstr("is not installed"), HasSubstr("apt-get install gmsh")));
  const auto script = [&](const std::string& text) {
    const std::string name = write("fake", "#!/bin/sh\n" + text);
    std::filesystem::permissions(name, std::filesystem::perms::owner_all);
    return name;
  };
  EXPECT_EQ(surface({"--gmsh", script("sleep 100"), "--time-limit", "0.3"}), 1);
  EXPECT_THAT(output(), HasSubstr("did not end within 0.3 s"));
  EXPECT_EQ(surface({"--gmsh", script("echo 'Error   : the moon is full'; exit 3")}), 1);
  EXPECT_THAT(output(), AllOf(HasSubstr("exit code 3"), HasSubstr("the moon is full")));
  EXPECT_FALSE(std::filesystem::exists(path("b.msh")));
}

TEST_F(Program, ReportsQualityCostAndHistograms) {
  const nlohmann::json result =
      run_json({"box", path("a.msh"), "--size", "0.1", "0.1", "0.1", "--cells", "2", "2", "2",
                "--cut", "five", "--cost", "--histograms", path("h.png")});
  const nlohmann::json& quality = result["quality"];
  EXPECT_EQ(quality["nodes"], 27);
  EXPECT_EQ(quality["tetrahedra"], 40);
  EXPECT_EQ(quality["surface_triangles"], 48);
  EXPECT_NEAR(quality["volume_m3"], 1e-3, 1e-15);
  EXPECT_NEAR(quality["area_m2"], 0.06, 1e-15);
  // Five: a regular one inside, four corners of cubes.
  EXPECT_NEAR(quality["radius_ratio"]["most"], 1, 1e-12);
  EXPECT_NEAR(quality["smallest_angle_deg"]["least"], 54.7356, 1e-4);
  EXPECT_NEAR(quality["relative_stiffness"]["least"], 1, 1e-9);
  EXPECT_GT(result["step_cost"]["order_2"]["median_s"], result["step_cost"]["order_1"]["median_s"]);
  const draw::Image picture = draw::read_png(path("h.png"));
  EXPECT_GT(picture.width, 1000);
}

TEST_F(Program, OptimisingSaysWhatItGained) {
  mesh::MeshWithGroups mesh = bar();
  mesh.mesh.nodes.col(22) += Eigen::Vector3d(0.021, 0.013, -0.016);
  write_mesh("a.msh", mesh);
  EXPECT_EQ(run({"optimise", path("a.msh"), path("b.msh")}), 0) << output();
  EXPECT_THAT(output(), HasSubstr("radius ratio at least"));
  const double before = mesh::check(mesh.mesh).quality_min,
               after = mesh::check(read_volume(path("b.msh"), 1).mesh).quality_min;
  EXPECT_GT(after, 1.5 * before);
}

TEST_F(Program, WrongCommandsAndFilesAreReported) {
  EXPECT_EQ(run({}), 64);
  EXPECT_EQ(run({"box", path("a.msh"), "--size", "0.1", "0.1"}), 64);
  EXPECT_EQ(run({"box", path("a.msh"), "--size", "0.1", "0.1", "-0.1", "--edge", "0.1"}), 64);
  EXPECT_EQ(run({"box", path("a.msh"), "--size", "1", "1", "1", "--edge", "1e-4"}), 1);
  EXPECT_THAT(output(), HasSubstr("5 million"));
  EXPECT_EQ(run({"check", path("none.msh")}), 1);
  EXPECT_THAT(output(), HasSubstr("none.msh: cannot be read"));
  EXPECT_EQ(run({"check", write("a.xyz", "")}), 1);
  EXPECT_THAT(output(), HasSubstr("allowed: .msh, .node, .ele, .veg, .vtu"));
  EXPECT_EQ(run({"check", write("b.msh", "$MeshFormat\n1 0 8\n")}), 1);
  EXPECT_THAT(output(), HasSubstr("b.msh:2: version 1"));
  EXPECT_EQ(run({"box", path("no/such/folder.msh"), "--size", "1", "1", "1", "--edge", "1"}), 1);
  EXPECT_THAT(output(), HasSubstr("folder.msh: cannot be written"));
  EXPECT_EQ(run({"box", path("a.veg"), "--size", "1", "1", "1", "--edge", "1", "--order", "2"}), 1);
  EXPECT_THAT(output(), HasSubstr(".msh and .vtu only"));
  EXPECT_EQ(run({"--help"}), 0);
  EXPECT_THAT(output(), HasSubstr("Examples:"));
}

}  // namespace
}  // namespace palpate::mesh_tool

#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <palpate/shape_mesh_v1_t.hpp>
#include <palpate/shape_v1_t.hpp>

#include "tests/unit/tools/export/python.hpp"
#include "tests/unit/tools/export/small_run.hpp"
#include "tools/export/vtu_export.hpp"

namespace palpate::exporting {
namespace {

nlohmann::json read(const std::filesystem::path& series) {
  const Answer answer = run_python("read_vtu.py", {series.string()});
  EXPECT_EQ(answer.code, 0) << answer.text;
  return answer.code == 0 ? nlohmann::json::parse(answer.text) : nlohmann::json();
}

TEST(VtuExport, AnIndependentReaderFindsShapesFieldsAndTimes) {
  const SmallRun run;
  Source source(quiet({run.control(), run.housekeeping()}));
  FollowerOptions options;
  options.truth_stiffness = Stiffness{30e3, 0.3};
  ShapeFollower follower(source, options);
  const auto folder = run.folder() / "vtu";
  const std::vector<Written> written = export_vtu(follower, 10, folder);
  ASSERT_EQ(written.size(), 3u);
  EXPECT_EQ(written[0].count, 11);

  const nlohmann::json estimate = read(folder / "estimate.pvd");
  ASSERT_EQ(estimate.size(), 11u);
  // Time starts at the first message, a truth 10 ms before the first shape.
  EXPECT_NEAR(estimate[0]["time"], 0.01, 1e-9);
  EXPECT_NEAR(estimate[10]["time"], 1.01, 1e-9);
  const nlohmann::json& last = estimate[10];
  EXPECT_EQ(last["cells"].size(), 1u);
  EXPECT_EQ(last["cells"]["tetra"].size(), 30u);
  EXPECT_EQ(last["points"].size(), 24u);
  EXPECT_NEAR(last["points"][5][0], 0.22, 1e-6);
  const nlohmann::json& fields = last["fields"];
  EXPECT_EQ(fields["displacement"]["shape"], nlohmann::json({24, 3}));
  EXPECT_NEAR(fields["displacement"]["greatest"], 0.02, 1e-6);
  EXPECT_NEAR(fields["deviation"]["greatest"], 1e-3, 1e-6);  // along z
  EXPECT_NEAR(fields["deviation"]["least"], 0, 1e-6);
  EXPECT_EQ(fields["strain"]["shape"], nlohmann::json({30, 6}));
  EXPECT_NEAR(fields["strain"]["greatest"], 0.5 * (1.1 * 1.1 - 1), 1e-5);
  EXPECT_EQ(fields["von_mises_stress"]["shape"][0], 30);
  EXPECT_GT(fields["von_mises_stress"]["least"], 2000);
  EXPECT_EQ(fields["constrained"]["greatest"], 1);

  const nlohmann::json truth = read(folder / "truth.pvd");
  EXPECT_EQ(truth[10]["cells"]["hexahedron27"].size(), 4u);
  EXPECT_NEAR(truth[10]["fields"]["displacement"]["greatest"], 0.02, 1e-6);
  EXPECT_TRUE(truth[10]["fields"].contains("von_mises_stress"));
  EXPECT_FALSE(truth[10]["fields"].contains("deviation"));

  const nlohmann::json forces = read(folder / "forces.pvd");
  EXPECT_EQ(forces[10]["points"].size(), 2u);  // a contact and a grasp
  EXPECT_EQ(forces[10]["fields"]["force"]["greatest"], 2);
  EXPECT_EQ(forces[10]["fields"]["torque"]["greatest"], 0.125);
}

TEST(VtuExport, WithoutATruthOrAnEstimateTheOtherIsThere) {
  const SmallRun run;
  const auto only = [&run](const std::string& name, const std::vector<std::string>& left_out) {
    const auto file = run.folder() / name;
    log::MergedLog log({run.housekeeping()});
    LogWriter writer(file);
    while (const bus::LoggedEvent* event = log.next())
      if (std::find(left_out.begin(), left_out.end(), event->channel) == left_out.end())
        writer.write_bytes(event->channel, event->utime, {event->data, event->data + event->size});
    return file;
  };
  Source estimates(quiet({only("estimate", {"TRUTH_SHAPE", "TRUTH_MESH"})}));
  ShapeFollower estimate(estimates, {});
  EXPECT_FALSE(estimate.has_truth());
  EXPECT_EQ(export_vtu(estimate, 0, run.folder() / "a")[0].count, SmallRun::kShapes);
  const nlohmann::json fields = read(run.folder() / "a/estimate.pvd")[0]["fields"];
  EXPECT_FALSE(fields.contains("deviation"));
  EXPECT_FALSE(fields.contains("stress")) << "no ESTIMATE, no stiffness";

  Source truths(quiet({only("truth", {"SHAPE"})}));
  ShapeFollower truth(truths, {});
  EXPECT_FALSE(truth.has_estimate());
  EXPECT_EQ(export_vtu(truth, 0, run.folder() / "b")[0].what, "true shape");

  Source nothing(quiet({only("none", {"SHAPE", "TRUTH_SHAPE"})}));
  EXPECT_THROW(ShapeFollower(nothing, {}), std::runtime_error);
  Source no_mesh(quiet({only("no_mesh", {"SHAPE_MESH", "TRUTH_MESH"})}));
  EXPECT_THROW(ShapeFollower(no_mesh, {}), std::runtime_error);
}

// A log may contain arbitrary data with a valid fingerprint.
TEST(ShapeFollower, MeshesThatNameWhatTheyHaveNotAreLeftOut) {
  const SmallRun run;
  const auto file = run.folder() / "log";
  const auto written = [&](const std::function<void(shape_mesh_t&)>& spoil) {
    {
      LogWriter log(file);
      shape_mesh_t mesh = mesh_message(run.estimate_mesh);
      spoil(mesh);
      log.write("SHAPE_MESH", 1, mesh);
      log.write("SHAPE", 2, shape_message(run.estimate_mesh, run.estimate_mesh.nodes, 2));
    }
    Source source(quiet({file}));
    return ShapeFollower(source, {}).has_estimate();
  };
  EXPECT_TRUE(written([](shape_mesh_t&) {}));
  EXPECT_THROW(written([](shape_mesh_t& m) { m.triangles[3] = 1'000'000; }), std::runtime_error);
  EXPECT_THROW(written([](shape_mesh_t& m) { m.elements[0] = -1; }), std::runtime_error);
  EXPECT_THROW(written([](shape_mesh_t& m) { m.constrained[0] = 24; }), std::runtime_error);
  EXPECT_THROW(written([](shape_mesh_t& m) { m.node_count = -24; }), std::runtime_error);
  EXPECT_THROW(written([](shape_mesh_t& m) { m.node_count = 2'000'000'000; }), std::runtime_error);
  EXPECT_THROW(written([](shape_mesh_t& m) { m.element_size = 0; }), std::runtime_error);
  EXPECT_THROW(written([](shape_mesh_t& m) { m.element_size = 5; }), std::runtime_error);
  EXPECT_THROW(written([](shape_mesh_t& m) { m.first_node = 7; }), std::runtime_error);
  EXPECT_THROW(written([](shape_mesh_t& m) { m.chunks = 2; }), std::runtime_error);
}

TEST(ShapeFollower, JoinsChunksOfQuadraticShapes) {
  const support::ScratchFolder scratch;
  const auto file = scratch.path() / "log";
  const log::MeshMessage box =
      tetrahedral_box({0.2, 0.04, 0.04}, {5, 1, 1}, mesh::ElementOrder::kQuadratic);
  {
    LogWriter log(file);
    log.write("SHAPE_MESH", 1, mesh_message(box));
    shape_t shape = shape_message(box, 1.5 * box.nodes, 2);
    shape_t chunk = shape;
    chunk.chunks = 2;
    chunk.xyz.resize(30);
    chunk.xyz_count = 30;
    log.write("SHAPE", 2, chunk);
    chunk.chunk = 1;
    chunk.first_node = 10;
    chunk.xyz.assign(shape.xyz.begin() + 30, shape.xyz.end());
    chunk.xyz_count = shape.xyz_count - 30;
    log.write("SHAPE", 3, chunk);
  }
  Source source(quiet({file}));
  ShapeFollower follower(source, {});
  int shapes = 0;
  follower.each("", [&](const Instant& instant) {
    ++shapes;
    EXPECT_LT((instant.estimate - 1.5 * box.nodes).cwiseAbs().maxCoeff(), 1e-7);
    const ShapeFields fields = instant.estimate_mesh->at(instant.estimate, {});
    EXPECT_NEAR(fields.strain(0, 0), 0.5 * (1.5 * 1.5 - 1), 1e-5);
  });
  EXPECT_EQ(shapes, 1);
  EXPECT_EQ(export_vtu(follower, 0, scratch.path() / "vtu")[0].count, 1);
  const nlohmann::json read_back = read(scratch.path() / "vtu" / "estimate.pvd");
  EXPECT_FALSE(read_back.is_null());
}

TEST(ShapeFollower, ReadsFormerLogsByTheirCorners) {
  const support::ScratchFolder scratch;
  const auto file = scratch.path() / "log";
  const log::MeshMessage box = tetrahedral_box({0.2, 0.04, 0.04}, {5, 1, 1});
  {
    const shape_mesh_t mesh = mesh_message(box);
    shape_mesh_v1_t former{};
    former.mesh_hash = mesh.mesh_hash;
    former.element_kind = shape_mesh_t::QUADRATIC_TETRAHEDRA;
    former.chunks = 1;
    former.corner_count = mesh.node_count;
    former.element_size = 4;
    former.rest_xyz = mesh.rest_xyz;
    former.rest_xyz_count = mesh.rest_xyz_count;
    former.elements = mesh.elements;
    former.element_index_count = mesh.element_index_count;
    former.triangles = mesh.triangles;
    former.triangle_index_count = mesh.triangle_index_count;
    shape_v1_t shape{};
    shape.mesh_hash = mesh.mesh_hash;
    shape.node_count = mesh.node_count;
    shape.xyz = mesh.rest_xyz;
    shape.xyz_count = mesh.rest_xyz_count;
    shape.deviation.assign(static_cast<std::size_t>(mesh.node_count), 1e-3F);
    shape.deviation_count = mesh.node_count;
    LogWriter log(file);
    log.write("SHAPE_MESH", 1, former);
    log.write("SHAPE", 2, shape);
  }
  Source source(quiet({file}));
  testing::internal::CaptureStderr();
  ShapeFollower follower(source, {});
  EXPECT_NE(testing::internal::GetCapturedStderr().find("corner nodes"), std::string::npos);
  EXPECT_TRUE(follower.has_deviation());
  int shapes = 0;
  follower.each("", [&](const Instant& instant) {
    ++shapes;
    EXPECT_LT((instant.estimate - box.nodes).cwiseAbs().maxCoeff(), 1e-7);
    EXPECT_NEAR(instant.node_deviation(0), 1e-3, 1e-9);
  });
  EXPECT_EQ(shapes, 1);
}

TEST(VtkOrder, PutsCornersEdgesFacesAndMiddleInTheirPlaces) {
  const log::MeshMessage box = hexahedral_box({1, 1, 1}, {1, 1, 1});
  const Eigen::VectorXi order = vtk_order(box.nodes);
  const auto at = [&](int number) { return Eigen::Vector3d(box.nodes.col(order(number))); };
  EXPECT_EQ(at(0), Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(at(2), Eigen::Vector3d(1, 1, 0));
  EXPECT_EQ(at(7), Eigen::Vector3d(0, 1, 1));
  EXPECT_EQ(at(8), 0.5 * (at(0) + at(1)));
  EXPECT_EQ(at(11), 0.5 * (at(3) + at(0)));
  EXPECT_EQ(at(18), 0.5 * (at(2) + at(6)));
  EXPECT_EQ(at(20), Eigen::Vector3d(0, 0.5, 0.5));
  EXPECT_EQ(at(26), Eigen::Vector3d(0.5, 0.5, 0.5));
}

}  // namespace
}  // namespace palpate::exporting

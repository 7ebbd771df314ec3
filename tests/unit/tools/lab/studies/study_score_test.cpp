#include "tools/lab/studies/study_score.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/unit/tools/lab/scores/synthetic_run.hpp"
#include "tools/lab/runs/feature_on_points.hpp"
#include "tools/lab/studies/study_picture.hpp"

namespace palpate::studies {
namespace {

const Eigen::Vector3d kOff(0.001, -0.002, 0.002);  // m, of the estimate: 3 mm

Eigen::Vector3d truth(const Eigen::Vector3d& rest, double time) {
  return rest + Eigen::Vector3d(0, 0, 0.02 * time);
}
Eigen::Vector3d estimate(const Eigen::Vector3d& rest, double time) {
  return truth(rest, time) + kOff;
}

/// Outward triangles of the hull of eight corners of a box among the plant's nodes.
std::vector<std::int32_t> box_triangles(const Eigen::Matrix3Xd& nodes) {
  const auto corner = [&nodes](int x, int y, int z) {
    const Eigen::Vector3d at = (Eigen::Array3d(x, y, z) * scores::kBox).matrix();
    for (int i = 0; i < nodes.cols(); ++i)
      if ((nodes.col(i) - at).norm() < 1e-9) return i;
    throw std::logic_error("no such corner");
  };
  std::vector<std::int32_t> triangles;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      int quad[4];
      for (int k = 0; k < 4; ++k) {
        int p[3];
        p[axis] = side;
        p[(axis + 1) % 3] = k == 1 || k == 2;
        p[(axis + 2) % 3] = k >= 2;
        quad[side == 1 ? k : 3 - k] = corner(p[0], p[1], p[2]);
      }
      for (const int i : {0, 1, 2, 0, 2, 3}) triangles.push_back(quad[i]);
    }
  return triangles;
}

/// A box that rises, and its own surface 3 mm off as the estimate.
log::RunLog run_of_boxes() {
  log::RunLog run = scores::synthetic_run(truth, estimate, 3);
  run.shapes.clear();
  run.shape_chunks =
      scores::mesh_chunks(scores::plant_rest(), shape_mesh_t::QUADRATIC_HEXAHEDRA, 22);
  for (double time = 0; time < 2.99; time += 0.01)
    run.shapes.push_back(
        scores::shape_at(time, scores::moved(scores::plant_rest(), estimate, time), 22));
  for (auto* chunks : {&run.truth_chunks, &run.shape_chunks}) {
    (*chunks)[0].triangles = box_triangles(scores::plant_rest());
    (*chunks)[0].triangle_index_count = static_cast<int>((*chunks)[0].triangles.size());
  }
  return run;
}

StudyJob job_with_state(double time) {
  StudyJob job;
  job.kind = "force";
  job.states = {{"risen", time}};
  job.octree_resolution = 0.006;
  return job;
}

TEST(StudyScore, OfAnEstimateThatDiffersFromTheTruth) {
  const log::RunLog run = run_of_boxes();
  const scores::ShapeScore shape = scores::score_shape(run);
  const auto states = score_states(job_with_state(2.5), run, shape, math::Pose::Identity());
  ASSERT_EQ(states.size(), 1u);
  EXPECT_NEAR(states[0].error.mean, 3e-3, 1e-6);
  EXPECT_NEAR(states[0].displacement, 0.05, 5e-4);
  EXPECT_NEAR(states[0].surface.hausdorff, 3e-3, 1e-5);  // of the corners
  EXPECT_LT(states[0].octree.estimate_in_truth, 1);
  EXPECT_GT(states[0].octree.estimate_in_truth, 0.5);
  EXPECT_FALSE(states[0].shapes.camera);
  EXPECT_FALSE(states[0].pose_error);
  const nlohmann::json json = to_json(states[0], shape.length);
  EXPECT_NEAR(json["mean_percent_of_length"].get<double>(), 100 * 3e-3 / 0.4, 1e-3);
  EXPECT_NEAR(json["mean_percent_of_displacement"].get<double>(), 100 * 3e-3 / 0.05, 0.1);
  EXPECT_EQ(json["measured"], "truth surface");
}

TEST(StudyScore, PoseErrorIsEstimateMinusPlant) {
  log::RunLog run = run_of_boxes();
  StudyJob job = job_with_state(2.5);
  job.pose_points = {{0.1, 0.05, 0}, {0.3, 0.05, 0}, {0.2, 0.05, 0.2}};
  runs::FeatureDefinition definition;
  definition.kind = "pose";
  definition.rest_points = job.pose_points;
  const runs::FeatureOnPoints pose(definition);
  const math::Vector6d turn = (math::Vector6d() << 0, 0, 0, 0, 0, 0.1).finished();
  for (const shape_t& shape : run.shapes) {
    const double time = static_cast<double>(shape.utime) * 1e-6;
    Eigen::Matrix3Xd points = scores::moved(pose.rest_points(), estimate, time);
    const Eigen::Vector3d centre = points.rowwise().mean();
    points = (math::exp_rotation(turn.tail<3>()) * (points.colwise() - centre)).colwise() + centre;
    feature_t message = {};
    message.utime = shape.utime;
    const Eigen::VectorXd value = pose.value(points);
    message.value_count = static_cast<int>(value.size());
    std::copy_n(value.data(), value.size(), message.value);
    run.features.push_back(message);
  }
  const auto states = score_states(job, run, scores::score_shape(run), math::Pose::Identity());
  ASSERT_TRUE(states[0].pose_error);
  EXPECT_LT((states[0].pose_error->head<3>() - kOff).norm(), 2e-5);
  EXPECT_LT((states[0].pose_error->tail<3>() - turn.tail<3>()).norm(), 1e-6);
}

TEST(StudyScore, ACamerasPointsAreInTheObjectsFrame) {
  log::RunLog run = run_of_boxes();
  math::Pose X_WO = math::Pose::Identity();
  X_WO.linear() = Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  X_WO.translation() << 1, 2, 3;
  shape_observation_t seen = {};
  seen.utime = 2400000;
  seen.count = 1;
  // 10 mm above the middle of the estimate's upper face at 2.5 s.
  const Eigen::Vector3d p_O = estimate({0.2, 0.05, 0.2}, 2.5) + Eigen::Vector3d(0, 0, 0.01);
  Eigen::Map<Eigen::Vector3f>(seen.points[0]) = (X_WO * p_O).cast<float>();
  run.observations.push_back(seen);
  const auto states = score_states(job_with_state(2.5), run, scores::score_shape(run), X_WO);
  ASSERT_TRUE(states[0].camera);
  EXPECT_TRUE(states[0].shapes.camera);
  EXPECT_NEAR(states[0].camera->maximum, 0.01, 1e-5);
}

TEST(StudyScore, AStateAfterTheEndIsAnError) {
  const log::RunLog run = run_of_boxes();
  EXPECT_THROW(
      score_states(job_with_state(9), run, scores::score_shape(run), math::Pose::Identity()),
      std::runtime_error);
}

TEST(StudyPicture, ThreePanelsOfWhichTheLastHasBoth) {
  const log::RunLog run = run_of_boxes();
  const auto states =
      score_states(job_with_state(2.5), run, scores::score_shape(run), math::Pose::Identity());
  const std::filesystem::path png =
      std::filesystem::path(testing::TempDir()) / "thesis_picture_test.png";
  draw_state(states[0], math::Pose::Identity(), png);
  EXPECT_GT(std::filesystem::file_size(png), 1000u);
  std::filesystem::remove(png);
}

}  // namespace
}  // namespace palpate::studies

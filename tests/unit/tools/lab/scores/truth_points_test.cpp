#include "tools/lab/scores/truth_points.hpp"

#include <gtest/gtest.h>

#include "tests/unit/tools/lab/scores/synthetic_run.hpp"
#include "tools/lab/scores/belief_score.hpp"
#include "tools/lab/scores/shape_score.hpp"

namespace palpate::scores {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

Vector3d stretched(const Vector3d& p, double time) {
  return p + Vector3d(0.1 * p.x() * time, 0, 0.02 * time);
}

log::MeshMessage mesh_of(const Matrix3Xd& nodes) {
  log::MeshMessage mesh;
  mesh.nodes = nodes;
  return mesh;
}

/// An estimate of a mesh that is larger by these factors than the plant and that moves each of its
/// points exactly with the plant's point at the same share of the object.
log::RunLog run_of_scaled_mesh(const Vector3d& factors) {
  const Matrix3Xd rest = factors.asDiagonal() * estimate_rest();
  log::RunLog run = synthetic_run(stretched, stretched, 1);
  run.shape_chunks = mesh_chunks(rest, shape_mesh_t::LINEAR_TETRAHEDRA, 22);
  return run;
}

TEST(TruthPoints, ObjectsOfUnlikeSizeCorrespondByShareOfTheirSides) {
  const Vector3d factors(1.02, 0.99, 1.01);
  const Matrix3Xd rest = factors.asDiagonal() * estimate_rest();
  const Matrix3Xd found = corresponding_points(mesh_of(plant_rest()), mesh_of(rest), rest);
  EXPECT_LT((found - estimate_rest()).cwiseAbs().maxCoeff(), 1e-12);
  // Positions are those of estimate_rest() under the plant's motion: no error with that
  // correspondence, 2 % of the side times the strain with coordinates in metres.
  const ShapeScore score = score_shape(run_of_scaled_mesh(factors));
  EXPECT_LT(score.whole.maximum, 1e-6);
}

TEST(TruthPoints, ABoxOfTheSameSizeElsewhereInItsFrameCorresponds) {
  const Matrix3Xd rest = (1.01 * estimate_rest()).colwise() + Vector3d(0.3, 0, 0);
  const Matrix3Xd found = corresponding_points(mesh_of(plant_rest()), mesh_of(rest), rest);
  EXPECT_LT((found - estimate_rest()).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(TruthPoints, EqualAndUnrelatedObjectsKeepTheirCoordinates) {
  const Matrix3Xd rest = estimate_rest();
  EXPECT_EQ(corresponding_points(mesh_of(plant_rest()), mesh_of(rest), rest), rest);
  const Matrix3Xd half = 0.5 * rest;
  EXPECT_EQ(corresponding_points(mesh_of(plant_rest()), mesh_of(half), half), half);
}

TEST(TruthPoints, AnObjectElsewhereThanConfiguredIsScoredInTheWorld) {
  const log::RunLog run = synthetic_run(stretched, stretched, 1);
  const Vector3d shift(0, 1e-3, -2e-3);
  const math::Pose X_OP = math::make_pose(Eigen::Matrix3d::Identity(), shift);
  const ShapeScore score = score_shape(run, X_OP);
  EXPECT_NEAR(score.whole.mean, shift.norm(), 1e-6);
  EXPECT_NEAR(score.largest_displacement, score_shape(run).largest_displacement, 1e-9);
  // A turn about the plant's origin moves its far end the most.
  const math::Pose turned =
      math::make_pose(math::exp_rotation(Vector3d(0, 0, 0.01)), Vector3d::Zero());
  EXPECT_GT(score_shape(run, turned).whole.maximum, 3.9e-3);
}

TEST(TruthPoints, IntervalsAreJudgedAtTheSamePoints) {
  log::RunLog run = run_of_scaled_mesh({1.05, 1, 1});
  for (shape_t& shape : run.shapes) {
    shape.deviation_count = shape.node_count;
    shape.deviation.assign(shape.node_count, 1e-5F);
  }
  EXPECT_EQ(score_belief(run).covered, 1.0);
}

}  // namespace
}  // namespace palpate::scores

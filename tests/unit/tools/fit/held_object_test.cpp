#include "tools/fit/held/held_object.hpp"

#include <gtest/gtest.h>

#include "core/elasticity/pad_compliance.hpp"
#include "tests/unit/tools/fit/held_bar.hpp"

namespace palpate::fit {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

HeldOptions everything() {
  HeldOptions options;
  options.sought = {true, true, true, true, true, true};
  return options;
}

/// Away from the start, with an offset of the grasp along no axis.
VectorXd elsewhere(const Experiment& experiment) {
  VectorXd p = starts(experiment);
  for (Eigen::Index k = 0; k < p.size(); ++k) {
    const std::string& name = experiment.parameters()[k].name;
    if (name.find(".grasp_") != std::string::npos) p[k] = (k % 2 ? -1 : 1) * 0.002 * (k + 1);
    if (name == "grasp_stiffness") p[k] = 3e3;
  }
  p[0] *= 1.3;
  p[1] -= 0.05;
  p[2] *= 0.8;
  return p;
}

TEST(HeldObject, WrenchFollowsEveryParameterAsItsDifferencesSay) {
  for (const auto order : {mesh::ElementOrder::kLinear, mesh::ElementOrder::kQuadratic}) {
    const HeldCell cell = make_held_bar(order);
    const HeldObject held("bar", cell, make_rests(cell, six_motions()), everything());
    expect_gradient(held, elsewhere(held));
  }
}

TEST(HeldObject, MarkersFollowEveryParameterAsTheirDifferencesSay) {
  const HeldCell cell = make_held_bar();
  HeldRecording recording = make_rests(cell, six_motions());
  HeldOptions options = everything();
  options.markers = {{0.1, 0, 0.02}, {0.15, 0.05, 0.01}};
  for (HeldSample& sample : recording.samples) sample.points_W = Eigen::Matrix3Xd::Zero(3, 2);
  const HeldObject held("bar", cell, recording, options);
  ASSERT_EQ(held.series().size(), 7u);
  EXPECT_EQ(held.series()[6].x.size(), 7 * 2 * 3);
  expect_gradient(held, elsewhere(held));
}

TEST(HeldObject, DistancesOfPointsFollowEveryParameterAsTheirDifferencesSay) {
  const HeldCell cell = make_held_bar(mesh::ElementOrder::kQuadratic);
  HeldRecording recording = make_rests(cell, {six_motions()[3], six_motions()[5]});
  Eigen::Matrix3Xd points_O(3, 4);    // next to faces, inside, outside and far from an edge
  points_O << 0.06, 0.1, 0.14, 0.12,  //
      0.02, 0.045, 0.03, 0.02,        //
      0.05, 0.02, 0.005, 0.06;
  for (HeldSample& sample : recording.samples) sample.points_W = cell.frames.X_WO * points_O;
  const HeldObject held("bar", cell, recording, everything());
  VectorXd prediction;
  ASSERT_TRUE(held.predict(starts(held), prediction, nullptr));
  EXPECT_GT(prediction.tail(8).maxCoeff(), 0);
  EXPECT_LT(prediction.tail(8).minCoeff(), 0);
  expect_gradient(held, elsewhere(held));
}

// A hand that alone carries the object bears its weight, regardless of the material.
TEST(HeldObject, HandBearsTheWeightOfWhatNothingElseHolds) {
  HeldCell cell = make_held_bar();
  cell.object.body.fixed_nodes.clear();
  cell.hand.bias = {};
  const HeldRecording recording = make_rests(cell, six_motions());
  const HeldObject held("bar", cell, recording);
  VectorXd p = starts(held), reading;
  ASSERT_TRUE(held.predict(p, reading, nullptr));
  const double mass = cell.hand.mass + 60 * 0.2 * 0.05 * 0.04;
  const int n = static_cast<int>(recording.samples.size());
  for (int i = 0; i < n; ++i) {
    const math::Pose X_WS = recording.samples[i].X_WE * cell.frames.X_ES;
    const Vector3d expected = X_WS.linear().transpose() * Vector3d(0, 0, 9.81 * mass);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(reading[k * n + i], expected[k], 1e-8);
  }
}

// The torque about S of all weights: of the hand at its centre and of a stiff object at its own.
TEST(HeldObject, TorqueIsThatOfHandAndStiffObject) {
  HeldCell cell = make_held_bar();
  cell.object.body.fixed_nodes.clear();
  cell.object.body.material.young_modulus = 1e8;
  cell.hand.bias = {};
  const HeldRecording recording = make_rests(cell, {six_motions()[3]});
  const HeldObject held("bar", cell, recording);
  VectorXd reading;
  ASSERT_TRUE(held.predict(starts(held), reading, nullptr));
  const math::Pose X_WE = recording.samples[0].X_WE;
  const math::Pose X_WS = X_WE * cell.frames.X_ES;
  const math::Pose moved = X_WE * cell.frames.X_EG * cell.object.body.grasps[0].X_OG_rest.inverse();
  const Vector3d up_S = X_WS.linear().transpose() * Vector3d(0, 0, 9.81);
  const Vector3d center_S = X_WS.inverse() * (moved * Vector3d(0.1, 0.025, 0.02));
  const Vector3d expected =
      cell.hand.first_moment.cross(up_S) + 60 * 0.2 * 0.05 * 0.04 * center_S.cross(up_S);
  EXPECT_LT((reading.tail(3) - expected).norm(), 1e-4 * expected.norm());
}

// The object yields in the hand as its springs' wrench makes it; seen from O, at the displaced
// patch, nothing differs from a hand that has moved there.
TEST(HeldObject, PadsYieldByTheirComplianceTimesTheWrench) {
  const HeldCell cell = make_held_bar(mesh::ElementOrder::kQuadratic);
  const elasticity::Body& body = cell.object.body;
  const elasticity::GraspRegion& grasp = body.grasps[0];
  const math::Matrix6d pads = elasticity::pad_compliance(body, grasp, cell.object.surface, 2e3);
  HeldEquilibrium padded(body, pads), rigid(body, math::Matrix6d::Zero());
  const HeldRecording recording = make_rests(cell, six_motions());
  double most = 0;
  for (const HeldSample& sample : recording.samples) {
    const math::Pose X_OH = cell.frames.X_WO.inverse() * sample.X_WE * cell.frames.X_EG;
    ASSERT_TRUE(padded.solve(X_OH, body.mesh.nodes, math::Vector6d::Zero()));
    math::Vector6d wrench;  // in the hand's G
    wrench << X_OH.linear().transpose() * padded.wrench().force,
        X_OH.linear().transpose() * padded.wrench().torque;
    EXPECT_LT((padded.yield() + pads * wrench).norm(), 1e-9);
    most = std::max(most, padded.yield().head<3>().norm());
    const math::Pose X_OG = X_OH * math::make_pose(math::exp_rotation(padded.yield().tail<3>()),
                                                   padded.yield().head<3>());
    ASSERT_TRUE(rigid.solve(X_OG, padded.positions(), math::Vector6d::Zero()));
    EXPECT_LT((rigid.positions() - padded.positions()).colwise().norm().maxCoeff(), 1e-8);
    EXPECT_LT((rigid.wrench().force - padded.wrench().force).norm(), 1e-6);
  }
  EXPECT_GT(most, 5e-4);
}

// Readings of pads of 3 kN/m, fitted by rigid ones and by pads of an unknown stiffness.
TEST(HeldObject, PadsAreTakenFromTheConfigurationUnlessTheyAreSought) {
  HeldCell cell = make_held_bar();
  const HeldRecording rests = make_rests(cell, six_motions());
  const HeldObject rigid("bar", cell, rests, everything());
  elasticity::GraspRegion& grasp = cell.object.body.grasps[0];
  grasp.compliance = elasticity::pad_compliance(cell.object.body, grasp, cell.object.surface, 3e3);
  const HeldObject configured("bar", cell, rests);
  HeldOptions options;
  options.sought.pads = true;
  const HeldObject sought("bar", cell, rests, options);
  const Parameter& stiffness = sought.parameters().back();
  EXPECT_EQ(stiffness.name, "grasp_stiffness");
  EXPECT_NEAR(stiffness.start, 3e3, 1e-6);
  EXPECT_NEAR(rigid.parameters().back().start, 1e5, 1e-6);
  VectorXd one, other;
  ASSERT_TRUE(configured.predict(starts(configured), one, nullptr));
  ASSERT_TRUE(sought.predict(starts(sought), other, nullptr));
  EXPECT_LT((one - other).cwiseAbs().maxCoeff(), 1e-7);
}

TEST(HeldObject, OwnParametersCarryItsNameAndKnownOnesAreFixed) {
  const HeldCell cell = make_held_bar();
  const HeldObject held("bar", cell, make_rests(cell, six_motions()));
  const std::vector<Parameter>& all = held.parameters();
  ASSERT_EQ(all.size(), 9u);
  EXPECT_EQ(all[0].name, "young_modulus");
  EXPECT_LT(all[1].lower, all[1].upper);
  EXPECT_EQ(all[2].lower, all[2].upper);  // density
  EXPECT_EQ(all[3].name, "bar.bias_fx");
}

TEST(HeldObject, StrainsAreThoseOfTheHandsMotion) {
  const HeldCell cell = make_held_bar();
  math::Vector6d stretch = math::Vector6d::Zero();
  stretch[0] = 0.01;  // of 0.2
  const HeldObject held("bar", cell, make_rests(cell, {stretch}));
  EXPECT_NEAR(held.strain_range()[1], 0.05, 0.015);
  EXPECT_LT(held.strain_range()[0], 0);  // across
}

TEST(HeldObject, RefusesOtherPointsThanMarkers) {
  const HeldCell cell = make_held_bar();
  HeldRecording recording = make_rests(cell, six_motions());
  recording.samples[0].points_W = Eigen::Matrix3Xd::Zero(3, 5);
  HeldOptions options;
  options.markers = {{0.1, 0, 0.02}};
  EXPECT_THROW(HeldObject("bar", cell, recording, options), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::fit

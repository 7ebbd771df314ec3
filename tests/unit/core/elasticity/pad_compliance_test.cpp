#include "core/elasticity/pad_compliance.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/unit/core/estimation/rigid_model.hpp"

namespace palpate::elasticity {
namespace {

constexpr double kSide = 0.06;        // m
constexpr double kStiffness = 2.0e4;  // N/m

// A square face: second moments a^2 / 12 about its axes, a^2 / 6 about its normal.
TEST(PadCompliance, OfASquareFaceIsThatOfItsMoments) {
  for (const auto order : {mesh::ElementOrder::kLinear, mesh::ElementOrder::kQuadratic}) {
    const Body body = support::held_bar({4, 1, 1}, order);
    const math::Matrix6d C =
        pad_compliance(body, body.grasps[0], mesh::extract_surface(body.mesh), kStiffness);
    math::Vector6d stiffness;
    const double moment = kSide * kSide / 12;
    stiffness << 1, 1, 1, 2 * moment, moment, moment;
    const math::Matrix6d expected =
        math::Matrix6d((kStiffness * stiffness).cwiseInverse().asDiagonal());
    EXPECT_LT((C - expected).norm(), 1e-9 * expected.norm());
  }
}

// Pads rotate about their own centre, regardless of the position of G: a pure torque there,
// expressed at G.
TEST(PadCompliance, RefersToTheOriginOfTheGrasp) {
  Body body = support::held_bar({4, 1, 1}, mesh::ElementOrder::kQuadratic);
  GraspRegion& grasp = body.grasps[0];
  const mesh::Surface surface = mesh::extract_surface(body.mesh);
  const math::Matrix6d about_middle = pad_compliance(body, grasp, surface, kStiffness);
  const Eigen::Vector3d shift(-0.03, 0.01, 0.02);  // of G, in G
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(0.6, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  grasp.X_OG_rest.translation() += shift;
  grasp.X_OG_rest.linear() = R;
  const math::Matrix6d C = pad_compliance(body, grasp, surface, kStiffness);
  // Motion of the new origin under a wrench on it, via the centre.
  const Eigen::Vector3d force(1, -2, 3), torque(0.1, 0.2, -0.3);  // at the new origin, axes of O
  math::Vector6d at_middle, at_origin;
  at_middle << force, torque + shift.cross(force);
  at_origin << R.transpose() * force, R.transpose() * torque;
  const math::Vector6d middle = about_middle * at_middle, origin = C * at_origin;
  const Eigen::Vector3d moved = middle.head<3>() + middle.tail<3>().cross(shift);
  EXPECT_LT((R * origin.head<3>() - moved).norm(), 1e-9 * moved.norm());
  EXPECT_LT((R * origin.tail<3>() - middle.tail<3>()).norm(), 1e-9 * middle.tail<3>().norm());
}

TEST(PadCompliance, RefusesWhatCannotHold) {
  Body body = support::held_bar({4, 1, 1}, mesh::ElementOrder::kLinear);
  const mesh::Surface surface = mesh::extract_surface(body.mesh);
  EXPECT_THROW(pad_compliance(body, body.grasps[0], surface, 0), std::invalid_argument);
  EXPECT_EQ(pad_compliance(body, body.grasps[0], surface, std::numeric_limits<double>::infinity()),
            math::Matrix6d::Zero());
  body.grasps[0].nodes.resize(2);
  EXPECT_THROW(pad_compliance(body, body.grasps[0], surface, kStiffness), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::elasticity

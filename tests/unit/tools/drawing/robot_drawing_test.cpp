#include "tools/drawing/robot_drawing.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "rt/registry/arm_model.hpp"
#include "tests/support/scratch_folder.hpp"

namespace palpate::drawing {
namespace {

const std::string kArm = std::string(PALPATE_SOURCE_DIR) + "/sim/robot/lwr_hand.urdf";

TEST(RobotDrawing, LinksAreWhereTheArmsKinematicsPutThem) {
  const RobotDrawing drawing(kArm, "flange");
  EXPECT_EQ(drawing.arm_joint_count(), 7);
  EXPECT_EQ(drawing.hand_joint_count(), 20);
  const kinematics::SerialChain chain = registry::read_urdf(kArm, "flange");
  const double q[7] = {0.4, -1.1, 0.3, 1.2, -0.2, 0.7, 0.9};
  kinematics::SerialChain::State state;
  chain.evaluate(Eigen::Map<const Eigen::VectorXd>(q, 7), state);
  math::Pose X_AW = math::Pose::Identity();
  X_AW.translate(Eigen::Vector3d(1, 2, 3)).rotate(Eigen::AngleAxisd(2, Eigen::Vector3d::UnitZ()));
  std::vector<float> poses;
  drawing.place(X_AW, q, 7, nullptr, 0, poses);
  ASSERT_EQ(poses.size(), static_cast<std::size_t>(7) * drawing.link_count());
  const math::Pose X_AE = X_AW * state.X_WE;
  // The flange has a shape, so it is included.
  float nearest = 1;
  for (int link = 0; link < drawing.link_count(); ++link) {
    const Eigen::Map<const Eigen::Vector3f> p(&poses[7 * static_cast<std::size_t>(link)]);
    const Eigen::Quaternionf r(&poses[7 * static_cast<std::size_t>(link) + 3]);
    const float angle = r.angularDistance(Eigen::Quaterniond(X_AE.linear()).cast<float>());
    nearest = std::min(nearest, (p - X_AE.translation().cast<float>()).norm() + 0.1F * angle);
  }
  EXPECT_LT(nearest, 1e-4);
}

TEST(RobotDrawing, FingersFollowTheHandsJoints) {
  const RobotDrawing drawing(kArm, "flange");
  const double arm[7] = {};
  double hand[20] = {};
  std::vector<float> straight, bent;
  drawing.place(math::Pose::Identity(), arm, 7, hand, 20, straight);
  hand[1] = 0.5;  // flexes the first finger
  drawing.place(math::Pose::Identity(), arm, 7, hand, 20, bent);
  int moved = 0;
  for (std::size_t i = 0; i < bent.size(); i += 7) {
    bool same = true;
    for (std::size_t k = 0; k < 7; ++k)
      same = same && std::abs(bent[i + k] - straight[i + k]) < 1e-6;
    moved += same ? 0 : 1;
  }
  EXPECT_EQ(moved, 3) << "its three phalanges alone";
}

TEST(RobotDrawing, FilesThatCannotBeDrawnAreNamed) {
  const support::ScratchFolder folder;
  const std::string path = (folder.path() / "bad.urdf").string();
  const auto complaint = [&](const std::string& text, const std::string& flange) {
    std::ofstream(path) << text;
    try {
      RobotDrawing drawing(path, flange);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  EXPECT_NE(complaint("<robot", "flange").find("urdfdom"), std::string::npos);
  EXPECT_NE(complaint("<robot name='a'><xacro:x/></robot>", "f").find("expand"), std::string::npos);
  EXPECT_NE(complaint("<robot name='a'><link name='b'/></robot>", "f").find("no link 'f'"),
            std::string::npos);
  EXPECT_THROW(RobotDrawing((folder.path() / "none").string(), "f"), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::drawing

// Every scene with its configuration.

#include <cmath>

#include "tests/integration/closed_loop/closed_loop.hpp"

namespace palpate {
namespace {

struct ScenesPair {
  const char* scene;
  const char* configuration;
};

std::string scene_of(const ScenesPair& pair) {
  return std::string("sim/scenes/") + pair.scene + ".yaml";
}
std::string configuration_of(const ScenesPair& pair) {
  return std::string("rt/config/examples/") + pair.configuration + ".yaml";
}

class SceneAndConfiguration : public ::testing::TestWithParam<ScenesPair> {};

TEST_P(SceneAndConfiguration, SpeakOfTheSameObject) {
  ClosedLoop loop(scene_of(GetParam()), configuration_of(GetParam()));
  loop.run(0.1);
  const scenes::Scene& scene = loop.simulation().scene();
  const pipeline::Pipeline& pipeline = loop.daemon().pipeline();
  const registry::Frames& frames = pipeline.frames();
  const math::Pose X_OG =
      frames.X_WO.inverse() * loop.daemon().inputs().signals().robot.latest.X_WE * frames.X_EG;
  const math::Pose truth = loop.simulation().grasp_in_object();
  EXPECT_LT((X_OG.translation() - truth.translation()).norm(), 1e-3);
  EXPECT_LT((X_OG.linear() - truth.linear()).norm(), 1e-3);

  const elasticity::Body& body = pipeline.object().body;
  EXPECT_LT((body.grasps[0].X_OG_rest.translation() - truth.translation()).norm(), 1e-3);
  const Eigen::Vector3d size = body.mesh.nodes.rowwise().maxCoeff();
  EXPECT_LT((size - scene.plant.size).norm(), 1e-9);
  EXPECT_EQ(body.material.young_modulus, scene.plant.young_modulus);
  EXPECT_EQ(body.material.poisson_ratio, scene.plant.poisson_ratio);
  EXPECT_EQ(body.material.density, scene.plant.density);
  // The same patch in the hand, on a coarser mesh with other elements.
  for (const int node : body.grasps[0].nodes) {
    const Eigen::Vector3d p = body.mesh.nodes.col(node);
    const object::Box& patch = scene.plant.grasps[0].patch;
    EXPECT_TRUE((p.array() > patch.lower.array() - 1e-9).all() &&
                (p.array() < patch.upper.array() + 1e-9).all());
  }
  EXPECT_LT(body.mesh.node_count(), loop.simulation().plant().positions().cols());
}

INSTANTIATE_TEST_SUITE_P(Scene, SceneAndConfiguration,
                         ::testing::Values(ScenesPair{"bar_long_soft_control", "bar_long_soft"},
                                           ScenesPair{"bar_long_soft_six_poses", "bar_long_soft"},
                                           ScenesPair{"bar_long_hard_six_poses", "bar_long_hard"},
                                           ScenesPair{"bar_long_soft_torsion", "bar_long_soft"},
                                           ScenesPair{"bar_long_soft_bending",
                                                      "bar_long_soft_across"},
                                           ScenesPair{"bar_long_soft_poke", "bar_long_soft"},
                                           ScenesPair{"block_hard_control", "block_hard"},
                                           ScenesPair{"block_hard_six_poses", "block_hard"},
                                           ScenesPair{"block_soft_six_poses", "block_soft"}),
                         [](const auto& tested) { return std::string(tested.param.scene); });

// The thesis' third control run: its pose of three nodes near the hand, within the block's plane.
TEST(BlockControl, PoseNextToTheHandReachesItsTargetAlongZ) {
  const std::vector<Eigen::Vector3d> nodes = {
      {0.3653, 0.06, 0.3012}, {0.4, 0.06, 0.2}, {0.3653, 0.06, 0.2606}};
  ClosedLoop loop("sim/scenes/block_hard_control.yaml", "rt/config/examples/block_hard.yaml",
                  {"object.elements=[5, 1, 5]"},
                  {"feature={component: pose, rest_points: [[0.3653, 0.06, 0.3012], [0.4, 0.06, "
                   "0.2], [0.3653, 0.06, 0.2606]]}"});
  const object::HyperelasticPlant& plant = loop.simulation().plant();
  const auto centroid = [&] {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& node : nodes) sum += plant.position_at(node);
    return Eigen::Vector3d(sum / 3);
  };
  loop.run(0.1);
  loop.send_event("start");
  loop.run(0.5);
  const Eigen::Vector3d before = centroid(), move(0, 0, 0.02);
  Eigen::VectorXd target = loop.daemon().pipeline().feature_state().value;
  target.head<3>() += move;
  loop.send_target("pose", target);
  loop.run(4.0);
  EXPECT_LT((centroid() - before - move).norm(), 5e-3) << "of the plant";
  EXPECT_LT(loop.daemon().pipeline().feature_state().error.tail<3>().norm(), M_PI / 180);
  EXPECT_TRUE(loop.daemon().pipeline().is_running()) << loop.daemon().pipeline().condition().reason;
  EXPECT_GT(plant.hand_wrench().force.z(), 5) << "N: the block resists";
}

}  // namespace
}  // namespace palpate

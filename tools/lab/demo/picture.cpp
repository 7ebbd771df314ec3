#include <algorithm>
#include <iostream>

#include "core/mesh/element_mesh.hpp"
#include "core/mesh/surface.hpp"
#include "rt/config/node.hpp"
#include "rt/registry/frames.hpp"
#include "sim/draw/annotate.hpp"
#include "sim/draw/image.hpp"
#include "sim/draw/renderer.hpp"
#include "sim/robot/robot.hpp"
#include "tools/lab/demo/shape_drawing.hpp"

namespace palpate::demo {
namespace {

constexpr int kWidth = 1280, kHeight = 800, kSupersampling = 2;
constexpr double kFieldOfView = 0.40;  // rad

const draw::Colour kTruth{0.95F, 0.72F, 0.30F, 1};
const draw::Colour kEstimate{0.10F, 0.30F, 0.85F, 0.28F};
const draw::Colour kEstimateEdge{0.05F, 0.18F, 0.65F, 1};
const draw::Colour kStart{0.45F, 0.48F, 0.52F, 0.25F};
const draw::Colour kTarget{0.85F, 0.10F, 0.12F, 1};
const draw::Colour kFeature{0.10F, 0.60F, 0.20F, 1};

/// The last message sent before `utime`, or the first.
template <class Message>
const Message& shown_at(const std::vector<Message>& messages, std::int64_t utime) {
  const Message* message = log::latest(messages, utime);
  return message == nullptr ? messages.front() : *message;
}

void draw_robot(draw::Renderer& renderer, const std::filesystem::path& urdf,
                const robot_state_t& state) {
  robot::Robot arm(robot::load_model(urdf.string()), robot::RobotOptions());
  if (arm.joint_count() != state.joint_count) return;
  arm.set_joints(Eigen::Map<const Eigen::VectorXd>(state.q, state.joint_count));
  for (const robot::VisualShape& visual : arm.visuals()) {
    const math::Pose X_WV = arm.link_pose(visual.link) * visual.X_LV;
    const Eigen::Vector3f c = visual.colour.cast<float>();
    const draw::Colour colour{c.x(), c.y(), c.z(), 1};
    switch (visual.kind) {
      case robot::ShapeKind::kBox:
        renderer.draw_box(X_WV, visual.size, colour);
        break;
      case robot::ShapeKind::kCylinder:
        renderer.draw_cylinder(X_WV, visual.size.x(), visual.size.y(), colour);
        break;
      case robot::ShapeKind::kSphere:
        renderer.draw_sphere(X_WV, visual.size.x(), colour);
        break;
    }
  }
}

void draw_clamp(draw::Renderer& renderer, const math::Pose& X_WO, const log::MeshMessage& plant) {
  const Eigen::Vector3d lower = plant.nodes.rowwise().minCoeff();
  const Eigen::Vector3d upper = plant.nodes.rowwise().maxCoeff();
  const Eigen::Vector3d size(0.03, 1.6 * (upper.y() - lower.y()), 1.6 * (upper.z() - lower.z()));
  math::Pose X_OB = math::Pose::Identity();
  X_OB.translation() << lower.x() - 0.5 * size.x(), 0.5 * (lower.y() + upper.y()),
      0.5 * (lower.z() + upper.z());
  renderer.draw_box(X_WO * X_OB, size, {0.35F, 0.37F, 0.40F, 1});
}

void draw_target(draw::Renderer& renderer, const math::Pose& X_WO, const log::MeshMessage& plant,
                 const Eigen::Matrix3Xd& plant_positions, const runs::ControlTarget& target) {
  Eigen::Matrix3Xd rest(3, target.rest_points.size());
  for (int i = 0; i < rest.cols(); ++i) rest.col(i) = target.rest_points[i];
  const Eigen::Matrix3Xd now = log::PlantPoints(plant, rest).at(plant_positions);
  const Eigen::Vector3d feature = now.rowwise().mean();
  const Eigen::Vector3d goal = target.values.head<3>();
  math::Pose at = math::Pose::Identity();
  at.translation() = X_WO * feature;
  renderer.draw_sphere(at, 0.010, kFeature);
  at.translation() = X_WO * goal;
  renderer.draw_sphere(at, 0.012, kTarget);
  renderer.draw_line(X_WO * (goal - target.displacement), X_WO * goal, 3, kTarget);
}

void draw_scene(draw::Renderer& renderer, const Demo& demo, const Scene& scene) {
  const log::RunLog& log = *scene.log;
  const config::Node configuration =
      config::Node::load_file(demo.file("rt/config/examples/bar_long_soft.yaml").string());
  const math::Pose X_WO = registry::read_frames(configuration).X_WO;
  const log::MeshMessage plant = log::assemble(log.truth_chunks);
  const log::MeshMessage estimate = log::assemble(log.shape_chunks);
  const Eigen::Matrix3Xd truth = log::positions(shown_at(log.truths, scene.utime));
  const Eigen::Matrix3Xd truth_W = log::transformed(X_WO, truth);

  const Eigen::Vector3d middle = truth_W.rowwise().mean() + Eigen::Vector3d(-0.12, 0, 0.02);
  const Eigen::Vector3d eye = middle + Eigen::Vector3d(-0.35, -1.45, 0.55);
  renderer.begin(
      draw::make_view(eye, middle, Eigen::Vector3d::UnitZ(), kFieldOfView, kWidth, kHeight));
  if (!log.robot.empty())
    draw_robot(renderer, demo.file("sim/robot/lwr_hand.urdf"), shown_at(log.robot, scene.utime));
  draw_clamp(renderer, X_WO, plant);

  draw::MeshStyle style;
  style.colour = kTruth;
  renderer.draw_mesh(truth_W, plant.triangles, style);
  style.colour = kStart;
  renderer.draw_mesh(
      log::transformed(X_WO, log::positions(shown_at(log.truths, scene.start_utime))),
      plant.triangles, style);
  style.colour = kEstimate;
  style.edges = kEstimateEdge;
  renderer.draw_mesh(log::transformed(X_WO, log::positions(shown_at(log.shapes, scene.utime))),
                     estimate.triangles, style);
  if (scene.target != nullptr) draw_target(renderer, X_WO, plant, truth, *scene.target);
}

void annotate(draw::Image& image, const Scene& scene) {
  std::vector<draw::LegendEntry> legend{
      {"true shape", kTruth}, {"estimated shape", kEstimateEdge}, {"shape at the start", kStart}};
  if (scene.target != nullptr) legend.push_back({"target of the feature", kTarget});
  draw::draw_title(image, scene.title);
  draw::draw_legend(image, legend);
}

}  // namespace

bool draw_picture(const Demo& demo, const Scene& scene, const std::filesystem::path& png) {
  try {
    draw::Renderer renderer(kWidth, kHeight, kSupersampling);
    draw_scene(renderer, demo, scene);
    draw::Image image = renderer.end();
    annotate(image, scene);
    draw::write_png(png.string(), image);
    return true;
  } catch (const std::exception& error) {
    std::cerr << "no picture " << png.filename().string() << ": " << error.what() << '\n';
    return false;
  }
}

}  // namespace palpate::demo

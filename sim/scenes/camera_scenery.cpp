#include "sim/scenes/camera_scenery.hpp"

#include <optional>

namespace palpate::scenes {
namespace {

constexpr double kRigThickness = 0.03;  // m
constexpr double kRigOverhang = 1.6;    // side lengths relative to those of the face
const draw::Colour kRigColour{0.35F, 0.37F, 0.40F, 1};

draw::TriangleMesh mesh_of(const robot::VisualShape& visual) {
  switch (visual.kind) {
    case robot::ShapeKind::kBox:
      return draw::make_box(visual.size);
    case robot::ShapeKind::kCylinder:
      return draw::make_cylinder(visual.size.x(), visual.size.y());
    case robot::ShapeKind::kSphere:
      return draw::make_sphere(visual.size.x());
  }
  return {};
}

camera::Body make_body(draw::TriangleMesh mesh, const math::Pose& X, const draw::Colour& colour,
                       bool is_object = false) {
  return {std::make_shared<const draw::TriangleMesh>(std::move(mesh)), X, colour, is_object};
}

/// In O; none if the clamp is not a face of the box.
std::optional<camera::Body> rig(const object::PlantOptions& plant) {
  if (!plant.clamp) return std::nullopt;
  const Eigen::Vector3d lower = plant.origin, upper = plant.origin + plant.size;
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool is_upper : {false, true}) {
      const double face = is_upper ? upper[axis] : lower[axis];
      if (plant.clamp->lower[axis] != face || plant.clamp->upper[axis] != face) continue;
      Eigen::Vector3d size = kRigOverhang * plant.size, centre = 0.5 * (lower + upper);
      size[axis] = kRigThickness;
      centre[axis] = face + (is_upper ? 0.5 : -0.5) * kRigThickness;
      return make_body(draw::make_box(size), math::make_pose(Eigen::Matrix3d::Identity(), centre),
                       kRigColour);
    }
  }
  return std::nullopt;
}

}  // namespace

CameraScenery::CameraScenery(const Scene& scene, const std::vector<Arm>& arms)
    : X_WO_(scene.X_WO), object_colour_(scene.camera->filter.colour) {
  for (std::size_t i = 0; i < arms.size(); ++i) {
    for (const robot::VisualShape& visual : arms[i].robot().visuals()) {
      const Eigen::Vector3f c = visual.colour.cast<float>();
      visuals_.push_back(
          {i, visual.link, make_body(mesh_of(visual), visual.X_LV, {c.x(), c.y(), c.z(), 1})});
    }
  }
  if (std::optional<camera::Body> block = rig(scene.plant)) {
    block->X_WB = X_WO_ * block->X_WB;
    still_.push_back(*block);
  }
}

std::vector<camera::Body> CameraScenery::now(const std::vector<Arm>& arms,
                                             const object::Plant& plant) const {
  std::vector<camera::Body> bodies = still_;
  for (const Visual& visual : visuals_) {
    const Arm& arm = arms[visual.arm];
    const math::Pose X_base = X_WO_ * arm.scene().X_WO.inverse();
    bodies.push_back(visual.body);
    bodies.back().X_WB = X_base * arm.robot().link_pose(visual.link) * visual.body.X_WB;
  }
  bodies.push_back(
      make_body({plant.positions(), plant.surface_triangles()}, X_WO_, object_colour_, true));
  return bodies;
}

}  // namespace palpate::scenes

#include "tools/drawing/obstacle_drawing.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <variant>

#include "core/collision/obstacle.hpp"
#include "core/kinematics/serial_chain.hpp"
#include "rt/bus/text.hpp"
#include "rt/config/mesh_file.hpp"

namespace palpate::drawing {
namespace {

struct SizeOfShape {
  Eigen::Vector3d operator()(const collision::HalfSpace& /*plane*/) const { return {0, 0, 0}; }
  Eigen::Vector3d operator()(const collision::Box& box) const { return 2 * box.half_size; }
  Eigen::Vector3d operator()(const collision::Sphere& sphere) const {
    return {sphere.radius, 0, 0};
  }
  Eigen::Vector3d operator()(const collision::Cylinder& cylinder) const {
    return {cylinder.radius, std::isfinite(cylinder.length) ? cylinder.length : 0, 0};
  }
  Eigen::Vector3d operator()(const collision::Capsule& capsule) const {
    return {capsule.radius, capsule.length, 0};
  }
  Eigen::Vector3d operator()(const std::shared_ptr<const collision::DistanceGrid>& /*grid*/) const {
    return {0, 0, 0};
  }
};

/// Empty if the numbers are not those of a pose.
std::optional<math::Pose> to_pose(const double* position, const double* wxyz) {
  const Eigen::Map<const Eigen::Vector3d> p(position);
  if (!p.allFinite() || !math::is_unit_quaternion(wxyz)) return std::nullopt;
  return math::make_pose(math::rotation_from_wxyz(wxyz), p);
}

}  // namespace

std::vector<ObstacleDrawing> read_obstacle_drawings(const config::Node& root) {
  std::vector<ObstacleDrawing> drawings;
  const std::vector<config::Node> nodes = root.list("obstacles");
  // Poses in O are not needed: those of the carriers refer to W or a link.
  for (const registry::ConfiguredObstacle& obstacle :
       registry::read_obstacles(root, math::Pose::Identity())) {
    const config::Node& node = nodes[drawings.size()];
    const collision::Obstacle& body = obstacle.limited.body;
    ObstacleDrawing& drawing = drawings.emplace_back();
    drawing.name = body.name;
    drawing.kind = node.text("shape");
    drawing.size = std::visit(SizeOfShape(), body.shape);
    // The grid of distances, which the model uses, does not contain the surface.
    if (drawing.kind == "mesh") drawing.surface = config::load_surface(node.path("file"));
    drawing.carrier = obstacle.carrier;
    drawing.is_placed = body.is_known;
  }
  return drawings;
}

std::optional<math::Pose> pose_in_world(const ObstacleDrawing& obstacle,
                                        const PlacingMessages& messages) {
  using Kind = registry::ObstacleCarrier::Kind;
  if (const obstacles_t* published = messages.published) {
    for (int i = 0; i < std::min(published->count, static_cast<int>(obstacles_t::MOST)); ++i) {
      if (obstacle.name != bus::get_text(published->name[i])) continue;
      if (published->is_placed[i] == 0) return std::nullopt;
      return to_pose(published->position[i], published->quaternion[i]);
    }
  }
  const registry::ObstacleCarrier& carrier = obstacle.carrier;
  if (carrier.kind == Kind::kLink) {
    const int needed = carrier.link->joint_count();
    if (!messages.robot || messages.robot->joint_count < needed) return std::nullopt;
    kinematics::SerialChain::State state;
    carrier.link->evaluate(Eigen::Map<const Eigen::VectorXd>(messages.robot->q, needed), state);
    return state.X_WE * carrier.X_AB;
  }
  if (carrier.kind == Kind::kMessages && messages.moved)
    return to_pose(messages.moved->position, messages.moved->quaternion);
  if (!obstacle.is_placed) return std::nullopt;
  return carrier.X_AB;
}

}  // namespace palpate::drawing

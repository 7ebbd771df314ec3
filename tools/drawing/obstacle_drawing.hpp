#pragma once

#include <optional>
#include <palpate/obstacles_t.hpp>
#include <palpate/robot_state_t.hpp>
#include <palpate/world_state_t.hpp>
#include <string>
#include <vector>

#include "core/math/rigid.hpp"
#include "core/mesh/triangle_surface.hpp"
#include "rt/config/node.hpp"
#include "rt/registry/obstacles.hpp"

namespace palpate::drawing {

/// Appearance of an obstacle of the daemon's configuration, and what carries it.
struct ObstacleDrawing {
  std::string name;
  std::string kind;  // its `shape` in the configuration
  /// m. Box: edge lengths; sphere: radius, 0, 0; cylinder and capsule: radius, length along z of
  /// the cylinder (0: infinite) or of the capsule's segment, 0; others: zero.
  Eigen::Vector3d size = Eigen::Vector3d::Zero();
  mesh::TriangleSurface surface{};  // of a mesh, in the shape's frame; otherwise empty
  registry::ObstacleCarrier carrier;
  bool is_placed = false;  // whether the configuration alone places it: not if a link carries it
};

/// Reads `obstacles` by the daemon's own reader. Throws config::Error.
std::vector<ObstacleDrawing> read_obstacle_drawings(const config::Node& root);

/// The last messages that may say where an obstacle is; nullptr: there is none.
struct PlacingMessages {
  const obstacles_t* published = nullptr;  // OBSTACLES
  const robot_state_t* robot = nullptr;    // ROBOT_STATE of the first arm
  const world_state_t* moved = nullptr;    // WORLD_STATE with the obstacle's name
};

/// Pose in W of a shape's frame: the one that the daemon has published. If it has published none,
/// an obstacle of a link follows the joints, and one that messages move has the pose of its last
/// message, or without one that of the configuration. Empty while nothing places it.
std::optional<math::Pose> pose_in_world(const ObstacleDrawing& obstacle,
                                        const PlacingMessages& messages);

}  // namespace palpate::drawing

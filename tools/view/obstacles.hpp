#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/math/rigid.hpp"
#include "tools/drawing/obstacle_drawing.hpp"
#include "tools/view/scene.hpp"

namespace palpate::view {

/// Estimate of an obstacle's displacement in a free direction.
struct ObstacleCorrection {
  int axis;             // 0 to 2: along x, y, z of the shape's frame; 3 to 5: about them
  double displacement;  // m or rad
  double deviation;     // its standard deviation, m or rad
};

/// Where an obstacle is.
struct ObstaclePlace {
  std::optional<math::Pose> X_WB;       // empty: no configuration or message has placed it yet
  std::optional<std::int64_t> time_us;  // arrival, as in Scene, of the last message that moves it
  std::vector<ObstacleCorrection>
      corrections;  // of the free directions, while the daemon publishes
};

/// By the last messages of the scene: OBSTACLES, as model and control of the daemon have it; where
/// that is absent or late, ROBOT_STATE for an obstacle of a link, and WORLD_STATE for one that
/// messages move, whose codes are not checked.
ObstaclePlace place_of(const drawing::ObstacleDrawing& obstacle, const Scene& scene);

/// Parcel of an obstacle: index, name, kind, size, carrier (fixed, link, messages), timeout_ms; of
/// a mesh the arrays points, m, and triangles.
std::string encode_obstacle(int index, const drawing::ObstacleDrawing& obstacle);

/// Of each obstacle: {placed, age_ms, corrections}: the age at `shown_us` of the last message that
/// moves it, null if there is none; for each free direction its axis (along x, about x, ...),
/// displacement and standard deviation, both in mm or degrees. Appends to `poses` for each its
/// position and quaternion x, y, z, w in O, zero if it is not placed.
nlohmann::json describe_places(const std::vector<drawing::ObstacleDrawing>& obstacles,
                               const math::Pose& X_WO, const Scene& scene, std::int64_t shown_us,
                               std::vector<float>& poses);

}  // namespace palpate::view

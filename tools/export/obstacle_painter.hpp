#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "rt/config/node.hpp"
#include "sim/draw/renderer.hpp"
#include "tools/drawing/obstacle_drawing.hpp"
#include "tools/export/shape_follower.hpp"

namespace palpate::exporting {

/// Draws the obstacles of palpated's configuration in W as translucent solids; a half-space as a
/// plate below the object, with its normal.
class ObstaclePainter {
 public:
  static constexpr draw::Colour kColour{0.47F, 0.42F, 0.72F, 0.4F};

  ObstaclePainter() = default;  // without obstacles
  /// Throws config::Error.
  explicit ObstaclePainter(const config::Node& configuration)
      : obstacles_(drawing::read_obstacle_drawings(configuration)) {}

  /// Each where joints and messages of the instant put it; those that nothing has placed yet are
  /// left out. `object_W`: bounds of the object.
  void draw(const Instant& instant, const Eigen::AlignedBox3d& object_W, draw::Renderer& renderer);
  /// Names of those that draw() has drawn last, separated by commas.
  const std::string& drawn() const { return drawn_; }

 private:
  std::vector<drawing::ObstacleDrawing> obstacles_;
  std::string drawn_;
};

}  // namespace palpate::exporting

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/drawing/robot_drawing.hpp"
#include "tools/view/components.hpp"

namespace palpate::view {

/// An arm that can be drawn: its shapes, and the pose of its base.
struct PlacedRobot {
  drawing::RobotDrawing drawing;
  math::Pose X_OW;
};

/// Properties of the cell that no message contains: poses of arm and object, appearance of the arm,
/// initial components of the daemon.
struct Cell {
  std::vector<std::optional<PlacedRobot>> robots;  // of arm 0 and 1
  std::vector<Configured> configured;
  std::optional<math::Pose> X_WO;

  /// From the daemon's configuration and a URDF file; if the URDF is empty, that of the
  /// configuration's section `robot`, or none. Throws config::Error and std::invalid_argument.
  static Cell read(const std::string& configuration, const std::vector<std::string>& overrides,
                   const std::string& urdf, const std::string& flange);
};

}  // namespace palpate::view

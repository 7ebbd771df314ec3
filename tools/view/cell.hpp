#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/drawing/robot_drawing.hpp"
#include "tools/view/components.hpp"

namespace palpate::view {

/// An arm that can be drawn: its shapes, and where its base is.
struct PlacedRobot {
  drawing::RobotDrawing drawing;
  math::Pose X_OW;
};

/// What no message tells of the cell: where arm and object are, how the arm looks, which components
/// the daemon began with.
struct Cell {
  std::vector<std::optional<PlacedRobot>> robots;  // of arm 0 and 1
  std::vector<Configured> configured;
  std::optional<math::Pose> X_WO;

  /// From the daemon's configuration and a URDF file; an empty URDF: that of the configuration's
  /// section `robot`, else none. Throws config::Error and std::invalid_argument.
  static Cell read(const std::string& configuration, const std::vector<std::string>& overrides,
                   const std::string& urdf, const std::string& flange);
};

}  // namespace palpate::view

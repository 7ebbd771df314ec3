#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rt/config/node.hpp"
#include "tools/drawing/obstacle_drawing.hpp"
#include "tools/drawing/robot_drawing.hpp"

namespace palpate::view {

/// One choice within a slot: its key in a configuration, and its allowed values.
struct Choice {
  std::string key;  // component; provider and law of the controller
  std::vector<std::string> names;
};

/// A slot of the pipeline as defined in rt/registry.
struct SlotChoices {
  std::string slot;
  bool has_instances = false;  // a list of named ones
  std::vector<Choice> choices;
};

/// All slots whose components can be replaced.
const std::vector<SlotChoices>& slot_choices();

/// Contents of a slot in a configuration.
struct Configured {
  std::string slot, instance;
  std::vector<std::pair<std::string, std::string>> chosen;  // key and name
};

/// In the order of the pipeline. Throws config::Error.
std::vector<Configured> read_configured(const config::Node& root);

/// An arm that can be drawn: its shapes, and the pose of its base.
struct PlacedRobot {
  drawing::RobotDrawing drawing;
  math::Pose X_OW;
};

/// Properties of the cell that no message contains: poses of arm and object, appearance of arm and
/// obstacles, initial components of the daemon.
struct Cell {
  std::vector<std::optional<PlacedRobot>> robots;  // of arm 0 and 1
  std::vector<drawing::ObstacleDrawing> obstacles;
  std::vector<Configured> configured;
  std::optional<math::Pose> X_WO;

  /// From the daemon's configuration and a URDF file; if the URDF is empty, that of the
  /// configuration's section `robot`, or none. Throws config::Error and std::invalid_argument.
  static Cell read(const std::string& configuration, const std::vector<std::string>& overrides,
                   const std::string& urdf, const std::string& flange);
};

}  // namespace palpate::view

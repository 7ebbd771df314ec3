#include "tools/view/cell.hpp"

#include "rt/registry/frames.hpp"

namespace palpate::view {

Cell Cell::read(const std::string& configuration, const std::vector<std::string>& overrides,
                const std::string& urdf, const std::string& flange) {
  Cell cell;
  const config::Node root = config::Node::load_file(configuration, overrides);
  cell.configured = read_configured(root);
  const registry::Frames frames = registry::read_frames(root);
  cell.X_WO = frames.X_WO;
  std::string file = urdf, link = flange;
  if (file.empty() && root.has("robot")) {
    const config::Node robot = root.child("robot");
    file = robot.path("urdf");
    if (link.empty()) link = robot.text("flange", "flange");
  }
  if (link.empty()) link = "flange";
  if (file.empty()) return cell;
  cell.robots.emplace_back(PlacedRobot{drawing::RobotDrawing(file, link), frames.X_WO.inverse()});
  if (const auto second = registry::read_second_frames(root))
    cell.robots.emplace_back(
        PlacedRobot{drawing::RobotDrawing(file, link), second->X_WO.inverse()});
  return cell;
}

}  // namespace palpate::view

#include "tools/view/cell.hpp"

#include "rt/registry/frames.hpp"

namespace palpate::view {
const std::vector<SlotChoices>& slot_choices() {
  // A test compares this list with the registries.
  static const std::vector<SlotChoices> all = {
      {"sensing",
       true,
       {{"component",
         {"ft_newton_euler", "ft_rnnob", "ft_tare_only", "joint_torque", "biotac_linear",
          "biotac_lstm", "fingertip", "manual"}}}},
      {"contact", true, {{"component", {"area_coordinates", "wrench_patch"}}}},
      {"estimation",
       false,
       {{"component",
         {"pose_driven", "force_driven", "wrench_driven", "fingertip_driven",
          "pose_wrench_filter"}}}},
      {"deformation",
       false,
       {{"component",
         {"corotational_quasistatic", "corotational_dynamic", "hyperelastic", "linear",
          "mass_spring", "shape_matching"}}}},
      {"feature",
       false,
       {{"component",
         {"point", "points", "pose", "distance", "angle", "curvature", "fourier_contour"}}}},
      {"control",
       false,
       {{"provider", {"fem", "kinematic"}},
        {"law",
         {"proportional_twist", "dual_quaternion", "quadratic_program", "guarded_motion"}}}}};
  return all;
}

std::vector<Configured> read_configured(const config::Node& root) {
  std::vector<Configured> all;
  for (const SlotChoices& slot : slot_choices()) {
    const auto read = [&](const config::Node& node) {
      Configured one{slot.slot, slot.has_instances ? node.text("name", "") : "", {}};
      for (const Choice& choice : slot.choices)
        one.chosen.emplace_back(choice.key, node.text(choice.key, ""));
      all.push_back(one);
    };
    if (slot.has_instances)
      for (const config::Node& node : root.list(slot.slot)) read(node);
    else if (root.has(slot.slot))
      read(root.child(slot.slot));
  }
  return all;
}

Cell Cell::read(const std::string& configuration, const std::vector<std::string>& overrides,
                const std::string& urdf, const std::string& flange) {
  Cell cell;
  const config::Node root = config::Node::load_file(configuration, overrides);
  cell.configured = read_configured(root);
  const registry::Frames frames = registry::read_frames(root);
  cell.X_WO = frames.X_WO;
  cell.obstacles = drawing::read_obstacle_drawings(root);
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

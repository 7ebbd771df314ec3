#include "tools/view/cell.hpp"

#include "rt/registry/frames.hpp"
#include "rt/registry/published_control_registry.hpp"
#include "rt/registry/published_sensing_registry.hpp"

namespace palpate::view {
namespace {

std::vector<std::string> with(std::vector<std::string> names,
                              const std::vector<std::string>& more) {
  names.insert(names.end(), more.begin(), more.end());
  return names;
}

}  // namespace

const std::vector<SlotChoices>& slot_choices() {
  // A test compares this list with the registries.
  static const std::vector<SlotChoices> all = {
      {"sensing",
       true,
       {{"component",
         {"ft_newton_euler", "ft_rnnob", "ft_tare_only", "biotac_linear", "biotac_lstm",
          "manual"}}}},
      {"contact", true, {{"component", {"area_coordinates", "wrench_patch"}}}},
      {"estimation",
       false,
       {{"component", with({"pose_driven", "force_driven", "wrench_driven", "fingertip_driven",
                            "pose_wrench_filter"},
                           registry::published_sensing_names())}}},
      {"deformation",
       false,
       {{"component",
         {"corotational_quasistatic", "corotational_dynamic", "linear", "mass_spring",
          "shape_matching", "as_rigid_as_possible"}}}},
      {"feature",
       false,
       {{"component",
         {"point", "points", "pose", "distance", "angle", "curvature", "fourier_contour"}}}},
      {"control",
       false,
       {{"provider", with({"fem", "kinematic"}, registry::published_providers())},
        {"law", {"proportional_twist", "dual_quaternion", "quadratic_program"}}}}};
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

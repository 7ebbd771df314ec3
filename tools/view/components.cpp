#include "tools/view/components.hpp"

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

}  // namespace palpate::view

#include "tools/view/components.hpp"

namespace palpate::view {

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
       {{"component",
         {"pose_driven", "force_driven", "wrench_driven", "fingertip_driven",
          "pose_wrench_filter"}}}},
      {"deformation",
       false,
       {{"component",
         {"corotational_quasistatic", "corotational_dynamic", "linear", "mass_spring",
          "shape_matching"}}}},
      {"feature",
       false,
       {{"component",
         {"point", "points", "pose", "distance", "angle", "curvature", "fourier_contour"}}}},
      {"control",
       false,
       {{"provider", {"fem", "kinematic"}},
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

#include "tools/view/cell.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <map>

#include "rt/registry/registry.hpp"

namespace palpate::view {
namespace {

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// The known names listed in a registry's error for an unknown one.
std::string asked(const std::function<void(const config::Node&)>& make, const std::string& key) {
  try {
    make(config::Node::from_text("{" + key + ": unknown_name}"));
  } catch (const config::Error& error) {
    const std::string text = error.what();
    const std::size_t at = text.find("allowed: ");
    return at == std::string::npos ? text : text.substr(at + 9);
  }
  return "no error";
}

TEST(Components, AreThoseOfTheRegistries) {
  const registry::Object object = registry::read_object(
      config::Node::from_text("object: {mesh: {box: {size: [0.4, 0.1, 0.1], cells: [4, 1, 1]}}, "
                              "material: {young_modulus: 3e4, poisson_ratio: 0.3, density: 26}, "
                              "fixed_box: {lower: [0, 0, 0], upper: [0, 0.1, 0.1]}, "
                              "grasp_box: {lower: [0.3, 0, 0], upper: [0.4, 0.1, 0.1]}}"),
      {});
  registry::Context context;
  context.object = &object;
  const auto feature = registry::make_feature(
      config::Node::from_text("{component: point, rest_points: [[0.2, 0.05, 0.1]]}"), context);
  using config::Node;
  const std::map<std::string, std::function<void(const Node&)>> registries = {
      {"sensing", [&](const Node& n) { registry::make_sensor_model(n, context); }},
      {"contact", [&](const Node& n) { registry::make_force_transformer(n, context); }},
      {"estimation", [&](const Node& n) { registry::make_estimator(n, context); }},
      {"deformation", [&](const Node& n) { registry::make_deformation_model(n, context); }},
      {"feature", [&](const Node& n) { registry::make_feature(n, context); }}};
  ASSERT_EQ(slot_choices().size(), registries.size() + 1);
  for (const SlotChoices& slot : slot_choices()) {
    if (slot.slot == "control") {
      ASSERT_EQ(slot.choices.size(), 2U);
      EXPECT_EQ(
          listed(slot.choices[0].names),
          asked([&](const Node& n) { registry::make_jacobian_provider(n, context, *feature); },
                "provider"));
      EXPECT_EQ(
          listed(slot.choices[1].names),
          asked([&](const Node& n) { registry::make_control_law(n, context, *feature); }, "law"));
      continue;
    }
    ASSERT_EQ(slot.choices.size(), 1U);
    EXPECT_EQ(listed(slot.choices[0].names), asked(registries.at(slot.slot), "component"))
        << slot.slot;
  }
}

TEST(Components, OfAConfiguration) {
  const auto all = read_configured(config::Node::load_file(
      std::string(PALPATE_SOURCE_DIR) + "/rt/config/examples/bar_long_soft.yaml"));
  ASSERT_EQ(all.size(), 6U);
  EXPECT_EQ(all[0].slot, "sensing");
  EXPECT_EQ(all[0].instance, "wrist");
  EXPECT_EQ(all[0].chosen[0].second, "ft_newton_euler");
  EXPECT_EQ(all[5].chosen[0].second, "fem");
  EXPECT_EQ(all[5].chosen[1].second, "proportional_twist");
}

}  // namespace
}  // namespace palpate::view

#include "core/contact/area_coordinates.hpp"
#include "core/contact/wrench_patch.hpp"
#include "rt/plugin/built_in_names.hpp"
#include "rt/registry/plugin_registry.hpp"
#include "rt/registry/registry.hpp"

namespace palpate::registry {
namespace {

std::unique_ptr<contact::ForceTransformer> make_area_coordinates(const config::Node& node,
                                                                 const Object& object) {
  contact::AreaCoordinates::Options options;
  options.collision_distance = node.number(
      {"collision_distance", "m", "from the surface, beyond which a contact is refused"}, {0, 10},
      options.collision_distance);
  if (node.has("fixed_rest_points"))
    options.fixed_rest_points = node.points({"fixed_rest_points", "m",
                                             "rest points in O that always carry the load, in "
                                             "equal parts: a grasp that does not slide"});
  return std::make_unique<contact::AreaCoordinates>(object.body.mesh, object.surface, options);
}

std::unique_ptr<contact::ForceTransformer> make_wrench_patch(const config::Node& node,
                                                             const Object& object) {
  contact::WrenchPatch::Options options;
  options.radius =
      node.number({"radius", "m", "of the patch; widened where it holds too few nodes"}, {1e-4, 10},
                  options.radius);
  options.collision_distance = node.number(
      {"collision_distance", "m", "from the surface, beyond which a contact is refused"}, {0, 10},
      options.collision_distance);
  if (node.flag(
          {"on_grasp", "",
           "whether the nodes of the grasp carry the load, wherever the contact is said to be"},
          false)) {
    const int grasp =
        node.integer({"grasp", "", "which grasp: 0, or 1 of the second hand"}, {0, 1}, 0);
    const int count = static_cast<int>(object.body.grasps.size());
    if (count == 0) node.fail("on_grasp", "the object has no grasp_box");
    if (grasp >= count) node.fail("grasp", "the object has no second_grasp_box");
    options.fixed_nodes = object.body.grasps[grasp].nodes;
    options.fixed_reference = object.body.grasps[grasp].X_OG_rest.translation();
  }
  return std::make_unique<contact::WrenchPatch>(object.body.mesh, object.surface, options);
}

}  // namespace

std::unique_ptr<contact::ForceTransformer> make_force_transformer(const config::Node& node,
                                                                  const Context& context) {
  const auto& plugins = plugins_of(context).force_transformers;
  const std::string name =
      node.choice({"component", "", "how a wrench at a place becomes loads of nodes"},
                  plugin::with_plugins(plugin::kForceTransformers, plugins));
  if (const auto* entry = plugin::find_plugin(plugins, name))
    return make_plugin(*entry, node, context);
  try {
    return name == "area_coordinates" ? make_area_coordinates(node, *context.object)
                                      : make_wrench_patch(node, *context.object);
  } catch (const std::invalid_argument& error) {
    node.fail("", error.what());
  }
}

}  // namespace palpate::registry

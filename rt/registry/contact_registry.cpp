#include "core/contact/area_coordinates.hpp"
#include "core/contact/wrench_patch.hpp"
#include "rt/registry/slot.hpp"

namespace palpate::registry {
namespace {

using config::OptionTable;
using contact::AreaCoordinates;
using contact::WrenchPatch;

template <class Options>
OptionTable<Options> contact_options() {
  return OptionTable<Options>().number(
      "collision_distance", "m", "Distance from the surface beyond which a contact is rejected",
      {0, 10}, &Options::collision_distance);
}

std::unique_ptr<contact::ForceTransformer> make_area_coordinates(AreaCoordinates::Options options,
                                                                 const config::Node& node,
                                                                 const Context& context) {
  if (node.has("fixed_rest_points"))
    options.fixed_rest_points = node.points(
        {"fixed_rest_points", "m",
         "Points of the rest shape, in O, that always carry the load in equal parts: a grasp "
         "without slip"});
  const Object& object = *context.object;
  return std::make_unique<AreaCoordinates>(object.body.mesh, object.surface, options);
}

std::unique_ptr<contact::ForceTransformer> make_wrench_patch(WrenchPatch::Options options,
                                                             const config::Node& node,
                                                             const Context& context) {
  const Object& object = *context.object;
  if (node.flag({"on_grasp", "",
                 "Application of the load to the nodes of the grasp, whatever the reported "
                 "location"},
                false)) {
    const int grasp =
        node.integer({"grasp", "", "Index of the grasp; 1: that of the second hand"}, {0, 1}, 0);
    const int count = static_cast<int>(object.body.grasps.size());
    if (count == 0) node.fail("on_grasp", "the object has no grasp_box");
    if (grasp >= count)
      node.fail("grasp", std::to_string(grasp) + ": the object has no second_grasp_box");
    options.fixed_nodes = object.body.grasps[grasp].nodes;
    options.fixed_reference = object.body.grasps[grasp].X_OG_rest.translation();
  }
  return std::make_unique<WrenchPatch>(object.body.mesh, object.surface, options);
}

}  // namespace

std::unique_ptr<contact::ForceTransformer> make_force_transformer(const config::Node& node,
                                                                  const Context& context) {
  static const auto slot =
      Slot<plugin::PluginForceTransformer>(
          {"component", "", "Method that converts a wrench at a location into loads of nodes"},
          &plugin::PluginRegistrar::force_transformers)
          .add("area_coordinates", "Load on the nodes of the nearest triangle of the surface",
               contact_options<AreaCoordinates::Options>(), make_area_coordinates)
          .add("wrench_patch", "Wrench spread over the nodes of a patch",
               contact_options<WrenchPatch::Options>().number(
                   "radius", "m", "Radius of the patch; increased where it contains too few nodes",
                   {1e-4, 10}, &WrenchPatch::Options::radius),
               make_wrench_patch);
  return slot.make(node, context);
}

}  // namespace palpate::registry

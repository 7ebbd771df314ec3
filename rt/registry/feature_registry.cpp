#include "core/shape/angle_feature.hpp"
#include "core/shape/curvature_feature.hpp"
#include "core/shape/fourier_contour_feature.hpp"
#include "core/shape/point_features.hpp"
#include "core/shape/pose_feature.hpp"
#include "rt/registry/slot.hpp"

namespace palpate::registry {
namespace {

using config::Node;
using shape::FourierContourFeature;
using shape::PointsFeature;
using Points = std::vector<Eigen::Vector3d>;

/// `what`: description of the points; `count`: their number, 0 for any that the feature accepts.
Points rest_points(const Node& node, const char* what, std::size_t count = 0) {
  const Points points = node.points({"rest_points", "m", what});
  if (count != 0 && points.size() != count)
    node.fail("rest_points", "has " + std::to_string(points.size()) +
                                 " points; allowed: " + std::to_string(count));
  return points;
}

std::vector<int> components(const Node& node) {
  if (!node.has("components")) return {0, 1, 2};
  std::vector<int> axes;
  for (const double axis :
       node.numbers({"components", "",
                     "Axes of O along which the feature is evaluated: 0, 1, 2 for x, y, z; "
                     "absent: all"},
                    -1, {0, 2})) {
    axes.push_back(static_cast<int>(axis));
  }
  return axes;
}

std::optional<Eigen::Vector3d> axis(const Node& node) {
  if (!node.has("axis")) return {};
  return node.vector3({"axis", "",
                       "Axis in O about which the angle or curvature has a sign; absent: it has "
                       "none"});
}

/// The listed points, or a sample of the surface.
Points set_of_points(const Node& node, const Object& object) {
  const mesh::ElementMesh& mesh = object.body.mesh;
  if (!node.has("surface")) return rest_points(node, "Points of the rest shape, in O: 1 to 512");
  if (node.has("rest_points"))
    node.fail("rest_points", "has no meaning together with \"surface\"; allowed: one of them");
  const int count = node.integer({"surface", "",
                                  "Number of points spread over the surface, in place of "
                                  "rest_points"},
                                 {1, PointsFeature::kMostPoints});
  if (!node.has("surface_group")) return shape::surface_points(mesh, count);
  const Eigen::Matrix3Xi& triangles =
      read_group(node,
                 {"surface_group", "",
                  "Named group of triangles of the mesh file over which the points of surface are "
                  "spread; absent: the whole surface"},
                 object.groups)
          .triangles;
  if (triangles.cols() == 0)
    node.fail("surface_group", "this group of the mesh holds no triangles");
  return shape::surface_points(mesh, triangles, count);
}

/// Creates a feature from the mesh and the options that `read` returns, of node and object.
template <class Feature, class Read>
auto on_mesh(Read read) {
  return [read](const Node& node, const Context& context) -> std::unique_ptr<shape::Feature> {
    return std::make_unique<Feature>(context.object->body.mesh,
                                     typename Feature::Options(read(node, *context.object)));
  };
}

}  // namespace

std::unique_ptr<shape::Feature> make_feature(const Node& node, const Context& context) {
  static const auto slot =
      Slot<plugin::PluginFeature>({"component", "", "Kind of the feature"},
                                  &plugin::PluginRegistrar::features)
          .add("point", "Position of a point",
               on_mesh<shape::PointFeature>([](const Node& own, const Object&) {
                 return shape::PointFeature::Options{
                     rest_points(own, "One point of the rest shape, in O", 1)[0], components(own)};
               }))
          .add("points", "Positions of several points",
               on_mesh<PointsFeature>([](const Node& own, const Object& object) {
                 return PointsFeature::Options{set_of_points(own, object)};
               }))
          .add("pose", "Pose of a part of the object, from three points",
               on_mesh<shape::PoseFeature>([](const Node& own, const Object&) {
                 const Points points = rest_points(
                     own, "Three points of the rest shape, in O; the first is the position", 3);
                 return shape::PoseFeature::Options{{points[0], points[1], points[2]}};
               }))
          .add("distance", "Distance between two points",
               on_mesh<shape::DistanceFeature>([](const Node& own, const Object&) {
                 return shape::DistanceFeature::Options{
                     rest_points(own, "Two points of the rest shape, in O")};
               }))
          .add("angle", "Angle at a point or between two directions",
               on_mesh<shape::AngleFeature>([](const Node& own, const Object&) {
                 return shape::AngleFeature::Options{
                     rest_points(own,
                                 "Points of the rest shape, in O: 3, the second is the corner, or "
                                 "4 for two directions"),
                     axis(own)};
               }))
          .add("curvature", "Curvature of a line",
               on_mesh<shape::CurvatureFeature>([](const Node& own, const Object&) {
                 return shape::CurvatureFeature::Options{
                     rest_points(own, "Points of the rest shape, in O: 3 or 5 along the line"),
                     axis(own)};
               }))
          .add("fourier_contour", "Fourier coefficients of a contour",
               on_mesh<FourierContourFeature>([](const Node& own, const Object&) {
                 auto options = own.read(
                     config::OptionTable<FourierContourFeature::Options>()
                         .integer("harmonics",
                                  "Number of harmonics of the contour, four values per plane each",
                                  {1, 31}, &FourierContourFeature::Options::harmonics)
                         .flag("closed", "Closed contour; else an open one",
                               &FourierContourFeature::Options::closed));
                 options.rest_points =
                     rest_points(own, "Points of the rest shape, in O: up to 64 along the contour");
                 options.components = components(own);
                 return options;
               }));
  return slot.make(node, context);
}

}  // namespace palpate::registry

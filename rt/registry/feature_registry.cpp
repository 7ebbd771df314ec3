#include "core/shape/angle_feature.hpp"
#include "core/shape/curvature_feature.hpp"
#include "core/shape/distance_feature.hpp"
#include "core/shape/fourier_contour_feature.hpp"
#include "core/shape/point_feature.hpp"
#include "core/shape/points_feature.hpp"
#include "core/shape/pose_feature.hpp"
#include "rt/plugin/built_in_names.hpp"
#include "rt/registry/plugin_registry.hpp"

namespace palpate::registry {
namespace {

std::vector<Eigen::Vector3d> rest_points(const config::Node& node, std::size_t count) {
  const std::vector<Eigen::Vector3d> points = node.points(
      {"rest_points", "m",
       "of the rest shape, in O: one; for a pose three, of which the first is the place"});
  if (points.size() != count) {
    node.fail("rest_points", "has " + std::to_string(points.size()) +
                                 " points; allowed: " + std::to_string(count));
  }
  return points;
}

std::vector<int> components(const config::Node& node) {
  if (!node.has("components")) return {0, 1, 2};
  std::vector<int> axes;
  for (const double axis :
       node.numbers({"components", "", "axes of O that count: 0, 1, 2 for x, y, z; absent: all"},
                    -1, {0, 2})) {
    axes.push_back(static_cast<int>(axis));
  }
  return axes;
}

std::optional<Eigen::Vector3d> axis(const config::Node& node) {
  if (!node.has("axis")) return {};
  return node.vector3(
      {"axis", "", "about which the angle or curvature is signed, in O; absent: it is not signed"});
}

/// The listed points, or a sample of the whole surface.
std::vector<Eigen::Vector3d> set_of_points(const config::Node& node,
                                           const mesh::ElementMesh& mesh) {
  if (!node.has("surface"))
    return node.points({"rest_points", "m", "of the rest shape, in O: 1 to 512"});
  if (node.has("rest_points")) node.fail("rest_points", "has no meaning beside \"surface\"");
  return shape::surface_points(
      mesh,
      node.integer({"surface", "",
                    "this many points spread over the whole surface, in place of rest_points"},
                   {1, shape::PointsFeature::kMostPoints}));
}

}  // namespace

std::unique_ptr<shape::Feature> make_feature(const config::Node& node, const Context& context) {
  const auto& plugins = plugins_of(context).features;
  const std::string name = node.choice({"component", "", "kind of the feature"},
                                       plugin::with_plugins(plugin::kFeatures, plugins));
  if (const auto* entry = plugin::find_plugin(plugins, name))
    return make_plugin(*entry, node, context);
  const mesh::ElementMesh& mesh = context.object->body.mesh;
  try {
    if (name == "point") {
      return std::make_unique<shape::PointFeature>(
          mesh, shape::PointFeature::Options{rest_points(node, 1)[0], components(node)});
    }
    if (name == "points") {
      return std::make_unique<shape::PointsFeature>(
          mesh, shape::PointsFeature::Options{set_of_points(node, mesh)});
    }
    if (name == "distance") {
      return std::make_unique<shape::DistanceFeature>(
          mesh,
          shape::DistanceFeature::Options{node.points(
              {"rest_points", "m", "of the rest shape, in O: the two whose distance it is"})});
    }
    if (name == "angle") {
      return std::make_unique<shape::AngleFeature>(
          mesh,
          shape::AngleFeature::Options{
              node.points(
                  {"rest_points", "m",
                   "of the rest shape, in O: 3, the corner amid them, or 4 for two directions"}),
              axis(node)});
    }
    if (name == "curvature") {
      return std::make_unique<shape::CurvatureFeature>(
          mesh,
          shape::CurvatureFeature::Options{
              node.points({"rest_points", "m", "of the rest shape, in O: 3 or 5 along the line"}),
              axis(node)});
    }
    if (name == "fourier_contour") {
      shape::FourierContourFeature::Options options;
      options.rest_points =
          node.points({"rest_points", "m", "of the rest shape, in O: up to 64 along the contour"});
      options.harmonics =
          node.integer({"harmonics", "", "of the contour, each four numbers a plane"}, {1, 31},
                       options.harmonics);
      options.closed = node.flag({"closed", "", "whether the contour is closed"}, options.closed);
      options.components = components(node);
      return std::make_unique<shape::FourierContourFeature>(mesh, options);
    }
    shape::PoseFeature::Options options;
    const std::vector<Eigen::Vector3d> points = rest_points(node, 3);
    std::copy(points.begin(), points.end(), options.rest_points.begin());
    return std::make_unique<shape::PoseFeature>(mesh, options);
  } catch (const std::invalid_argument& error) {
    node.fail("", error.what());
  }
}

}  // namespace palpate::registry

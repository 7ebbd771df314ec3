#include "core/shape/point_feature.hpp"
#include "core/shape/points_feature.hpp"
#include "core/shape/pose_feature.hpp"
#include "rt/component/registry.hpp"

namespace palpate::component {
namespace {

std::vector<Eigen::Vector3d> rest_points(const config::Node& node, std::size_t count) {
  const std::vector<Eigen::Vector3d> points = node.points("rest_points");
  if (points.size() != count) {
    node.fail("rest_points", "has " + std::to_string(points.size()) +
                                 " points; allowed: " + std::to_string(count));
  }
  return points;
}

}  // namespace

std::unique_ptr<shape::Feature> make_feature(const config::Node& node, const Context& context) {
  const std::string name = node.choice("component", {"point", "points", "pose"});
  const mesh::ElementMesh& mesh = context.object->body.mesh;
  try {
    if (name == "point") {
      shape::PointFeature::Options options;
      options.rest_point = rest_points(node, 1)[0];
      if (node.has("components")) {
        options.components.clear();
        for (const double axis : node.numbers("components", -1, {0, 2})) {
          options.components.push_back(static_cast<int>(axis));
        }
      }
      return std::make_unique<shape::PointFeature>(mesh, options);
    }
    if (name == "points") {
      return std::make_unique<shape::PointsFeature>(
          mesh, shape::PointsFeature::Options{node.points("rest_points")});
    }
    shape::PoseFeature::Options options;
    const std::vector<Eigen::Vector3d> points = rest_points(node, 3);
    std::copy(points.begin(), points.end(), options.rest_points.begin());
    return std::make_unique<shape::PoseFeature>(mesh, options);
  } catch (const std::invalid_argument& error) {
    node.fail("", error.what());
  }
}

}  // namespace palpate::component

#include "rt/registry/obstacles.hpp"

#include <algorithm>

#include "rt/config/mesh_file.hpp"

namespace palpate::registry {
namespace {

constexpr config::Range kSize{1e-4, 100};  // m

double read_radius(const config::Node& node) {
  return node.number({"radius", "m", "Radius of a sphere, cylinder or capsule"}, kSize);
}

/// The signed distance of a surface file.
std::shared_ptr<const collision::DistanceGrid> read_grid(const config::Node& node) {
  const std::string file =
      node.path({"file", "", "Closed surface of a mesh, .stl or .obj, in m and oriented outward"});
  const double cell = node.number(
      {"cell", "m", "Side of a cell of the grid of distances; edges are rounded by about as much"},
      {1e-5, 1}, 2e-3);
  try {
    return std::make_shared<const collision::DistanceGrid>(config::load_surface(file), cell);
  } catch (const std::invalid_argument& error) {
    node.fail("file", error.what());
  }
}

collision::Shape read_shape(const config::Node& node) {
  const std::string shape = node.choice(
      {"shape", "",
       "Shape in its own frame: half_space below z = 0; box, sphere about the origin; cylinder, "
       "capsule about the axis z, with the origin in the middle; mesh"},
      {"half_space", "box", "sphere", "cylinder", "capsule", "mesh"});
  if (shape == "box")
    return collision::Box{0.5 * node.vector3({"size", "m", "Edge lengths of a box"}, kSize)};
  if (shape == "sphere") return collision::Sphere{read_radius(node)};
  if (shape == "cylinder") {
    collision::Cylinder cylinder{read_radius(node)};
    if (node.has("length"))
      cylinder.length = node.number(
          {"length", "m", "Length of a cylinder (absent: infinite) or of a capsule's segment"},
          kSize);
    return cylinder;
  }
  if (shape == "capsule")
    return collision::Capsule{
        read_radius(node),
        node.number(
            {"length", "m", "Length of a cylinder (absent: infinite) or of a capsule's segment"},
            kSize)};
  if (shape == "mesh") return read_grid(node);
  return collision::HalfSpace{};
}

}  // namespace

std::vector<collision::Obstacle> read_obstacles(const config::Node& root, const math::Pose& X_WO) {
  std::vector<collision::Obstacle> obstacles;
  for (const config::Node& node :
       root.list({"obstacles", "", "Rigid bodies at rest that the object may touch"})) {
    collision::Obstacle obstacle;
    obstacle.name = node.text({"name", "", "Name of the obstacle, unlike any other"});
    const auto has_same_name = [&](const auto& other) { return other.name == obstacle.name; };
    if (std::any_of(obstacles.begin(), obstacles.end(), has_same_name))
      node.fail("name", "is that of another obstacle; allowed: any other name");
    obstacle.shape = read_shape(node);
    obstacle.X_OB = X_WO.inverse() * node.pose({"pose", "m", "Pose of the shape's frame in W"});
    obstacle.friction = node.number(
        {"friction", "", "Coulomb friction coefficient between the obstacle and the object"},
        {0, 10}, obstacle.friction);
    obstacles.push_back(std::move(obstacle));
  }
  return obstacles;
}

}  // namespace palpate::registry

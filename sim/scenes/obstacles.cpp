#include "sim/scenes/obstacles.hpp"

namespace palpate::scenes {
namespace {

constexpr config::Range kPlace{-100, 100};  // m

Eigen::Vector3d read_direction(const config::Node& node, const config::Key& key) {
  const Eigen::Vector3d direction = node.vector3(key, {-1e3, 1e3});
  if (!(direction.norm() >= 1e-6)) node.fail(key.name, "is zero; allowed: any other vector");
  return direction;
}

object::HalfSpace read_plane(const config::Node& node) {
  return {node.vector3({"point", "m", "of the plane, in O"}, kPlace),
          read_direction(node, {"normal", "", "out of the obstacle, in O, of any length"})};
}

object::Cylinder read_cylinder(const config::Node& node) {
  object::Cylinder cylinder;
  cylinder.point = node.vector3({"point", "m", "middle of its axis, in O"}, kPlace);
  cylinder.axis = read_direction(node, {"axis", "", "in O, of any length"});
  cylinder.radius = node.number({"radius", "m", "of the cylinder"}, {1e-3, 100});
  if (node.has("length"))
    cylinder.length = node.number({"length", "m", "of its axis; absent: infinite"}, {1e-3, 100});
  return cylinder;
}

}  // namespace

std::vector<object::ObstacleOptions> read_obstacles(const config::Node& scene) {
  std::vector<object::ObstacleOptions> obstacles;
  for (const config::Node& item :
       scene.list({"obstacles", "", "rigid bodies at rest that the object may touch"})) {
    object::ObstacleOptions obstacle;
    if (item.has("plane") == item.has("cylinder"))
      item.fail("", "needs one shape; allowed: plane or cylinder");
    if (item.has("plane"))
      obstacle.shape = read_plane(item.child({"plane", "", "half space: a table or a wall"}));
    else
      obstacle.shape = read_cylinder(item.child({"cylinder", "", "solid cylinder"}));
    obstacle.friction = item.number({"friction", "", "of Coulomb, between it and the object"},
                                    {0, 10}, obstacle.friction);
    if (item.has("stiffness"))
      obstacle.stiffness = item.number(
          {"stiffness", "N/m^3", "pressure by penetration; absent: 2000 E / m"}, {1e3, 1e12});
    obstacle.damping =
        item.number({"damping", "s/m",
                     "growth of the pressure with the speed of approach, of Hunt and Crossley"},
                    {0, 100}, obstacle.damping);
    obstacles.push_back(obstacle);
  }
  return obstacles;
}

}  // namespace palpate::scenes

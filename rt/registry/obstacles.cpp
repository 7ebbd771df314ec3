#include "rt/registry/obstacles.hpp"

#include <algorithm>

#include "core/math/constants.hpp"
#include "rt/config/mesh_file.hpp"
#include "rt/registry/arm_model.hpp"

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

/// Joints of the arm, whose positions ROBOT_STATE reports, in its order.
kinematics::SerialChain read_arm(const config::Node& obstacle, const config::Node& root) {
  if (!root.has("robot"))
    obstacle.fail("link", "needs the arm's joints: section robot with key urdf");
  const config::Node robot = root.child("robot");
  try {
    return read_urdf(robot.path("urdf"), robot.text("flange", "flange"));
  } catch (const std::invalid_argument& error) {
    robot.fail("urdf", error.what());
  }
}

/// The chain from W to the link. Beyond the flange no joint is reported, so that the hand carries
/// such a link rigidly: `is_of_hand`.
kinematics::SerialChain read_link(const config::Node& obstacle, const config::Node& root,
                                  bool& is_of_hand) {
  const kinematics::SerialChain arm = read_arm(obstacle, root);
  const std::string name =
      obstacle.text({"link", "",
                     "Link of the URDF (robot.urdf) that carries the obstacle, of the arm or "
                     "rigid with its flange; absent: it is fixed in W or moved by messages"});
  try {
    kinematics::SerialChain link = read_urdf(root.child("robot").path("urdf"), name);
    for (int i = 0; i < link.joint_count(); ++i) {
      if (i >= arm.joint_count() || link.joint(i).name != arm.joint(i).name)
        obstacle.fail("link", name + ": its position depends on joint " + link.joint(i).name +
                                  ", which is not one of the arm's joints up to the flange");
    }
    is_of_hand = link.joint_count() == arm.joint_count();
    return link;
  } catch (const std::invalid_argument& error) {
    obstacle.fail("link", error.what());
  }
}

ObstacleCarrier read_carrier(const config::Node& node, const config::Node& root,
                             const math::Pose& X_WO, collision::Obstacle& body) {
  using Kind = ObstacleCarrier::Kind;
  ObstacleCarrier carrier;
  const bool is_moved =
      node.flag({"moved", "", "Whether messages on WORLD_STATE move the obstacle"}, false);
  if (is_moved && node.has("link"))
    node.fail("moved", "an obstacle is carried by a link or moved by messages, not both");
  carrier.X_AB = node.pose({"pose", "m",
                            "Pose of the shape's frame in W, or in the link; of one that messages "
                            "move: until the first of them, absent: it is not there yet"});
  if (node.has("link")) {
    carrier.kind = Kind::kLink;
    bool is_of_hand = false;
    carrier.link = read_link(node, root, is_of_hand);
    if (is_of_hand) body.hand = 0;
    body.is_known = false;
    return carrier;
  }
  if (is_moved) {
    carrier.kind = Kind::kMessages;
    carrier.timeout =
        1e-3 * node.number({"timeout_ms", "ms",
                            "Time without a message on WORLD_STATE for a moved obstacle after "
                            "which it counts as at rest and the daemon as degraded"},
                           {1, 1e5}, 1e3 * carrier.timeout);
    body.is_known = node.has("pose");
  }
  body.X_OB = X_WO.inverse() * carrier.X_AB;
  return carrier;
}

math::Vector6d read_pose_deviation(const config::Node& node) {
  math::Vector6d deviation = math::Vector6d::Zero();
  if (!node.has("pose_deviation")) return deviation;
  const config::Node part = node.child({"pose_deviation", "",
                                        "What pose_wrench_filter may correct in the pose of the "
                                        "obstacle, by the wrenches and the observed shape: prior "
                                        "standard deviations in its own frame, in at most 6 "
                                        "directions of all obstacles; 0: known exactly"});
  if (part.has("position"))
    deviation.head<3>() =
        part.vector3({"position", "m", "Along x, y and z of the obstacle's frame"}, {0, 0.1});
  if (part.has("rotation_deg"))
    deviation.tail<3>() =
        part.vector3({"rotation_deg", "degrees", "About x, y and z of that frame"}, {0, 30}) *
        math::kDegree;
  return deviation;
}

void read_limits(const config::Node& node, control::LimitedObstacle& limited) {
  limited.may_touch =
      node.choice({"allowed", "",
                   "Whether the law quadratic_program may let the object touch the obstacle; "
                   "otherwise it keeps the clearance"},
                  {"none", "contact"}, "none") == "contact";
  if (limited.may_touch && node.has("clearance"))
    node.fail("clearance", "is not kept where contact is allowed");
  if (!limited.may_touch)
    limited.clearance = node.number(
        {"clearance", "m", "Distance from the object that the law quadratic_program keeps"}, {0, 1},
        limited.clearance);
  if (node.has("force"))
    limited.force = node.number({"force", "N",
                                 "Largest sum of the normal forces that the law quadratic_program "
                                 "lets the object exert on the obstacle; absent: no limit"},
                                {1e-3, 1e4});
}

}  // namespace

std::vector<ConfiguredObstacle> read_obstacles(const config::Node& root, const math::Pose& X_WO) {
  std::vector<ConfiguredObstacle> obstacles;
  for (const config::Node& node :
       root.list({"obstacles", "", "Rigid bodies that the object may meet, at most 8"})) {
    if (obstacles.size() == collision::kMostObstacles)
      root.fail("obstacles", "has more than 8 entries; allowed: at most 8");
    ConfiguredObstacle& obstacle = obstacles.emplace_back();
    collision::Obstacle& body = obstacle.limited.body;
    body.name = node.text({"name", "", "Name of the obstacle, unlike any other"});
    if (body.name.empty() || body.name.size() > kLongestObstacleName)
      node.fail("name", "must have 1 to 23 characters");
    const auto has_same_name = [&](const auto& other) {
      return &other != &obstacle && other.limited.body.name == body.name;
    };
    if (std::any_of(obstacles.begin(), obstacles.end(), has_same_name))
      node.fail("name", "is that of another obstacle; allowed: any other name");
    body.shape = read_shape(node);
    obstacle.carrier = read_carrier(node, root, X_WO, body);
    body.friction = node.number(
        {"friction", "", "Coulomb friction coefficient between the obstacle and the object"},
        {0, 10}, body.friction);
    body.pose_deviation = read_pose_deviation(node);
    read_limits(node, obstacle.limited);
  }
  try {
    free_directions(obstacles);
  } catch (const std::invalid_argument& error) {
    root.fail("obstacles", error.what());
  }
  return obstacles;
}

std::vector<collision::FreeDirection> free_directions(
    const std::vector<ConfiguredObstacle>& obstacles) {
  std::vector<collision::Obstacle> bodies;
  for (const ConfiguredObstacle& obstacle : obstacles) bodies.push_back(obstacle.limited.body);
  return collision::free_directions(bodies);
}

}  // namespace palpate::registry

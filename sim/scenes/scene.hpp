#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "rt/config/node.hpp"
#include "sim/camera/shape_camera.hpp"
#include "sim/object/hyperelastic_plant.hpp"
#include "sim/robot/dart_soft_body.hpp"
#include "sim/scenes/arm.hpp"
#include "sim/scenes/pokes.hpp"

namespace palpate::scenes {

/// LCM URLs of the three buses.
struct BusUrls {
  std::string control = "udpm://239.255.76.67:7667?ttl=0";
  std::string housekeeping = "udpm://239.255.76.68:7668?ttl=0";
  std::string pictures = "udpm://239.255.76.69:7669?ttl=0";
};

/// Something stands before the camera for a while, s.
struct Occlusion {
  double at = 0;
  double duration = 0;
};

/// A knife goes through the object.
struct Cut {
  double at = 0;    // s
  object::Box box;  // at rest, in O
};

/// Markers on the object that a tracker sees and tells apart.
struct MarkerOptions {
  std::vector<Eigen::Vector3d> rest_points;  // in O, m; 1 to 256
  sensors::Timing timing;
  double noise = 0;  // m, standard deviation of each coordinate
  std::vector<Occlusion> occlusions;
};

/// A scene file as a struct: the first arm, and what else there is.
struct Scene : ArmScene {
  std::uint64_t seed = 1;
  BusUrls bus;

  std::optional<robot::SoftBoxOptions> soft_box;  // none: the object is hyperelastic
  object::PlantOptions plant;  // but for the hands' poses at rest and gravity: the arms decide
  bool object_gravity = true;
  std::vector<Poke> pokes;

  std::optional<ArmScene> second_arm;
  std::optional<camera::ShapeCameraOptions> camera;  // none: no SHAPE_OBSERVATION
  std::vector<Occlusion> occlusions;                 // in their order
  std::vector<Cut> cuts;                             // in their order
  std::optional<MarkerOptions> markers;              // in place of a camera
};

/// Throws config::Error, also for keys that nobody knows.
Scene read_scene(const config::Node& node);

}  // namespace palpate::scenes

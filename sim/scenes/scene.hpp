#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "rt/bus/message_bus.hpp"
#include "rt/config/node.hpp"
#include "sim/camera/shape_camera.hpp"
#include "sim/object/hyperelastic_plant.hpp"
#include "sim/robot/dart_soft_body.hpp"
#include "sim/scenes/arm.hpp"
#include "sim/scenes/pokes.hpp"
#include "sim/scenes/slips.hpp"

namespace palpate::scenes {

/// LCM URLs of the buses.
struct BusUrls {
  std::string control = "udpm://239.255.76.67:7667?ttl=0";
  std::string housekeeping = "udpm://239.255.76.68:7668?ttl=0";
  std::string pictures = "udpm://239.255.76.69:7669?ttl=0";
  std::string clouds = "udpm://239.255.76.70:7670?ttl=0";  // large messages, apart from the others
  bus::ChannelNames channels;                              // on control and housekeeping URL
};

/// Occlusion of the camera for a while, s.
struct Occlusion {
  double at = 0;
  double duration = 0;
};

/// A cut through the object by a knife.
struct Cut {
  double at = 0;    // s
  object::Box box;  // at rest, in O
};

/// Markers on the object, which a tracker observes and identifies.
struct MarkerOptions {
  std::vector<Eigen::Vector3d> rest_points;  // in O, m; 1 to 256
  sensors::Timing timing;
  double noise = 0;  // m, standard deviation of each coordinate
  std::vector<Occlusion> occlusions;
};

/// A scene file as a struct: the first arm and all optional parts.
struct Scene : ArmScene {
  std::uint64_t seed = 1;
  BusUrls bus;

  std::optional<robot::SoftBoxOptions> soft_box;  // none: the object is hyperelastic
  object::PlantOptions plant;  // except the hands' rest poses and gravity, which the arms determine
  bool object_gravity = true;
  std::vector<Poke> pokes;
  std::vector<Slip> slips;

  std::optional<ArmScene> second_arm;
  std::optional<camera::ShapeCameraOptions> camera;  // empty: neither clouds nor observations
  std::string cloud_channel = "POINT_CLOUD";
  std::vector<Occlusion> occlusions;     // in chronological order
  std::vector<Cut> cuts;                 // in chronological order
  std::optional<MarkerOptions> markers;  // instead of a camera
};

/// Throws config::Error, also for unknown keys.
Scene read_scene(const config::Node& node);

}  // namespace palpate::scenes

#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "rt/config/node.hpp"
#include "sim/camera/shape_camera.hpp"
#include "sim/object/hyperelastic_plant.hpp"
#include "sim/robot/robot.hpp"
#include "sim/scenes/fingertips.hpp"
#include "sim/scenes/hand_control.hpp"
#include "sim/scenes/motion_plan.hpp"
#include "sim/scenes/pokes.hpp"
#include "sim/sensors/sensor_table.hpp"

namespace palpate::scenes {

/// LCM URLs of the three buses.
struct BusUrls {
  std::string control = "udpm://239.255.76.67:7667?ttl=0";
  std::string housekeeping = "udpm://239.255.76.68:7668?ttl=0";
  std::string pictures = "udpm://239.255.76.69:7669?ttl=0";
};

/// A scene file as a struct.
struct Scene {
  std::uint64_t seed = 1;
  BusUrls bus;

  object::PlantOptions plant;  // but for the hand's pose at rest and gravity, which the arm decides
  math::Pose X_WO = math::Pose::Identity();
  bool object_gravity = true;
  std::vector<Poke> pokes;

  std::string urdf;
  robot::RobotOptions robot;
  Eigen::VectorXd initial_joints;              // rad
  std::map<std::string, double> initial_hand;  // rad, by joint; the others are at zero
  math::Pose X_EG = math::Pose::Identity();

  std::vector<Fingertip> fingertips;  // that touch the object; none: the fingers are air
  std::vector<HandAction> hand;       // beside what HAND_COMMAND says

  sensors::SensorTable sensors;
  std::optional<camera::ShapeCameraOptions> camera;  // none: no SHAPE_OBSERVATION
  std::optional<MotionPlan> motion;                  // none: the arm obeys the daemon
};

/// Throws config::Error, also for keys that nobody knows.
Scene read_scene(const config::Node& node);

}  // namespace palpate::scenes

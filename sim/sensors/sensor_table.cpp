#include "sim/sensors/sensor_table.hpp"

#include <algorithm>
#include <cmath>

#include "core/math/constants.hpp"
#include "sensors_yaml.hpp"

namespace palpate::sensors {
namespace {

constexpr config::Range kNotNegative{0, 1e6};

void read(const config::Node& node, Timing& timing) {
  timing.rate = node.number({"rate", "Hz", "of messages"}, {0.1, 1000}, timing.rate);
  timing.delay = node.number({"delay", "s", "from measurement to message"}, {0, 1}, timing.delay);
  timing.jitter =
      node.number({"jitter", "s", "scale of a half-normal delay on top"}, {0, 1}, timing.jitter);
  timing.drop_out =
      node.number({"drop_out", "", "share of messages that are lost"}, {0, 1}, timing.drop_out);
  timing.stamp_delay = node.number({"stamp_delay", "s", "from measurement to the message's stamp"},
                                   {-1, 1}, timing.stamp_delay);
}

void read(const config::Node& node, const char* key, Faults& faults) {
  const config::Node signal = node.child_or_empty({key, "", "errors of this signal"});
  faults.step =
      signal.number({"step", "of the signal", "of its resolution"}, kNotNegative, faults.step);
  faults.noise =
      signal.number({"noise", "of the signal", "standard deviation"}, kNotNegative, faults.noise);
  faults.drift =
      signal.number({"drift", "of the signal", "standard deviation of a random walk after 1 s"},
                    kNotNegative, faults.drift);
  faults.hysteresis =
      signal.number({"hysteresis", "of the signal",
                     "half the way that the true value must turn back before the reading follows"},
                    kNotNegative, faults.hysteresis);
}

void read(const config::Node& node, const char* key, math::Vector6d& vector) {
  if (!node.has(key)) return;
  const std::vector<double> values =
      node.numbers({key, "N, N m; m/s^2, rad/s", "added; of warm_up: in the end"}, 6);
  std::copy(values.begin(), values.end(), vector.data());
}

void read(const config::Node& node, GearFriction& friction) {
  constexpr int kAny = -1;
  friction.coulomb = node.numbers({"coulomb", "N m", "Coulomb friction, one value per joint"}, kAny,
                                  kNotNegative, friction.coulomb);
  friction.viscous = node.numbers({"viscous", "N m s/rad", "viscous friction, one value per joint"},
                                  kAny, kNotNegative, friction.viscous);
  friction.presliding =
      node.number({"presliding", "rad", "decay of its difference after a joint has turned back"},
                  {1e-7, 0.1}, friction.presliding);
}

void read_mounting(const config::Node& node, Eigen::Matrix3d& mounting) {
  mounting = math::exp_rotation(
      math::kDegree *
      node.vector3({"mounting_rotation_deg", "degrees",
                    "rotation vector of the sensor as mounted, in its link of the URDF"},
                   {-180, 180}, Eigen::Vector3d::Zero()));
}

void read(const config::Node& node, ForceTorqueDisturbance& disturbance) {
  const config::Node cable = node.child_or_empty({"cable", "", "of the sensor, which pulls"});
  disturbance.cable_stiffness =
      cable.number({"stiffness", "N/m", "of the cable"}, kNotNegative, disturbance.cable_stiffness);
  disturbance.cable_torsion =
      cable.number({"torsion", "N m/rad", "of the cable"}, kNotNegative, disturbance.cable_torsion);
  const config::Node warm_up = node.child_or_empty({"warm_up", "", "bias that settles"});
  disturbance.warm_up_time =
      warm_up.number({"time", "s", "time constant"}, {1, 1e5}, disturbance.warm_up_time);
  read(warm_up, "wrench", disturbance.warm_up);
}

void read(const config::Node& node, SkinTable& skin) {
  skin.foundation = node.number({"foundation", "N/m^3", "pressure that a depth takes"}, {1e5, 1e10},
                                skin.foundation);
  skin.spread =
      node.number({"spread", "m", "how far a point load is carried"}, {1e-4, 1e-2}, skin.spread);
  skin.shear_stiffness = node.number({"shear_stiffness", "N/m", "of the skin along itself"},
                                     {10, 1e6}, skin.shear_stiffness);
  skin.shear_reach =
      node.number({"shear_reach", "m", "about a touch, that the skin shifts with it"}, {1e-3, 1},
                  skin.shear_reach);
  skin.bulge = node.number({"bulge", "", "part of the displaced fluid that lifts the pad"}, {0, 1},
                           skin.bulge);
  skin.friction = node.number({"friction", "m", "how far a dent stays behind what presses"},
                              {0, 1e-3}, skin.friction);
  skin.fast_share =
      node.number({"fast_share", "", "of a dent that comes late, soon"}, {0, 1}, skin.fast_share);
  skin.fast_time = node.number({"fast_time", "s", "in which"}, {1e-3, 1e4}, skin.fast_time);
  skin.slow_share =
      node.number({"slow_share", "", "of a dent that comes much later"}, {0, 1}, skin.slow_share);
  skin.slow_time = node.number({"slow_time", "s", "in which"}, {1e-3, 1e4}, skin.slow_time);
  if (skin.fast_share + skin.slow_share > 1)
    node.fail("slow_share", "and fast_share must not exceed 1 together");
}

void read(const config::Node& node, BiotacTable& table) {
  constexpr config::Range kCounts{-4095, 4095};
  read(node, table.timing);
  table.polarity = node.number({"polarity", "", "1: counts rise under pressure, -1: they fall"},
                               {-1, 1}, table.polarity);
  if (std::abs(table.polarity) != 1) node.fail("polarity", "wants 1 or -1");
  read(node.child_or_empty({"skin", "", "of the fingertip"}), table.skin);
  table.pressure_area =
      node.number({"pressure_area", "m^2", "pressing force over the pressure of the fluid"},
                  {1e-5, 1e-2}, table.pressure_area);
  read(node, "electrode", table.electrode);
  read(node, "pressure", table.pressure);
  read(node, "vibration", table.vibration);
  read(node, "temperature", table.temperature);
  const config::Node warm_up = node.child_or_empty({"warm_up", "", "bias that settles"});
  table.warm_up = warm_up.number({"time", "s", "time constant"}, {1, 1e5}, table.warm_up);
  table.warm_up_electrode =
      warm_up.number({"electrode", "counts", "that it comes to"}, kCounts, table.warm_up_electrode);
  table.warm_up_pressure =
      warm_up.number({"pressure", "counts", "that it comes to"}, kCounts, table.warm_up_pressure);
  table.warm_up_temperature = warm_up.number({"temperature", "counts", "that it comes to"}, kCounts,
                                             table.warm_up_temperature);
}

void read(const config::Node& node, camera::DepthNoiseOptions& noise) {
  using math::kDegree;
  noise.scale = node.number({"noise", "", "scale of the noise of the depth, 1 as measured"},
                            {0, 100}, noise.scale);
  noise.disparity_step = node.number({"disparity_step", "pixels", "resolution of the disparity"},
                                     {0, 10}, noise.disparity_step);
  noise.edge_loss =
      node.number({"edge_loss", "", "share of pixels lost at edges"}, {0, 1}, noise.edge_loss);
  noise.most_angle =
      kDegree * node.number({"most_angle_deg", "degrees",
                             "between surface and viewing ray, beyond which nothing is seen"},
                            {1, 89}, noise.most_angle / kDegree);
  noise.nearest = node.number({"nearest", "m", "that is seen"}, {0, 10}, noise.nearest);
  noise.farthest =
      node.number({"farthest", "m", "that is seen"}, {noise.nearest + 0.01, 20}, noise.farthest);
}

void read(const config::Node& node, SensorTable& table) {
  const config::Node ft = node.child_or_empty({"force_torque", "", "FT_WRENCH"});
  read(ft, table.force_torque.timing);
  read(ft, "force", table.force_torque.force);
  read(ft, "torque", table.force_torque.torque);
  read(ft, "bias", table.force_torque.bias);
  read_mounting(ft, table.force_torque.mounting);
  read(ft, table.force_torque.disturbance);
  const config::Node imu = node.child_or_empty({"imu", "", "IMU"});
  read(imu, table.imu.timing);
  read(imu, "acceleration", table.imu.acceleration);
  read(imu, "angular_velocity", table.imu.angular_velocity);
  read(imu, "bias", table.imu.bias);
  read_mounting(imu, table.imu.mounting);
  const config::Node robot = node.child_or_empty({"robot_state", "", "ROBOT_STATE"});
  read(robot, table.robot_state.timing);
  read(robot, "position", table.robot_state.position);
  read(robot, "velocity", table.robot_state.velocity);
  read(robot, "torque", table.robot_state.torque);
  read(robot.child_or_empty({"friction", "", "of the gears, in the joint torques"}),
       table.robot_state.friction);
  const config::Node hand = node.child_or_empty({"hand_state", "", "HAND_STATE"});
  read(hand, table.hand_state.timing);
  read(hand, "fingertip", table.hand_state.fingertip);
  read(node.child_or_empty({"biotac", "", "BIOTAC_n"}), table.biotac);
  const config::Node fingertip = node.child_or_empty({"fingertip", "", "FINGERTIP_n"});
  read(fingertip, table.fingertip.timing);
  read(fingertip, "place", table.fingertip.place);
  read(fingertip, "force", table.fingertip.force);
  const config::Node camera = node.child_or_empty({"camera", "", "SHAPE_OBSERVATION"});
  read(camera, table.camera.timing);
  read(camera.child_or_empty({"depth", "", "of the depth image"}), table.camera.noise);
  if (camera.has("calibration_error"))
    table.camera.calibration_error = camera.pose(
        {"calibration_error", "m", "of the pose of the camera that the receiver believes"});
  table.kinematics_error =
      node.pose({"kinematics_error", "m", "of the pose of the flange that ROBOT_STATE reports"});
}

}  // namespace

SensorTable read_sensors(const config::Node& scene) {
  SensorTable table;
  const config::Node normative = config::Node::from_text(kSensorsYaml, "sensors.yaml");
  read(normative, table);
  normative.check_all_used();
  read(scene, table);
  return table;
}

}  // namespace palpate::sensors

#include "sim/sensors/sensor_table.hpp"

#include <algorithm>
#include <cmath>

#include "sensors_yaml.hpp"

namespace palpate::sensors {
namespace {

constexpr config::Range kNotNegative{0, 1e6};

void read(const config::Node& node, Timing& timing) {
  timing.rate = node.number("rate", {0.1, 1000}, timing.rate);
  timing.delay = node.number("delay", {0, 1}, timing.delay);
  timing.jitter = node.number("jitter", {0, 1}, timing.jitter);
  timing.drop_out = node.number("drop_out", {0, 1}, timing.drop_out);
}

void read(const config::Node& node, const char* key, Faults& faults) {
  const config::Node signal = node.child_or_empty(key);
  faults.step = signal.number("step", kNotNegative, faults.step);
  faults.noise = signal.number("noise", kNotNegative, faults.noise);
  faults.drift = signal.number("drift", kNotNegative, faults.drift);
  faults.hysteresis = signal.number("hysteresis", kNotNegative, faults.hysteresis);
}

void read(const config::Node& node, const char* key, math::Vector6d& vector) {
  if (!node.has(key)) return;
  const std::vector<double> values = node.numbers(key, 6);
  std::copy(values.begin(), values.end(), vector.data());
}

void read(const config::Node& node, ForceTorqueDisturbance& disturbance) {
  const config::Node cable = node.child_or_empty("cable");
  disturbance.cable_stiffness =
      cable.number("stiffness", kNotNegative, disturbance.cable_stiffness);
  disturbance.cable_torsion = cable.number("torsion", kNotNegative, disturbance.cable_torsion);
  const config::Node warm_up = node.child_or_empty("warm_up");
  disturbance.warm_up_time = warm_up.number("time", {1, 1e5}, disturbance.warm_up_time);
  read(warm_up, "wrench", disturbance.warm_up);
}

void read(const config::Node& node, SkinTable& skin) {
  skin.foundation = node.number("foundation", {1e5, 1e10}, skin.foundation);
  skin.spread = node.number("spread", {1e-4, 1e-2}, skin.spread);
  skin.shear_stiffness = node.number("shear_stiffness", {10, 1e6}, skin.shear_stiffness);
  skin.shear_reach = node.number("shear_reach", {1e-3, 1}, skin.shear_reach);
  skin.bulge = node.number("bulge", {0, 1}, skin.bulge);
  skin.friction = node.number("friction", {0, 1e-3}, skin.friction);
  skin.fast_share = node.number("fast_share", {0, 1}, skin.fast_share);
  skin.fast_time = node.number("fast_time", {1e-3, 1e4}, skin.fast_time);
  skin.slow_share = node.number("slow_share", {0, 1}, skin.slow_share);
  skin.slow_time = node.number("slow_time", {1e-3, 1e4}, skin.slow_time);
  if (skin.fast_share + skin.slow_share > 1)
    node.fail("slow_share", "and fast_share must not exceed 1 together");
}

void read(const config::Node& node, BiotacTable& table) {
  constexpr config::Range kCounts{-4095, 4095};
  read(node, table.timing);
  table.polarity = node.number("polarity", {-1, 1}, table.polarity);
  if (std::abs(table.polarity) != 1) node.fail("polarity", "wants 1 or -1");
  read(node.child_or_empty("skin"), table.skin);
  table.pressure_area = node.number("pressure_area", {1e-5, 1e-2}, table.pressure_area);
  read(node, "electrode", table.electrode);
  read(node, "pressure", table.pressure);
  read(node, "vibration", table.vibration);
  read(node, "temperature", table.temperature);
  const config::Node warm_up = node.child_or_empty("warm_up");
  table.warm_up = warm_up.number("time", {1, 1e5}, table.warm_up);
  table.warm_up_electrode = warm_up.number("electrode", kCounts, table.warm_up_electrode);
  table.warm_up_pressure = warm_up.number("pressure", kCounts, table.warm_up_pressure);
  table.warm_up_temperature = warm_up.number("temperature", kCounts, table.warm_up_temperature);
}

void read(const config::Node& node, camera::DepthNoiseOptions& noise) {
  constexpr double kDegree = 3.14159265358979323846 / 180;
  noise.scale = node.number("noise", {0, 100}, noise.scale);
  noise.disparity_step = node.number("disparity_step", {0, 10}, noise.disparity_step);
  noise.edge_loss = node.number("edge_loss", {0, 1}, noise.edge_loss);
  noise.most_angle = kDegree * node.number("most_angle_deg", {1, 89}, noise.most_angle / kDegree);
  noise.nearest = node.number("nearest", {0, 10}, noise.nearest);
  noise.farthest = node.number("farthest", {noise.nearest + 0.01, 20}, noise.farthest);
}

void read(const config::Node& node, SensorTable& table) {
  const config::Node ft = node.child_or_empty("force_torque");
  read(ft, table.force_torque.timing);
  read(ft, "force", table.force_torque.force);
  read(ft, "torque", table.force_torque.torque);
  read(ft, "bias", table.force_torque.bias);
  read(ft, table.force_torque.disturbance);
  const config::Node imu = node.child_or_empty("imu");
  read(imu, table.imu.timing);
  read(imu, "acceleration", table.imu.acceleration);
  read(imu, "angular_velocity", table.imu.angular_velocity);
  read(imu, "bias", table.imu.bias);
  const config::Node robot = node.child_or_empty("robot_state");
  read(robot, table.robot_state.timing);
  read(robot, "position", table.robot_state.position);
  read(robot, "velocity", table.robot_state.velocity);
  read(robot, "torque", table.robot_state.torque);
  const config::Node hand = node.child_or_empty("hand_state");
  read(hand, table.hand_state.timing);
  read(hand, "fingertip", table.hand_state.fingertip);
  read(node.child_or_empty("biotac"), table.biotac);
  const config::Node camera = node.child_or_empty("camera");
  read(camera, table.camera.timing);
  read(camera.child_or_empty("depth"), table.camera.noise);
  if (camera.has("calibration_error"))
    table.camera.calibration_error = camera.pose("calibration_error");
  table.kinematics_error = node.pose("kinematics_error");
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

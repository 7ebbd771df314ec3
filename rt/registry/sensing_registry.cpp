#include "core/sensing/biotac_linear.hpp"
#include "core/sensing/ft_newton_euler.hpp"
#include "core/sensing/ft_tare_only.hpp"
#include "core/sensing/manual.hpp"
#include "rt/plugin/built_in_names.hpp"
#include "rt/registry/learned_sensors.hpp"
#include "rt/registry/plugin_registry.hpp"
#include "rt/registry/registry.hpp"
#include "rt/registry/sensor_keys.hpp"

namespace palpate::registry {
namespace {

std::unique_ptr<sensing::SensorModel> make_newton_euler(const config::Node& node,
                                                        const Frames& frames) {
  sensing::FtNewtonEuler::Options options;
  options.payload = read_payload(node);
  options.gravity_W = frames.gravity_W;
  options.X_ES = frames.X_ES;
  options.X_EI = frames.X_EI;
  options.use_imu = node.flag(
      {"use_imu", "",
       "whether IMU is used for the acceleration of the hand; else gravity alone is taken off"},
      options.use_imu);
  options.imu_offset_time = node.number(
      {"imu_offset_time", "s",
       "time constant of the offsets of the accelerometer that are followed; 0: it is trusted"},
      {0, 1000}, options.imu_offset_time);
  options.rest_speed = node.number(
      {"rest_speed", "m/s",
       "of the flange, and rad/s over 0.3 m: where it is slower the accelerations that IMU tells "
       "are smoothed over 0.1 s; 0: nowhere"},
      {0, 1}, options.rest_speed);
  options.rest_acceleration = node.number(
      {"rest_acceleration", "m/s^2",
       "beyond what is smoothed: a hand that accelerates more sets off, however slow it is yet; "
       "several times the noise of the accelerometer"},
      {1e-3, 100}, options.rest_acceleration);
  read_wrist_keys(node, options);
  options.cutoff = node.number({"cutoff_hz", "Hz", "of the low-pass filter of the output; 0: none"},
                               {0, 500}, options.cutoff);
  options.sample_rate = node.number({"sample_rate", "Hz", "of FT_WRENCH, for the filter"}, {1, 1e5},
                                    options.sample_rate);
  return std::make_unique<sensing::FtNewtonEuler>(options);
}

std::unique_ptr<sensing::SensorModel> make_tare_only(const config::Node& node) {
  sensing::FtTareOnly::Options options;
  read_wrist_keys(node, options);
  options.moving_average = node.integer({"moving_average", "readings", "averaged; 1: none"},
                                        {1, 100000}, options.moving_average);
  options.delay = node.integer(
      {"delay", "readings", "that the output is held back, to align it with a slower signal"},
      {0, 100000}, options.delay);
  return std::make_unique<sensing::FtTareOnly>(options);
}

/// Three rows `name`_x, `name`_y, `name`_z of `count` numbers.
sensing::LinearTactileModel::Matrix read_rows(const config::Node& node, const std::string& name,
                                              int count) {
  sensing::LinearTactileModel::Matrix matrix(3, count);
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<double> row = node.numbers(
        {name + "_" + "xyz"[axis], name == "place" ? "m" : "N",
         name == "place" ? "row of the map to the place, a number a feature; may be absent"
                         : "row of the map to the force, a number a feature"},
        count);
    matrix.row(axis) = Eigen::Map<const Eigen::RowVectorXd>(row.data(), count);
  }
  return matrix;
}

/// Section `model`, of this file or of the one named by `file_key`, as written by palpate-evaluate
/// tactile: features (counts: E1 to E19, PAC, PDC; products: see TactileFeatures); force_x,
/// force_y, force_z (N per feature), offset (N); and optionally place_x, place_y, place_z.
sensing::LinearTactileModel read_tactile_model(const config::Node& node,
                                               const std::string& file_key) {
  const config::Node holder =
      node.has(file_key) ? config::Node::load_file(node.path(
                               {file_key, "", "force map, as palpate-evaluate tactile writes it"}))
                         : node;
  const config::Node model = holder.child({"model", "",
                                           "force map of the fingertip, as palpate-evaluate "
                                           "tactile writes it, where no file is named"});
  sensing::LinearTactileModel result;
  if (model.choice({"features", "", "what the map multiplies: the counts, or also their products"},
                   {"counts", "products"}, "counts") == "products")
    result.features = sensing::TactileFeatures::kProducts;
  const int count = sensing::feature_count(result.features);
  result.matrix = read_rows(model, "force", count);
  if (model.has("place_x")) result.place = read_rows(model, "place", count);
  result.offset =
      model.vector3({"offset", "N", "added to the force"}, {-100, 100}, Eigen::Vector3d::Zero());
  return result;
}

std::unique_ptr<sensing::SensorModel> make_manual(const config::Node& node) {
  sensing::Manual::Options options;
  options.expires_after =
      node.number({"expires_after_ms", "ms", "without a renewal, after which a manual force ends"},
                  {1, 1e4}, 100) *
      1e-3;
  options.max_force = node.number({"max_force", "N", "longer forces are shortened to it"}, {0, 1e4},
                                  options.max_force);
  return std::make_unique<sensing::Manual>(options);
}

}  // namespace

std::unique_ptr<sensing::SensorModel> make_biotac_linear(const config::Node& node,
                                                         const std::string& file_key) {
  sensing::BiotacLinear::Options options;
  read_fingertip_keys(node, options);
  options.model = read_tactile_model(node, file_key);
  return std::make_unique<sensing::BiotacLinear>(options);
}

int read_arm(const config::Node& node, const Context& context) {
  const int arm = node.integer({"arm", "", "0: the first arm, 1: the second"}, {0, 1}, 0);
  if (arm == 1 && !context.second_frames) node.fail("arm", "there is no section second_arm");
  if (arm == 1 &&
      listens_to(node.text({"component", "", "model of the sensor"}), context) != Listens::kWrist)
    node.fail("arm", "of the second arm only the force-torque sensor can be used");
  return arm;
}

Listens listens_to(const std::string& name, const Context& context) {
  if (const auto* entry = plugin::find_plugin(plugins_of(context).sensor_models, name)) {
    if (entry->sensor == plugin::SensorKind::kWrist) return Listens::kWrist;
    return entry->sensor == plugin::SensorKind::kFinger ? Listens::kFinger : Listens::kOther;
  }
  if (name.rfind("ft_", 0) == 0) return Listens::kWrist;
  return name.rfind("biotac_", 0) == 0 ? Listens::kFinger : Listens::kOther;
}

std::unique_ptr<sensing::SensorModel> make_sensor_model(const config::Node& node,
                                                        const Context& context) {
  const auto& plugins = plugins_of(context).sensor_models;
  const std::string name = node.choice({"component", "", "model of the sensor"},
                                       plugin::with_plugins(plugin::kSensorModels, plugins));
  if (const auto* entry = plugin::find_plugin(plugins, name))
    return make_plugin(*entry, node, context);
  try {
    const Frames& frames = read_arm(node, context) == 1 ? *context.second_frames : context.frames;
    if (name == "ft_newton_euler") return make_newton_euler(node, frames);
    if (name == "ft_rnnob") return make_ft_rnnob(node, frames, context);
    if (name == "ft_tare_only") return make_tare_only(node);
    if (name == "biotac_lstm") return make_biotac_lstm(node, context);
    if (name == "biotac_linear") return make_biotac_linear(node, "model_file");
    return make_manual(node);
  } catch (const std::invalid_argument& error) {
    node.fail("", error.what());
  }
}

}  // namespace palpate::registry

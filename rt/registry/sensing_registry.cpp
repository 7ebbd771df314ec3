#include "core/sensing/biotac_linear.hpp"
#include "core/sensing/fingertip.hpp"
#include "core/sensing/ft_newton_euler.hpp"
#include "core/sensing/ft_tare_only.hpp"
#include "core/sensing/manual.hpp"
#include "rt/registry/sensors.hpp"
#include "rt/registry/slot.hpp"

namespace palpate::registry {
namespace {

using config::OptionTable;
using sensing::FtNewtonEuler;
using sensing::FtTareOnly;
using sensing::Manual;

OptionTable<FtNewtonEuler::Options> newton_euler_options() {
  using Options = FtNewtonEuler::Options;
  return OptionTable<Options>()
      .flag("use_imu", "Acceleration of the hand from IMU; else only gravity is compensated",
            &Options::use_imu)
      .number("imu_offset_time", "s",
              "Time constant of the estimated offsets of the accelerometer; 0: no correction",
              {0, 1000}, &Options::imu_offset_time)
      .number("rest_speed", "m/s",
              "Speed of the flange, and rad/s over 0.3 m, below which accelerations from IMU are "
              "smoothed over 0.1 s; 0: never",
              {0, 1}, &Options::rest_speed)
      .number("rest_acceleration", "m/s^2",
              "Difference between the mean acceleration of the last 15 ms and the smoothed one "
              "beyond which the smoothing restarts; six times the noise of that mean",
              {1e-3, 100}, &Options::rest_acceleration)
      .part(wrist_options<Options>())
      .number("cutoff_hz", "Hz", "Cutoff of the low-pass filter of the output; 0: none", {0, 500},
              &Options::cutoff)
      .number("sample_rate", "Hz", "Rate of FT_WRENCH, for the filter", {1, 1e5},
              &Options::sample_rate);
}

OptionTable<sensing::Fingertip::Options> fingertip_contact_options() {
  using Options = sensing::Fingertip::Options;
  return sensor_options<Options>()
      .flag("tare_at_start", "Tare at the start and after a reset, during which nothing is touched",
            &Options::tare_at_start)
      .integer("finger", "Index of the fingertip: channel FINGERTIP_n", {0, 4}, &Options::finger)
      .number("contact_force", "N", "Force above which a contact begins", {0, 100},
              &Options::contact_force)
      .number("release_force", "N",
              "Force below which a contact ends; a contact that pulls more than that is not used",
              {0, 100}, &Options::release_force)
      .number("max_place_deviation_mm", "mm",
              "Standard deviation of the place beyond which a contact is not used", {1e-3, 1000},
              &Options::max_place_deviation, 1e-3);
}

std::unique_ptr<sensing::SensorModel> make_newton_euler(FtNewtonEuler::Options options,
                                                        const config::Node& node,
                                                        const Context& context) {
  const Frames& frames = frames_of(node, context);
  options.payload = read_payload(node);
  options.gravity_W = frames.gravity_W;
  options.X_ES = frames.X_ES;
  options.X_EI = frames.X_EI;
  return std::make_unique<FtNewtonEuler>(options);
}

/// Three rows `name`_x, `name`_y, `name`_z of `count` numbers in `unit`.
sensing::LinearTactileModel::Matrix read_rows(const config::Node& node, const std::string& name,
                                              const char* unit, const char* description,
                                              int count) {
  sensing::LinearTactileModel::Matrix matrix(3, count);
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<double> row =
        node.numbers({name + "_" + "xyz"[axis], unit, description}, count);
    matrix.row(axis) = Eigen::Map<const Eigen::RowVectorXd>(row.data(), count);
  }
  return matrix;
}

/// Section `model`, of this file or of the one named by `file_key`, as written by palpate-evaluate
/// tactile.
sensing::LinearTactileModel read_tactile_model(const config::Node& node,
                                               const std::string& file_key) {
  const config::Node holder =
      node.has(file_key) ? config::Node::load_file(node.path(
                               {file_key, "", "File with the linear force map of the skin"}))
                         : node;
  const config::Node model =
      holder.child({"model", "", "Linear force map of the skin, where no file is named"});
  using Result = sensing::LinearTactileModel;
  Result result = model.read(
      OptionTable<Result>()
          .choice<sensing::TactileFeatures>(
              "features", "Factors of the map: the counts, or also their products",
              {{"counts", sensing::TactileFeatures::kCounts},
               {"products", sensing::TactileFeatures::kProducts}},
              &Result::features)
          .vector3("offset", "N", "Constant part of the force", {-100, 100}, &Result::offset));
  const int count = sensing::feature_count(result.features);
  result.matrix =
      read_rows(model, "force", "N", "Row of the map to the force, one number per feature", count);
  if (model.has("place_x"))
    result.place = read_rows(model, "place", "m",
                             "Row of the map to the location, one number per feature", count);
  return result;
}

}  // namespace

sensing::PayloadParameters read_payload(const config::Node& node) {
  const config::Node payload = node.child(
      {"payload", "",
       "Load of the sensor, identified from readings in several poses with nothing held; "
       "required by ft_newton_euler"});
  struct Keys {
    sensing::PayloadParameters parameters;
    Eigen::Vector3d center_of_mass = Eigen::Vector3d::Zero();  // m
    std::vector<double> inertia, bias;
  };
  const Keys keys = payload.read(
      OptionTable<Keys>()
          .number(
              "mass", "kg", "Mass behind the sensor", {0, 1000},
              [](auto& all) -> auto& { return all.parameters.mass; })
          .required()
          .vector3("center_of_mass", "m", "Centre of mass in S", {-2, 2}, &Keys::center_of_mass)
          .numbers("inertia", "kg m^2",
                   "Inertia xx, xy, xz, yy, yz, zz about the origin of S; absent: that of a point "
                   "mass at center_of_mass",
                   {-100, 100}, 6, &Keys::inertia)
          .optional()
          .numbers("bias", "N, N m", "Offset of the readings, force first", {-1000, 1000}, 6,
                   &Keys::bias)
          .optional());
  sensing::PayloadParameters parameters = keys.parameters;
  parameters.first_moment = parameters.mass * keys.center_of_mass;
  parameters.inertia = keys.inertia.empty()
                           ? sensing::point_inertia(parameters.mass, parameters.first_moment)
                           : math::Vector6d(keys.inertia.data());
  if (!keys.bias.empty()) parameters.bias = math::Wrench::from(math::Vector6d(keys.bias.data()));
  return parameters;
}

std::unique_ptr<sensing::SensorModel> make_biotac_linear(const config::Node& node,
                                                         const std::string& file_key) {
  auto options = node.read(fingertip_options<sensing::BiotacLinear::Options>());
  options.model = read_tactile_model(node, file_key);
  return std::make_unique<sensing::BiotacLinear>(options);
}

int read_arm(const config::Node& node, const Context& context) {
  const int arm = node.integer({"arm", "", "Index of the arm; 1: the second arm"}, {0, 1}, 0);
  if (arm == 1 && !context.second_frames) node.fail("arm", "1: there is no section second_arm");
  if (arm == 1 && sensor_kind(node.text("component"), context) != plugin::SensorKind::kWrist)
    node.fail("arm", "1: only the force-torque sensor of the second arm can be used");
  return arm;
}

plugin::SensorKind sensor_kind(const std::string& name, const Context& context) {
  if (const auto* entry = plugin::find_plugin(plugins_of(context).sensor_models, name))
    return entry->sensor;
  if (name.rfind("ft_", 0) == 0 || name == "joint_torque") return plugin::SensorKind::kWrist;
  return name.rfind("biotac_", 0) == 0 || name == "fingertip" ? plugin::SensorKind::kFinger
                                                              : plugin::SensorKind::kOther;
}

std::unique_ptr<sensing::SensorModel> make_sensor_model(const config::Node& node,
                                                        const Context& context) {
  static const auto slot =
      Slot<plugin::PluginSensorModel>({"component", "", "Model of the sensor"},
                                      &plugin::PluginRegistrar::sensor_models)
          .add("ft_newton_euler", "Wrist sensor with rigid-body dynamics of its payload",
               newton_euler_options(), make_newton_euler)
          .add("ft_rnnob", "Wrist sensor with a learned observer of non-contact forces",
               make_ft_rnnob)
          .add("ft_tare_only", "Wrist sensor without compensation",
               wrist_options<FtTareOnly::Options>()
                   .integer("moving_average", "Number of averaged readings; 1: none", {1, 100000},
                            &FtTareOnly::Options::moving_average)
                   .integer("delay",
                            "Delay of the output as a number of readings, for alignment with a "
                            "slower signal",
                            {0, 100000}, &FtTareOnly::Options::delay),
               from_options<FtTareOnly>())
          .add("joint_torque", "Wrist wrench from the joint torques of an arm without that sensor",
               make_joint_torque)
          .add("biotac_linear", "BioTac fingertip with a linear force map",
               [](const config::Node& own, const Context&) {
                 return make_biotac_linear(own, "model_file");
               })
          .add("biotac_lstm", "BioTac fingertip with a recurrent network", make_biotac_lstm)
          .add("fingertip", "Fingertip whose sensor reports place, normal and force",
               fingertip_contact_options(), from_options<sensing::Fingertip>())
          .add("manual", "Forces that a user sends",
               OptionTable<Manual::Options>()
                   .number("expires_after_ms", "ms",
                           "Time without a renewal after which a manual force ends", {1, 1e4},
                           &Manual::Options::expires_after, 1e-3)
                   .number("max_force", "N", "Largest manual force; larger ones are scaled down",
                           {0, 1e4}, &Manual::Options::max_force),
               from_options<Manual>());
  slot.name(node, context);
  read_arm(node, context);  // also where the component does not use it
  return slot.make(node, context);
}

}  // namespace palpate::registry

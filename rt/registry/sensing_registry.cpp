#include "core/sensing/biotac_linear.hpp"
#include "core/sensing/ft_newton_euler.hpp"
#include "core/sensing/ft_tare_only.hpp"
#include "core/sensing/manual.hpp"
#include "rt/registry/learned_sensors.hpp"
#include "rt/registry/plugin_registry.hpp"
#include "rt/registry/registry.hpp"
#include "rt/registry/sensor_keys.hpp"
#include "rt/registry/slot.hpp"

namespace palpate::registry {
namespace {

using config::OptionTable;
using sensing::FtNewtonEuler;
using sensing::FtTareOnly;
using sensing::Manual;

const Frames& frames_of(const config::Node& node, const Context& context) {
  return read_arm(node, context) == 1 ? *context.second_frames : context.frames;
}

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
              "Acceleration above the smoothed value that counts as the start of a motion; several "
              "times the noise of the accelerometer",
              {1e-3, 100}, &Options::rest_acceleration)
      .part(wrist_options<Options>())
      .number("cutoff_hz", "Hz", "Cutoff of the low-pass filter of the output; 0: none", {0, 500},
              &Options::cutoff)
      .number("sample_rate", "Hz", "Rate of FT_WRENCH, for the filter", {1, 1e5},
              &Options::sample_rate);
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

OptionTable<FtTareOnly::Options> tare_only_options() {
  using Options = FtTareOnly::Options;
  return wrist_options<Options>()
      .integer("moving_average", "Number of averaged readings; 1: none", {1, 100000},
               &Options::moving_average)
      .integer("delay",
               "Delay of the output as a number of readings, for alignment with a slower signal",
               {0, 100000}, &Options::delay);
}

OptionTable<Manual::Options> manual_options() {
  using Options = Manual::Options;
  return OptionTable<Options>()
      .number("expires_after_ms", "ms", "Time without a renewal after which a manual force ends",
              {1, 1e4}, &Options::expires_after, 1e-3)
      .number("max_force", "N", "Largest manual force; larger ones are scaled down", {0, 1e4},
              &Options::max_force);
}

/// Three rows `name`_x, `name`_y, `name`_z of `count` numbers.
sensing::LinearTactileModel::Matrix read_rows(const config::Node& node, const std::string& name,
                                              int count) {
  const bool place = name == "place";
  sensing::LinearTactileModel::Matrix matrix(3, count);
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<double> row =
        node.numbers({name + "_" + "xyz"[axis], place ? "m" : "N",
                      place ? "Row of the map to the location, one number per feature"
                            : "Row of the map to the force, one number per feature"},
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
      node.has(file_key)
          ? config::Node::load_file(
                node.path({file_key, "", "File with the force map of palpate-evaluate tactile"}))
          : node;
  const config::Node model =
      holder.child({"model", "", "Force map of palpate-evaluate tactile, where no file is named"});
  sensing::LinearTactileModel result;
  if (model.choice({"features", "", "Factors of the map: the counts, or also their products"},
                   {"counts", "products"}, "counts") == "products")
    result.features = sensing::TactileFeatures::kProducts;
  const int count = sensing::feature_count(result.features);
  result.matrix = read_rows(model, "force", count);
  if (model.has("place_x")) result.place = read_rows(model, "place", count);
  result.offset = model.vector3({"offset", "N", "Constant part of the force"}, {-100, 100},
                                Eigen::Vector3d::Zero());
  return result;
}

const Slot<sensing::SensorModel>& sensors() {
  static const auto slot =
      Slot<sensing::SensorModel>()
          .add("ft_newton_euler", "Wrist sensor with rigid-body dynamics of its payload",
               newton_euler_options(), make_newton_euler)
          .add("ft_rnnob", "Wrist sensor with a learned observer of non-contact forces",
               [](const config::Node& node, const Context& context) {
                 return make_ft_rnnob(node, frames_of(node, context), context);
               })
          .add("ft_tare_only", "Wrist sensor without compensation", tare_only_options(),
               [](const FtTareOnly::Options& options, const config::Node&, const Context&) {
                 return std::make_unique<FtTareOnly>(options);
               })
          .add("biotac_linear", "BioTac fingertip with a linear force map",
               [](const config::Node& node, const Context&) {
                 return make_biotac_linear(node, "model_file");
               })
          .add("biotac_lstm", "BioTac fingertip with a recurrent network", make_biotac_lstm)
          .add("manual", "Forces that a user sends", manual_options(),
               [](const Manual::Options& options, const config::Node&, const Context&) {
                 return std::make_unique<Manual>(options);
               });
  return slot;
}

}  // namespace

sensing::PayloadParameters read_payload(const config::Node& node) {
  const config::Node payload =
      node.child({"payload", "",
                  "Load of the sensor, as identified by palpate-evaluate payload; required by "
                  "ft_newton_euler"});
  sensing::PayloadParameters parameters;
  parameters.mass = payload.number({"mass", "kg", "Mass behind the sensor"}, {0, 1000});
  parameters.first_moment =
      parameters.mass * payload.vector3({"center_of_mass", "m", "Centre of mass in S"}, {-2, 2},
                                        Eigen::Vector3d::Zero());
  parameters.inertia = sensing::point_inertia(parameters.mass, parameters.first_moment);
  if (payload.has("inertia")) {
    const std::vector<double> inertia =
        payload.numbers({"inertia", "kg m^2",
                         "Inertia xx, xy, xz, yy, yz, zz about the origin of S; absent: that of a "
                         "point mass at center_of_mass"},
                        6, {-100, 100});
    parameters.inertia = Eigen::Map<const math::Vector6d>(inertia.data());
  }
  if (payload.has("bias")) {
    const std::vector<double> bias = payload.numbers(
        {"bias", "N, N m", "Offset of the readings, force first"}, 6, {-1000, 1000});
    parameters.bias = math::Wrench::from(Eigen::Map<const math::Vector6d>(bias.data()));
  }
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
  if (arm == 1 &&
      listens_to(node.text({"component", "", "Model of the sensor"}), context) != Listens::kWrist)
    node.fail("arm", "1: only the force-torque sensor of the second arm can be used");
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
  const std::string name =
      sensors().name(node, {"component", "", "Model of the sensor"},
                     plugin::with_plugins(std::vector<std::string>(), plugins));
  if (const auto* entry = plugin::find_plugin(plugins, name))
    return make_plugin(*entry, node, context);
  frames_of(node, context);  // reads `arm` also where the component does not use it
  return sensors().make(name, "", node, context);
}

}  // namespace palpate::registry

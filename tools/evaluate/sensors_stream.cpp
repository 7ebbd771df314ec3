#include "tools/evaluate/sensors_stream.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "core/sensing/biotac_lstm.hpp"
#include "core/sensing/linear_tactile.hpp"
#include "rt/component/learned_sensors.hpp"

namespace palpate::evaluate {
namespace {

constexpr double kPatience = 10;  // s
const Eigen::Vector3d kGravity(0, 0, -9.81);

// Places in the rows of train::wrist_columns().
constexpr int kQuaternion = 0, kVelocity = 4, kRate = 7, kAcceleration = 10, kForce = 13;

template <class T, int kCapacity>
void feed(sensing::Stream<T, kCapacity>& stream, const T& sample) {
  stream.freshness = sensing::Freshness::kNew;
  stream.age = 0;
  stream.latest = stream.fresh[0] = sample;
  stream.fresh_count = 1;
}

config::Node section(const std::string& component, const std::string& model,
                     const std::string& executor, const std::string& more) {
  return config::Node::from_text("{component: " + component +
                                     ", model_file: " + nlohmann::json(model).dump() +
                                     ", executor: " + executor + more + "}",
                                 component);
}

sensing::BioTac tactile_sample(const train::Table& table, Eigen::Index row, double time) {
  constexpr int kCount = sensing::kElectrodeCount;
  sensing::BioTac sample;
  sample.time = time;
  sample.electrodes = table.rows.row(row).head(kCount).transpose();
  sample.pac = table.rows(row, kCount);
  sample.pdc = table.rows(row, kCount + 1);
  return sample;
}

Eigen::Matrix3d orientation(const train::Table& table, Eigen::Index row) {
  const auto q = table.rows.row(row).segment<4>(kQuaternion);
  return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
}

}  // namespace

inference::TorchExecutorOptions patient_executor() {
  inference::TorchExecutorOptions options;
  options.wait = options.patience = kPatience;
  return options;
}

Eigen::MatrixXd stream_fingertip(const std::string& model, const std::string& executor,
                                 const SensorTrack& track) {
  component::Context context;
  context.deterministic = true;
  const auto component =
      component::make_biotac_lstm(section("biotac_lstm", model, executor,
                                          ", tare_samples: " + std::to_string(track.tare_rows) +
                                              ", contact_force: 0, release_force: 0"),
                                  context);
  const auto& fingertip = dynamic_cast<const sensing::BiotacLstm&>(*component);

  const train::Table& table = track.recording.table;
  const double interval =
      table.time[table.time.size() - 1] / static_cast<double>(table.time.size());
  sensing::Signals signals;
  sensing::ContactSet contacts;
  const auto take = [&](Eigen::Index row, double time) {
    feed(signals.biotac[0], tactile_sample(table, row, time));
    contacts.count = 0;
    const sensing::UpdateResult result = component->update(signals, contacts);
    if (result.status == sensing::Status::kFault)
      throw std::runtime_error(model + ": on " + track.recording.name + ": " + result.reason);
  };
  for (Eigen::Index k = 0; k < track.tare_rows; ++k)
    take(track.tare_begin + k, static_cast<double>(k - track.tare_rows) * interval);
  Eigen::MatrixXd forces(table.time.size(), 3);
  for (Eigen::Index k = 0; k < forces.rows(); ++k) {
    take(k, table.time[k]);
    forces.row(k) = fingertip.force().transpose();
  }
  return forces;
}

Eigen::MatrixXd stream_wrist(const std::string& model, const std::string& executor,
                             const inference::ModelCard& card, const SensorTrack& track) {
  const train::Table& raw = track.recording.table;
  const double raw_rate = static_cast<double>(raw.time.size() - 1) / raw.time[raw.time.size() - 1];
  const auto ticks_per_step =
      static_cast<Eigen::Index>(std::max(1.0, std::ceil(raw_rate / card.rate - 0.01)));
  const double loop_rate = card.rate * static_cast<double>(ticks_per_step);
  const train::Table table = train::resample(raw, loop_rate, 0);
  train::Table felt = table;
  for (const inference::StreamDelay& delay : card.delays)
    if (delay.stream == "inertial") train::delay_columns(felt, kQuaternion, 4, delay.seconds);

  component::Context context;
  context.deterministic = true;
  context.period = 1 / loop_rate;
  context.frames.gravity_W = kGravity;
  const auto component =
      component::make_ft_rnnob(section("ft_rnnob", model, executor, ""), context.frames, context);
  sensing::Signals signals;
  sensing::ContactSet contacts;
  Eigen::MatrixXd wrenches(track.time.size(), 6);
  Eigen::Index step = 0;
  for (Eigen::Index tick = 0; tick < table.time.size() && step < wrenches.rows(); ++tick) {
    const auto row = table.rows.row(tick);
    sensing::RobotState robot;
    robot.X_WE.linear() = orientation(table, tick);
    robot.V_W_E.linear = row.segment<3>(kVelocity).transpose();
    feed(signals.robot, robot);
    sensing::Inertial inertial;
    inertial.angular_velocity_I = row.segment<3>(kRate).transpose();
    inertial.acceleration_I = row.segment<3>(kAcceleration).transpose();
    if (!track.acceleration_has_gravity)
      inertial.acceleration_I -= orientation(felt, tick).transpose() * kGravity;
    feed(signals.inertial, inertial);
    sensing::ForceTorque wrench;
    wrench.F_S = {row.segment<3>(kForce).transpose(), row.segment<3>(kForce + 3).transpose()};
    feed(signals.force_torque, wrench);
    contacts.count = 0;
    const sensing::UpdateResult result = component->update(signals, contacts);
    if (contacts.count != 1)
      throw std::runtime_error(model + ": on " + track.recording.name + ": " + result.reason);
    if (tick % ticks_per_step == 0)
      wrenches.row(step++) = contacts.contacts[0].wrench.vector().transpose();
  }
  for (; step < wrenches.rows(); ++step) wrenches.row(step) = wrenches.row(step - 1);
  return wrenches;
}

}  // namespace palpate::evaluate

#include "tools/lab/sensor_models/sensors_stream.hpp"

#include <unistd.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "core/sensing/biotac_lstm.hpp"
#include "core/sensing/linear_tactile.hpp"
#include "rt/inference/model_file.hpp"
#include "rt/registry/sensors.hpp"

namespace palpate::sensor_models {
namespace {

constexpr double kReportPatience = 10;  // s
const Eigen::Vector3d kGravityInW(0, 0, -9.81);

// Indices in the rows of train::wrist_columns().
constexpr int kQuaternion = 0, kVelocity = 4, kRate = 7, kAcceleration = 10, kForce = 13;

template <class T, int kCapacity>
void feed(sensing::Stream<T, kCapacity>& stream, const T& sample) {
  stream.freshness = Freshness::kNew;
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

sensing::BioTac tactile_sample(const recordings::Table& table, Eigen::Index row, double time) {
  constexpr int kCount = sensing::kElectrodeCount;
  sensing::BioTac sample;
  sample.time = time;
  sample.electrodes = table.rows.row(row).head(kCount).transpose();
  sample.pac = table.rows(row, kCount);
  sample.pdc = table.rows(row, kCount + 1);
  return sample;
}

Eigen::Matrix3d orientation(const recordings::Table& table, Eigen::Index row) {
  const auto q = table.rows.row(row).segment<4>(kQuaternion);
  return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
}

std::string tare_and_no_gate(const SensorTrack& track) {
  return ", tare_samples: " + std::to_string(track.tare_rows) +
         ", contact_force: 0, release_force: 0";
}

/// Feeds a track to the component that `node` describes: first the rows at rest, then all from the
/// start, each followed by visit(row, component, contacts).
template <class Visit>
void run_fingertip(const config::Node& node, const SensorTrack& track, Visit visit) {
  registry::Context context;
  context.deterministic = true;
  const auto component = registry::make_biotac_lstm(node, context);
  const auto& fingertip = dynamic_cast<const sensing::BiotacLstm&>(*component);
  const recordings::Table& table = track.recording.table;
  const double interval =
      table.time[table.time.size() - 1] / static_cast<double>(table.time.size());
  sensing::Signals signals;
  sensing::ContactSet contacts;
  const auto take = [&](Eigen::Index row, double time) {
    feed(signals.biotac[0], tactile_sample(table, row, time));
    contacts.count = 0;
    const UpdateResult result = component->update(signals, contacts);
    if (result.status == Status::kFault)
      throw std::runtime_error("on " + track.recording.name + ": " + result.reason);
  };
  for (Eigen::Index k = 0; k < track.tare_rows; ++k)
    take(track.tare_begin + k, static_cast<double>(k - track.tare_rows) * interval);
  for (Eigen::Index k = 0; k < table.time.size(); ++k) {
    take(k, table.time[k]);
    visit(k, fingertip, contacts);
  }
}

/// The file of a network that outputs a constant 1 N; deleted with this object.
class ConstantForce {
 public:
  explicit ConstantForce(double rate)
      : path_((std::filesystem::temp_directory_path() /
               ("palpate-constant-force-" + std::to_string(getpid()) + ".pt"))
                  .string()) {
    inference::ModelCard card;
    card.name = "constant_force";
    card.rate = rate;
    card.inputs = {{"pdc", "count"}};
    card.outputs = {{"fx", "N"}, {"fy", "N"}, {"fz", "N"}};
    sensing::RecurrentWeights weights = sensing::RecurrentWeights::zero(1, 3, {1});
    weights.offset[2] = 1;
    inference::write_model_file(path_, weights, card);
  }
  ~ConstantForce() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
    std::filesystem::remove(inference::card_path(path_), ignored);
  }
  ConstantForce(const ConstantForce&) = delete;
  ConstantForce& operator=(const ConstantForce&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace

inference::TorchExecutorOptions patient_executor() {
  inference::TorchExecutorOptions options;
  options.wait = options.patience = kReportPatience;
  return options;
}

Eigen::MatrixXd stream_fingertip(const std::string& model, const std::string& executor,
                                 const SensorTrack& track) {
  Eigen::MatrixXd forces(track.time.size(), 3);
  run_fingertip(
      section("biotac_lstm", model, executor, tare_and_no_gate(track)), track,
      [&](Eigen::Index row, const sensing::BiotacLstm& fingertip, const sensing::ContactSet&) {
        forces.row(row) = fingertip.force().transpose();
      });
  return forces;
}

Eigen::MatrixXd stream_place(const std::string& direction, const inference::ModelCard& card,
                             const FingertipFrame& frame, const std::string& executor,
                             const SensorTrack& track) {
  const ConstantForce force(card.rate);
  const Eigen::Quaterniond q(Eigen::Matrix3d(frame.R_NT.transpose()));
  const nlohmann::json wxyz{q.w(), q.x(), q.y(), q.z()};
  const config::Node node =
      section("biotac_lstm", force.path(), executor,
              tare_and_no_gate(track) + ", direction_file: " + nlohmann::json(direction).dump() +
                  ", direction_frame: {quaternion: " + wxyz.dump() +
                  "}, polarity: " + (polarity_of({track}) < 0 ? "-1" : "1") +
                  ", saturation: " + std::to_string(std::max(1.0, frame.localization.saturation)));
  Eigen::Vector3d normal(0, 0, -1);
  Eigen::MatrixXd normals(track.time.size(), 3);
  run_fingertip(
      node, track,
      [&](Eigen::Index row, const sensing::BiotacLstm&, const sensing::ContactSet& contacts) {
        if (contacts.count > 0) normal = sensing::skin_normal(contacts.contacts[0].location);
        normals.row(row) = (frame.R_NT * normal).transpose();
      });
  return normals;
}

Eigen::MatrixXd stream_wrist(const std::string& model, const std::string& executor,
                             const inference::ModelCard& card, const SensorTrack& track) {
  const recordings::Table& raw = track.recording.table;
  const double raw_rate = static_cast<double>(raw.time.size() - 1) / raw.time[raw.time.size() - 1];
  const auto ticks_per_step =
      static_cast<Eigen::Index>(std::max(1.0, std::ceil(raw_rate / card.rate - 0.01)));
  const double loop_rate = card.rate * static_cast<double>(ticks_per_step);
  const recordings::Table table = recordings::resample(raw, loop_rate, 0);
  recordings::Table felt = table;
  for (const inference::StreamDelay& delay : card.delays)
    if (delay.stream == "inertial") recordings::delay_columns(felt, kQuaternion, 4, delay.seconds);

  registry::Context context;
  context.deterministic = true;
  context.period = 1 / loop_rate;
  context.frames.gravity_W = kGravityInW;
  const auto component = registry::make_ft_rnnob(section("ft_rnnob", model, executor, ""), context);
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
      inertial.acceleration_I -= orientation(felt, tick).transpose() * kGravityInW;
    feed(signals.inertial, inertial);
    sensing::ForceTorque wrench;
    wrench.F_S = {row.segment<3>(kForce).transpose(), row.segment<3>(kForce + 3).transpose()};
    feed(signals.force_torque, wrench);
    contacts.count = 0;
    const UpdateResult result = component->update(signals, contacts);
    if (contacts.count != 1)
      throw std::runtime_error(model + ": on " + track.recording.name + ": " + result.reason);
    if (tick % ticks_per_step == 0)
      wrenches.row(step++) = contacts.contacts[0].wrench.vector().transpose();
  }
  for (; step < wrenches.rows(); ++step) wrenches.row(step) = wrenches.row(step - 1);
  return wrenches;
}

}  // namespace palpate::sensor_models

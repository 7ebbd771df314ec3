#include "tools/train/wrist_data.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <stdexcept>

#include "core/sensing/recurrent_observer_inputs.hpp"
#include "tools/train/delay.hpp"

namespace palpate::train {
namespace {

// Places in the rows of wrist_columns().
constexpr int kQuaternion = 0, kVelocity = 4, kRate = 7, kAcceleration = 10, kForce = 13;
constexpr int kPoseColumns = 7, kInertialColumns = 6, kWrenchColumns = 6;
const Eigen::Vector3d kGravity(0, 0, -9.81);  // m/s^2, in W

Eigen::Matrix3d rotation(const Eigen::RowVectorXd& row) {
  const Eigen::Quaterniond q(row[0], row[1], row[2], row[3]);
  if (!(q.norm() > 0.5)) throw std::runtime_error("a quaternion is far from unit length");
  return q.normalized().toRotationMatrix();
}

/// Rate of turn in S from neighbouring orientations, rad/s.
Eigen::MatrixXd rate_of_orientation(const Table& table, double rate) {
  const Eigen::Index n = table.rows.rows();
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(n, 3);
  for (Eigen::Index k = 1; k + 1 < n; ++k) {
    const Eigen::Matrix3d turn =
        rotation(table.rows.row(k - 1)).transpose() * rotation(table.rows.row(k + 1));
    result.row(k) = math::log_rotation(turn).transpose() * rate / 2;
  }
  return result;
}

/// Without what is slower than a second (drift, creep, hysteresis) or quicker than a few
/// hundredths (noise): both signals of a comparison pass through it alike.
Eigen::MatrixXd quick_part(const Eigen::MatrixXd& rows, double rate) {
  Table table;
  table.rows = rows;
  table.time =
      Eigen::VectorXd::LinSpaced(rows.rows(), 0, static_cast<double>(rows.rows() - 1)) / rate;
  const Eigen::MatrixXd smooth = resample(table, rate, 0.03).rows;
  const Eigen::MatrixXd slow = resample(table, rate, 1).rows;
  const Eigen::Index n = std::min({rows.rows(), smooth.rows(), slow.rows()});
  return smooth.topRows(n) - slow.topRows(n);
}

std::vector<inference::StreamDelay> align(Table& table, const WristColumns& columns, double rate) {
  const double largest = columns.largest_delay;
  const double inertial =
      identify_delay(quick_part(rate_of_orientation(table, rate), rate),
                     quick_part(table.rows.middleCols(kRate, 3), rate), rate, largest)
          .seconds;
  // A payload of a kilogram that moves as the inertial unit says and hangs as the pose says.
  Table motion = table;
  delay_columns(motion, kAcceleration, 3, -inertial);
  Eigen::MatrixXd load = motion.rows.middleCols(kAcceleration, 3);
  if (!columns.acceleration_has_gravity)
    for (Eigen::Index k = 0; k < load.rows(); ++k)
      load.row(k) -= (rotation(table.rows.row(k)).transpose() * kGravity).transpose();
  const double wrench =
      identify_delay(quick_part(load, rate), quick_part(table.rows.middleCols(kForce, 3), rate),
                     rate, largest)
          .seconds;
  const double latest = std::max({0.0, inertial, wrench});
  delay_columns(table, kQuaternion, kPoseColumns, latest);
  delay_columns(table, kRate, kInertialColumns, latest - inertial);
  delay_columns(table, kForce, kWrenchColumns, latest - wrench);
  return {{"inertial", inertial}, {"force_torque", wrench}};
}

math::Wrench operator-(const math::Wrench& a, const math::Wrench& b) {
  return {a.force - b.force, a.torque - b.torque};
}

}  // namespace

std::vector<std::string> wrist_columns(const WristColumns& columns) {
  std::vector<std::string> list;
  for (const auto* part : {&columns.quaternion, &columns.velocity, &columns.rate,
                           &columns.acceleration, &columns.force, &columns.torque})
    list.insert(list.end(), part->begin(), part->end());
  return list;
}

WristRecording load_wrist(const DataPlan& plan, const Table& raw) {
  const double raw_rate = static_cast<double>(raw.time.size() - 1) / raw.time[raw.time.size() - 1];
  WristRecording recording;
  Table table = raw;
  // On a uniform grid, quaternions without jumps of sign, so that they may be averaged.
  table = resample(table, raw_rate, 0);
  for (Eigen::Index k = 1; k < table.rows.rows(); ++k)
    if (table.rows.row(k).head<4>().dot(table.rows.row(k - 1).head<4>()) < 0)
      table.rows.row(k).head<4>() *= -1;
  recording.delays = align(table, plan.wrist, raw_rate);
  table = resample(table, plan.rate, plan.average);

  const Eigen::Index n = table.rows.rows();
  recording.time = table.time;
  recording.inputs.resize(n, sensing::kObserverInputCount);
  Eigen::Vector4d quaternion = Eigen::Vector4d::Zero();
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto row = table.rows.row(k);
    const Eigen::Matrix3d R_WS = rotation(row);
    sensing::MotionSample sample;
    sample.motion.angular_velocity = row.segment<3>(kRate).transpose();
    sample.motion.specific_force = row.segment<3>(kAcceleration).transpose();
    if (!plan.wrist.acceleration_has_gravity)
      sample.motion.specific_force -= R_WS.transpose() * kGravity;
    if (k > 0)
      sample.motion.angular_acceleration =
          plan.rate *
          (sample.motion.angular_velocity - recording.samples.back().motion.angular_velocity);
    sample.F_S = {row.segment<3>(kForce).transpose(), row.segment<3>(kForce + 3).transpose()};
    const sensing::ObserverInputs inputs = sensing::observer_inputs(
        R_WS, row.segment<3>(kVelocity).transpose(), sample.motion, kGravity, quaternion);
    quaternion = inputs.head<4>();
    recording.inputs.row(k) = inputs.transpose();
    recording.samples.push_back(sample);
  }
  return recording;
}

void finish_wrists(const DataPlan& plan, const std::vector<WristRecording>& wrists, DataSet& data) {
  std::vector<int> columns;
  for (const std::string& name : columns_of(plan.inputs))
    columns.push_back(sensing::observer_input_index(name));

  const auto is_training = [&](std::size_t r, std::size_t k) {
    return data.recordings[r].parts[k] == Part::kTraining;
  };
  // One payload and a bias for each recording: identification and biases by turns, which ends in
  // the least squares of both.
  std::vector<math::Wrench> bias(wrists.size());
  sensing::PayloadParameters payload;
  const auto mean_rest = [&](std::size_t r, bool training_only) {
    math::Vector6d sum = math::Vector6d::Zero();
    int count = 0;
    for (std::size_t k = 0; k < wrists[r].samples.size(); ++k) {
      if (training_only && !is_training(r, k)) continue;
      const sensing::MotionSample& sample = wrists[r].samples[k];
      sum += (sample.F_S - sensing::load_wrench(payload, sample.motion)).vector();
      ++count;
    }
    math::Wrench mean;
    if (count > 0) mean = math::Wrench::from(sum / count);
    return mean;
  };
  constexpr int kTurns = 30;
  for (int turn = 0; turn < kTurns; ++turn) {
    std::vector<sensing::MotionSample> samples;
    for (std::size_t r = 0; r < wrists.size(); ++r)
      for (std::size_t k = 0; k < wrists[r].samples.size(); ++k) {
        if (!is_training(r, k)) continue;
        samples.push_back(wrists[r].samples[k]);
        samples.back().F_S = samples.back().F_S - bias[r];
      }
    payload = sensing::identify_motion(samples).parameters;
    payload.bias = {};
    for (std::size_t r = 0; r < wrists.size(); ++r) bias[r] = mean_rest(r, true);
  }
  data.payload = payload;
  data.delays = wrists.front().delays;

  for (std::size_t r = 0; r < wrists.size(); ++r) {
    Recording& recording = data.recordings[r];
    const std::vector<sensing::MotionSample>& samples = wrists[r].samples;
    const bool trains = std::find(recording.parts.begin(), recording.parts.end(),
                                  Part::kTraining) != recording.parts.end();
    if (!trains) bias[r] = mean_rest(r, false);
    const auto n = static_cast<Eigen::Index>(samples.size());
    recording.inputs.resize(n, static_cast<Eigen::Index>(columns.size()));
    recording.outputs.resize(n, 6);
    recording.analytic.setZero(n, 6);
    for (Eigen::Index k = 0; k < n; ++k) {
      for (std::size_t i = 0; i < columns.size(); ++i)
        recording.inputs(k, static_cast<Eigen::Index>(i)) = wrists[r].inputs(k, columns[i]);
      const sensing::MotionSample& sample = samples[k];
      const math::Wrench target = sample.F_S - bias[r];
      const math::Wrench explained = sensing::load_wrench(payload, sample.motion);
      if (plan.target == Target::kResidual) {
        recording.outputs.row(k) = (target - explained).vector().transpose();
      } else {
        recording.outputs.row(k) = target.vector().transpose();
        recording.analytic.row(k) = explained.vector().transpose();
      }
    }
  }
}

}  // namespace palpate::train

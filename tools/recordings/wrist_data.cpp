#include "tools/recordings/wrist_data.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/sensing/recurrent_observer_inputs.hpp"

namespace palpate::recordings {
namespace {

// Indices in the rows of wrist_columns().
constexpr int kQuaternion = 0, kVelocity = 4, kRate = 7, kAcceleration = 10, kForce = 13;
constexpr int kPosition = 19;  // if there is one
constexpr int kPoseColumns = 7, kInertialColumns = 6, kWrenchColumns = 6;
const Eigen::Vector3d kGravity(0, 0, -9.81);  // m/s^2, in W

Eigen::Matrix3d rotation(const Eigen::RowVectorXd& row) {
  const Eigen::Quaterniond q(row[0], row[1], row[2], row[3]);
  if (!(q.norm() > 0.5)) throw std::runtime_error("a quaternion is far from unit length");
  return q.normalized().toRotationMatrix();
}

/// Angular velocity in S from neighbouring orientations, rad/s.
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

/// Band-pass that removes everything slower than a second (drift, creep, hysteresis) or faster than
/// a few hundredths (noise): both signals of a comparison are filtered equally.
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
  // A payload of one kilogram with the motion of the inertial unit and the orientation of the pose.
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
  if (!columns.position.empty()) delay_columns(table, kPosition, 3, latest);
  delay_columns(table, kRate, kInertialColumns, latest - inertial);
  delay_columns(table, kForce, kWrenchColumns, latest - wrench);
  return {{"inertial", inertial}, {"force_torque", wrench}};
}

Eigen::Index row(std::size_t k) { return static_cast<Eigen::Index>(k); }

std::vector<std::size_t> training_rows(const Recording& recording) {
  std::vector<std::size_t> rows;
  for (std::size_t k = 0; k < recording.parts.size(); ++k)
    if (recording.parts[k] == Part::kTraining) rows.push_back(k);
  return rows;
}

/// Unloaded reading of a sensor along one recording, N and N m.
struct Bias {
  math::Vector6d mean = math::Vector6d::Zero();
  math::Vector6d slope = math::Vector6d::Zero();  // per s
  double centre = 0;                              // s, time to which the mean refers

  math::Vector6d at(double t) const { return mean + (t - centre) * slope; }
};

/// For each recording with training rows: the mean residual of a payload and, if the plan lets an
/// output drift, its slope. Input dependence is separated from the drift by a linear map shared by
/// all recordings (Frisch, Waugh and Lovell: both sides without their means and slopes, recording
/// by recording).
std::vector<Bias> fit_biases(const DataPlan& plan, const std::vector<WristRecording>& wrists,
                             const DataSet& data, const sensing::PayloadParameters& payload) {
  constexpr double kPenalty = 1e-2;  // of the shared map, per row of standardised inputs
  const std::vector<std::string> outputs = columns_of(plan.outputs);
  const auto width = static_cast<Eigen::Index>(columns_of(plan.inputs).size());
  std::vector<Bias> biases(wrists.size());
  std::vector<Eigen::VectorXd> times(wrists.size());
  std::vector<Eigen::MatrixXd> inputs(wrists.size()), rests(wrists.size());
  Eigen::MatrixXd xx = Eigen::MatrixXd::Zero(width, width), xy = Eigen::MatrixXd::Zero(width, 6);
  Eigen::VectorXd spread = Eigen::VectorXd::Zero(width);
  double count = 0;
  for (std::size_t r = 0; r < wrists.size(); ++r) {
    const std::vector<std::size_t> rows = training_rows(data.recordings[r]);
    if (rows.empty()) continue;
    Eigen::VectorXd& t = times[r];
    Eigen::MatrixXd &x = inputs[r], &y = rests[r];
    t.resize(row(rows.size()));
    x.resize(t.size(), width);
    y.resize(t.size(), 6);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const sensing::MotionSample& sample = wrists[r].samples[rows[i]];
      t[row(i)] = wrists[r].time[row(rows[i])];
      x.row(row(i)) = data.recordings[r].inputs.row(row(rows[i]));
      y.row(row(i)) =
          (sample.F_S.vector() - sensing::load_wrench(payload, sample.motion).vector()).transpose();
    }
    biases[r].centre = t.mean();
    biases[r].mean = y.colwise().mean().transpose();
    t.array() -= t.mean();
    x.rowwise() -= x.colwise().mean().eval();
    y.rowwise() -= y.colwise().mean().eval();
    spread += x.colwise().squaredNorm().transpose();
    count += static_cast<double>(rows.size());
    const auto without_slope = [&t](const Eigen::MatrixXd& m) -> Eigen::MatrixXd {
      return m - t * (t.transpose() * m) / std::max(t.squaredNorm(), 1e-12);
    };
    const Eigen::MatrixXd level = without_slope(x);
    xx += level.transpose() * level;
    xy += level.transpose() * y;
  }
  if (plan.wrist.drifting.empty() || count == 0) return biases;
  const Eigen::VectorXd floor = (spread * kPenalty).cwiseMax(1e-12);
  const Eigen::MatrixXd map = (xx + Eigen::MatrixXd(floor.asDiagonal())).ldlt().solve(xy);
  for (std::size_t r = 0; r < wrists.size(); ++r) {
    if (times[r].size() < 2) continue;
    const Eigen::RowVectorXd slope = times[r].transpose() * (rests[r] - inputs[r] * map) /
                                     std::max(times[r].squaredNorm(), 1e-12);
    for (Eigen::Index i = 0; i < 6; ++i)
      if (std::find(plan.wrist.drifting.begin(), plan.wrist.drifting.end(), outputs[i]) !=
          plan.wrist.drifting.end())
        biases[r].slope[i] = slope[i];
  }
  return biases;
}

}  // namespace

DelayFit identify_delay(const Eigen::MatrixXd& reference, const Eigen::MatrixXd& signal,
                        double rate, double largest) {
  const Eigen::Index n = reference.rows();
  const auto span = static_cast<Eigen::Index>(std::llround(largest * rate));
  if (signal.rows() != n || signal.cols() != reference.cols())
    throw std::invalid_argument("delay: the recordings differ in size");
  if (n < 4 * span + 4)
    throw std::invalid_argument("delay: the recordings are too short for the largest delay");

  // The same rows of the reference at each delay, so that the correlations are comparable.
  const Eigen::MatrixXd still = reference.middleRows(span, n - 2 * span);
  const Eigen::MatrixXd still_centred = still.rowwise() - still.colwise().mean();
  const auto correlation = [&](Eigen::Index delay) {
    const Eigen::MatrixXd moved = signal.middleRows(span + delay, n - 2 * span);
    const Eigen::MatrixXd centred = moved.rowwise() - moved.colwise().mean();
    const double size = still_centred.norm() * centred.norm();
    return size > 0 ? still_centred.cwiseProduct(centred).sum() / size : 0;
  };
  Eigen::Index best = 0;
  double best_value = correlation(0);
  for (Eigen::Index delay = -span; delay <= span; ++delay) {
    const double value = correlation(delay);
    if (value > best_value) {
      best = delay;
      best_value = value;
    }
  }
  DelayFit fit{static_cast<double>(best) / rate, best_value};
  if (best == -span || best == span) return fit;
  const double before = correlation(best - 1);
  const double after = correlation(best + 1);
  const double curvature = before - 2 * best_value + after;
  if (curvature < 0) fit.seconds += 0.5 * (before - after) / curvature / rate;
  return fit;
}

std::vector<std::string> wrist_columns(const WristColumns& columns) {
  std::vector<std::string> list;
  for (const auto* part :
       {&columns.quaternion, &columns.velocity, &columns.rate, &columns.acceleration,
        &columns.force, &columns.torque, &columns.position})
    list.insert(list.end(), part->begin(), part->end());
  return list;
}

WristRecording load_wrist(const DataPlan& plan, const Table& raw) {
  const double raw_rate = static_cast<double>(raw.time.size() - 1) / raw.time[raw.time.size() - 1];
  WristRecording recording;
  Table table = raw;
  // On a uniform grid, quaternions with continuous sign, so that they may be averaged.
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
    math::Pose X_WS = math::Pose::Identity();
    X_WS.linear() = R_WS;
    if (!plan.wrist.position.empty()) X_WS.translation() = row.segment<3>(kPosition).transpose();
    const sensing::ObserverInputs inputs = sensing::observer_inputs(
        X_WS, row.segment<3>(kVelocity).transpose(), sample.motion, kGravity, quaternion);
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
  for (std::size_t r = 0; r < wrists.size(); ++r) {
    Eigen::MatrixXd& inputs = data.recordings[r].inputs;
    inputs.resize(wrists[r].inputs.rows(), static_cast<Eigen::Index>(columns.size()));
    for (std::size_t i = 0; i < columns.size(); ++i)
      inputs.col(static_cast<Eigen::Index>(i)) = wrists[r].inputs.col(columns[i]);
  }

  const auto mean_rest = [&](const sensing::PayloadParameters& payload, std::size_t r) {
    math::Vector6d sum = math::Vector6d::Zero();
    for (const sensing::MotionSample& sample : wrists[r].samples)
      sum += sample.F_S.vector() - sensing::load_wrench(payload, sample.motion).vector();
    return math::Vector6d(sum / std::max<double>(1, static_cast<double>(wrists[r].samples.size())));
  };
  // One payload, and a bias for each recording: alternating identification of both, which converges
  // to the joint least squares.
  std::vector<Bias> biases(wrists.size());
  sensing::PayloadParameters payload;
  constexpr int kTurns = 30;
  for (int turn = 0; turn < kTurns; ++turn) {
    std::vector<sensing::MotionSample> samples;
    for (std::size_t r = 0; r < wrists.size(); ++r)
      for (const std::size_t k : training_rows(data.recordings[r])) {
        samples.push_back(wrists[r].samples[k]);
        samples.back().F_S =
            math::Wrench::from(samples.back().F_S.vector() - biases[r].at(wrists[r].time[row(k)]));
      }
    payload = sensing::identify_payload(samples).parameters;
    payload.bias = {};
    biases = fit_biases(plan, wrists, data, payload);
  }
  data.payload = payload;
  data.delays = wrists.front().delays;

  for (std::size_t r = 0; r < wrists.size(); ++r) {
    Recording& recording = data.recordings[r];
    const std::vector<sensing::MotionSample>& samples = wrists[r].samples;
    if (training_rows(recording).empty()) biases[r].mean = mean_rest(payload, r);
    const auto n = static_cast<Eigen::Index>(samples.size());
    recording.outputs.resize(n, 6);
    recording.analytic.setZero(n, 6);
    for (std::size_t k = 0; k < samples.size(); ++k) {
      // In scored rows the drift is kept: it could not be removed in operation.
      const math::Vector6d bias = recording.parts[k] == Part::kTraining
                                      ? biases[r].at(wrists[r].time[row(k)])
                                      : biases[r].mean;
      const math::Vector6d target = samples[k].F_S.vector() - bias;
      const math::Vector6d explained = sensing::load_wrench(payload, samples[k].motion).vector();
      if (plan.target == Target::kResidual) {
        recording.outputs.row(row(k)) = (target - explained).transpose();
      } else {
        recording.outputs.row(row(k)) = target.transpose();
        recording.analytic.row(row(k)) = explained.transpose();
      }
    }
  }
}

}  // namespace palpate::recordings

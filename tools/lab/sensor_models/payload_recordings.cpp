#include "tools/lab/sensor_models/payload.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/math/constants.hpp"
#include "tools/recordings/csv_reader.hpp"

namespace palpate::sensor_models {
namespace {

using recordings::CsvReader;
using sensing::StaticPose;

using math::kDegree;
const Eigen::Vector3d kGravity(0, 0, -9.81);
/// Local gravity at the place where ft_imu_kuka_ntnu was recorded, m/s^2.
constexpr double kNtnuGravity = 9.82085;

Eigen::Vector3d vector(const CsvReader& csv, const char* x, const char* y, const char* z) {
  return {csv.number(csv.column(x)), csv.number(csv.column(y)), csv.number(csv.column(z))};
}

math::Wrench wrench(const CsvReader& csv) {
  return {vector(csv, "fx", "fy", "fz"), vector(csv, "tx", "ty", "tz")};
}

Eigen::Matrix3d rotation(const CsvReader& csv) {
  Eigen::Matrix3d R;
  R.row(0) = vector(csv, "r11", "r12", "r13");
  R.row(1) = vector(csv, "r21", "r22", "r23");
  R.row(2) = vector(csv, "r31", "r32", "r33");
  return R;
}

/// Parameters that a static recording cannot identify besides payload and bias.
struct Unknowns {
  bool gravity_direction = false;
  bool bias_drift = false;
};

struct StaticFit {
  Eigen::Vector3d gravity;
  sensing::PayloadFit fit;
};

StaticFit fit_static(const std::vector<StaticPose>& poses, const Eigen::Vector3d& given,
                     Unknowns unknowns) {
  StaticFit result;
  result.gravity = given;
  if (unknowns.gravity_direction)
    result.gravity = given.norm() * sensing::estimate_gravity_direction(poses);
  sensing::IdentificationOptions options;
  options.bias_drifts = unknowns.bias_drift;
  result.fit = sensing::identify_static(poses, result.gravity, options);
  return result;
}

template <class Sample>
void reverse(std::vector<Sample>& samples) {
  for (Sample& sample : samples) sample.F_S = {-sample.F_S.force, -sample.F_S.torque};
}

/// Fits, inverting the sign of the readings if they would give a negative mass.
PayloadScore score_static(const std::string& name, std::vector<StaticPose> poses,
                          const Eigen::Vector3d& gravity, Unknowns unknowns) {
  PayloadScore score;
  score.recording = name;
  score.reversed = sensing::identify_static(poses, gravity).parameters.mass < 0;
  if (score.reversed) reverse(poses);
  const StaticFit all = fit_static(poses, gravity, unknowns);
  score.fit = all.fit;
  score.gravity_tilt =
      std::acos(std::clamp(all.gravity.dot(gravity) / gravity.squaredNorm(), -1.0, 1.0));
  double force = 0, torque = 0;
  for (std::size_t left_out = 0; left_out < poses.size(); ++left_out) {
    std::vector<StaticPose> rest = poses;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(left_out));
    const StaticPose& pose = poses[left_out];
    const StaticFit fitted = fit_static(rest, gravity, unknowns);
    const math::Wrench explained = sensing::load_wrench(
        fitted.fit.parameters, sensing::motion_at_rest(pose.R_WS, fitted.gravity));
    const math::Wrench& drift = fitted.fit.bias_drift;
    force += (pose.F_S.force - explained.force - pose.time * drift.force).squaredNorm();
    torque += (pose.F_S.torque - explained.torque - pose.time * drift.torque).squaredNorm();
  }
  score.left_out_force = std::sqrt(force / static_cast<double>(poses.size()));
  score.left_out_torque = std::sqrt(torque / static_cast<double>(poses.size()));
  return score;
}

PayloadScore score_motion(const std::string& name, std::vector<sensing::MotionSample> samples) {
  PayloadScore score;
  score.recording = name;
  score.fit = sensing::identify_motion(samples);
  score.reversed = score.fit.parameters.mass < 0;
  if (score.reversed) {
    reverse(samples);
    score.fit = sensing::identify_motion(samples);
  }
  return score;
}

void set_bar(PayloadScore& score, double bar, bool per_axis) {
  score.force_bar = bar;
  score.bar_per_axis = per_axis;
  score.measured = per_axis ? score.fit.residual_rms.head<3>().maxCoeff() : score.fit.force_rms;
}

/// One recorded signal over time, s.
struct Series {
  std::vector<double> time;
  std::vector<Eigen::VectorXd> value;

  /// Mean over [from, to); the nearest sample if none lies in it.
  Eigen::VectorXd mean(double from, double to) const {
    const auto begin = std::lower_bound(time.begin(), time.end(), from) - time.begin();
    const auto end = std::lower_bound(time.begin(), time.end(), to) - time.begin();
    if (begin == end) return value[std::min<std::size_t>(begin, value.size() - 1)];
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(value.front().size());
    for (auto i = begin; i < end; ++i) sum += value[i];
    return sum / static_cast<double>(end - begin);
  }
};

template <class Read>
Series read_series(const std::filesystem::path& file, double origin_us, Read read) {
  CsvReader csv(file.string());
  const int t = csv.column("t");
  Series series;
  while (csv.next()) {
    series.time.push_back(1e-6 * (csv.number(t) - origin_us));
    series.value.push_back(read(csv));
  }
  if (series.time.size() < 2) throw std::runtime_error(file.string() + ": too few rows");
  return series;
}

/// Rotation between the inertial unit's axes and the sensor's, by the data set's own description:
/// specific force (x, y, z) in S is (-ay, az, -ax) of the unit.
Eigen::Vector3d to_sensor_axes(const Eigen::Vector3d& a_I) { return {-a_I.y(), a_I.z(), -a_I.x()}; }

/// Constant error of the accelerometer, in S, from the static poses.
Eigen::Vector3d accelerometer_offset(const std::filesystem::path& folder) {
  CsvReader csv((folder / "0-calibration_fts-accel.csv").string());
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  while (csv.next()) {
    sum += kNtnuGravity * to_sensor_axes(vector(csv, "ax", "ay", "az")) +
           vector(csv, "gx", "gy", "gz");
    ++count;
  }
  if (count == 0) throw std::runtime_error("no static pose in " + folder.string());
  return sum / count;
}

std::vector<sensing::MotionSample> ntnu_motion(const std::filesystem::path& data, bool use_imu) {
  constexpr double kWindow = 0.1;  // s
  constexpr double kStep = 0.01;   // s, that of the slowest stream
  const std::filesystem::path folder = data / "ft_imu_kuka_ntnu";
  double origin = 0;
  {
    CsvReader first((folder / "1-baseline_wrench.csv").string());
    if (!first.next()) first.fail("no row");
    origin = first.number(first.column("t"));
  }
  const Series wrenches =
      read_series(folder / "1-baseline_wrench.csv", origin,
                  [](const CsvReader& csv) -> Eigen::VectorXd { return wrench(csv).vector(); });
  const Series accelerations = read_series(
      folder / "1-baseline_accel.csv", origin, [](const CsvReader& csv) -> Eigen::VectorXd {
        return kNtnuGravity * to_sensor_axes(vector(csv, "ax", "ay", "az"));
      });
  const Series rotations = read_series(folder / "1-baseline_orientations.csv", origin,
                                       [](const CsvReader& csv) -> Eigen::VectorXd {
                                         const Eigen::Matrix3d R = rotation(csv);
                                         return Eigen::Map<const Eigen::VectorXd>(R.data(), 9);
                                       });
  const Eigen::Vector3d offset = accelerometer_offset(folder);

  const auto rotation_at = [&](double t) -> Eigen::Matrix3d {
    const Eigen::VectorXd mean = rotations.mean(t - kWindow / 2, t + kWindow / 2);
    const Eigen::Matrix3d R = Eigen::Map<const Eigen::Matrix3d>(mean.data());
    return Eigen::Quaterniond(R).normalized().toRotationMatrix();
  };
  const auto omega_S = [&](double t) -> Eigen::Vector3d {
    return math::log_rotation(rotation_at(t - kWindow / 2).transpose() *
                              rotation_at(t + kWindow / 2)) /
           kWindow;
  };

  std::vector<sensing::MotionSample> samples;
  const double end =
      std::min({wrenches.time.back(), accelerations.time.back(), rotations.time.back()}) - 0.2;
  for (double t = 0.2; t < end; t += kStep) {
    sensing::MotionSample sample;
    sample.F_S = math::Wrench::from(wrenches.mean(t - kWindow / 2, t + kWindow / 2));
    sample.motion = sensing::motion_at_rest(rotation_at(t), {0, 0, -kNtnuGravity});
    if (use_imu) {
      sample.motion.specific_force = accelerations.mean(t - kWindow / 2, t + kWindow / 2) - offset;
      sample.motion.angular_velocity = omega_S(t);
      sample.motion.angular_acceleration =
          (omega_S(t + kWindow / 2) - omega_S(t - kWindow / 2)) / kWindow;
    }
    samples.push_back(sample);
  }
  return samples;
}

PayloadScore score_ati(const std::string& name, const std::filesystem::path& data,
                       Unknowns unknowns) {
  CsvReader csv((data / "ft_static_ati/static_poses_60.csv").string());
  std::vector<StaticPose> poses;
  while (csv.next()) {
    const Eigen::Vector3d xyz = vector(csv, "qx", "qy", "qz");
    const double wxyz[4] = {csv.number(csv.column("qw")), xyz.x(), xyz.y(), xyz.z()};
    if (!math::is_unit_quaternion(wxyz)) csv.fail("the quaternion is not of unit length");
    StaticPose pose;
    pose.R_WS = math::rotation_from_wxyz(wxyz);
    // Recorded in the base's axes, though about the sensor's origin.
    pose.F_S.force = pose.R_WS.transpose() * vector(csv, "fx_base", "fy_base", "fz_base");
    pose.F_S.torque = pose.R_WS.transpose() * vector(csv, "tx_base", "ty_base", "tz_base");
    pose.time = static_cast<double>(poses.size());
    poses.push_back(pose);
  }
  return score_static(name, poses, kGravity, unknowns);
}

}  // namespace

PayloadScore score_static_ati(const std::filesystem::path& data) {
  Unknowns unknowns;
  unknowns.bias_drift = true;
  PayloadScore score = score_ati("ft_static_ati", data, unknowns);
  set_bar(score, 0.55, false);
  return score;
}

PayloadScore score_static_ati_constant_bias(const std::filesystem::path& data) {
  return score_ati("  the same, constant bias", data, {});
}

PayloadScore score_static_meca500(const std::filesystem::path& data) {
  struct Joint {
    double alpha, a, theta, d;  // modified Denavit-Hartenberg
  };
  constexpr Joint kJoints[6] = {{0, 0, 0, 0.135},    {-M_PI / 2, 0, -M_PI / 2, 0},
                                {0, 0.135, 0, 0},    {-M_PI / 2, 0.038, 0, 0.120},
                                {M_PI / 2, 0, 0, 0}, {-M_PI / 2, 0, M_PI, 0.070}};
  CsvReader csv((data / "ft_static_meca500/poses_11.csv").string());
  std::vector<StaticPose> poses;
  while (csv.next()) {
    StaticPose pose;
    for (int j = 0; j < 6; ++j) {
      const double q = csv.number(csv.column("q" + std::to_string(j + 1) + "_deg")) * kDegree;
      pose.R_WS = pose.R_WS * math::exp_rotation({kJoints[j].alpha, 0, 0}) *
                  math::exp_rotation({0, 0, q + kJoints[j].theta});
    }
    pose.R_WS = pose.R_WS * math::exp_rotation({0, 0, M_PI});  // flange to sensor
    pose.F_S = wrench(csv);
    poses.push_back(pose);
  }
  Unknowns unknowns;
  unknowns.gravity_direction = true;
  PayloadScore score = score_static("ft_static_meca500", poses, kGravity, unknowns);
  set_bar(score, 0.09, false);
  return score;
}

PayloadScore score_static_ntnu(const std::filesystem::path& data) {
  CsvReader csv((data / "ft_imu_kuka_ntnu/0-calibration_fts-accel.csv").string());
  std::vector<StaticPose> poses;
  while (csv.next()) poses.push_back({rotation(csv), wrench(csv)});
  PayloadScore score =
      score_static("ft_imu_kuka_ntnu static", poses, {0, 0, -kNtnuGravity}, Unknowns{});
  set_bar(score, 0.15, true);
  return score;
}

PayloadScore score_motion_ntnu(const std::filesystem::path& data) {
  return score_motion("ft_imu_kuka_ntnu motion", ntnu_motion(data, true));
}

PayloadScore score_motion_ntnu_gravity(const std::filesystem::path& data) {
  return score_motion("  the same, gravity only", ntnu_motion(data, false));
}

}  // namespace palpate::sensor_models

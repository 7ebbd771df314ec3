#include <gtest/gtest.h>

#ifndef PALPATE_WITHOUT_TORCH

#include <unistd.h>

#include <iostream>
#include <random>

#include "core/math/rigid.hpp"
#include "core/sensing/ft_newton_euler.hpp"
#include "core/sensing/recurrent_network.hpp"
#include "core/sensing/recurrent_observer_inputs.hpp"
#include "rt/inference/model_file.hpp"
#include "tests/support/recordings.hpp"
#include "tools/lab/sensor_models/sensors.hpp"
#include "tools/lab/sensor_models/sensors_models.hpp"
#include "tools/lab/sensor_models/sensors_stream.hpp"
#include "tools/recordings/wrist_data.hpp"

namespace palpate::sensor_models {
namespace {

constexpr double kDegree = M_PI / 180;

SensorTraining usual_training(SensorKind kind) {
  return training_of(plan_of(kind).data, support::recordings(), false);
}

/// Baselines on one folder of real recordings, fitted with the split of the kind's preset.
std::vector<SensorComparison> real_baselines(SensorKind kind, const std::string& folder) {
  std::map<std::string, std::vector<SensorTrack>> files;
  std::vector<SensorTrack> all;
  for (const SensorRecording& recording :
       read_sensor_folder(support::recordings() / folder).recordings) {
    if (recording.kind != kind) continue;
    all.push_back(make_track(recording));
    files[recording.file].push_back(all.back());
  }
  const SensorTraining training = usual_training(kind);
  const std::vector<SensorMethod> methods = make_baselines(kind, training, all);
  std::vector<SensorComparison> comparisons;
  for (const auto& [file, tracks] : files)
    comparisons.push_back(compare_sensors(tracks, training, methods));
  return comparisons;
}

const SensorScore& named(const SensorComparison& comparison, const std::string& method) {
  return *std::find_if(comparison.scores.begin(), comparison.scores.end(),
                       [&](const SensorScore& score) { return score.method == method; });
}

TEST(RealFingertips, BaselinesAreWhereTheyShouldBe) {
  PALPATE_REQUIRE_RECORDING("biotac_foam_bar");
  PALPATE_REQUIRE_RECORDING("biotac_normal_dir");
  const auto force = real_baselines(SensorKind::kForce, "biotac_foam_bar");
  ASSERT_EQ(force.size(), 1u);
  EXPECT_EQ(force[0].origin, "unseen blocks");
  EXPECT_LT(named(force[0], "ridge").errors.norms[0], 0.02);
  const auto direction = real_baselines(SensorKind::kDirection, "biotac_normal_dir");
  ASSERT_EQ(direction.size(), 2u);
  EXPECT_EQ(direction[0].origin, "unseen");  // short logs
  const SensorComparison& trial = direction[1];
  const double nominal = named(trial, "localised: centroid, nominal").errors.median_angle[0];
  EXPECT_LT(nominal, 10 * kDegree);
  EXPECT_LT(named(trial, "ridge").errors.median_angle[0], nominal);
  EXPECT_GT(named(trial, "mean").errors.median_angle[0], 15 * kDegree);
}

TEST(RealWrist, StreamsThroughTheComponentAsItWasTrained) {
  PALPATE_REQUIRE_RECORDING("ft_imu_panda");
  const auto comparisons = real_baselines(SensorKind::kWrist, "ft_imu_panda");
  ASSERT_EQ(comparisons.size(), 2u);
  EXPECT_EQ(comparisons[0].origin, "unseen blocks");
  EXPECT_EQ(comparisons[1].origin, "unseen blocks");
  const double with_motion = named(comparisons[1], "newton_euler, inertial unit").errors.norms[0];
  EXPECT_LT(with_motion, named(comparisons[1], "newton_euler, gravity only").errors.norms[0]);
  EXPECT_LT(with_motion, 0.25 * named(comparisons[1], "tare only").errors.norms[0]);

  // A network of random weights in parallel with a payload, with its own streams' delays.
  const SensorTrack track =
      make_track(read_sensor_folder(support::recordings() / "ft_imu_panda").recordings.at(0));
  const recordings::DataPlan& plan = plan_of(SensorKind::kWrist).data;
  inference::ModelCard card;
  card.name = "random";
  card.rate = plan.rate;
  card.average = plan.average;
  std::vector<int> places;
  for (const std::string& name : recordings::columns_of(plan.inputs)) {
    places.push_back(sensing::observer_input_index(name));
    card.inputs.push_back({name, sensing::observer_input_unit(places.back())});
  }
  for (const char* name : {"fx", "fy", "fz"}) card.outputs.push_back({name, "N"});
  for (const char* name : {"tx", "ty", "tz"}) card.outputs.push_back({name, "N m"});
  card.payload = sensing::PayloadParameters{};
  card.payload->mass = 1.15;
  card.payload->first_moment = {0, 0.004, 0.12};
  card.delays = recordings::load_wrist(plan, track.recording.table).delays;
  std::mt19937 random(2);
  std::normal_distribution<float> normal(0, 0.4f);
  auto weights = sensing::RecurrentWeights::zero(static_cast<int>(places.size()), 6, {15, 10});
  for (sensing::LstmWeights& layer : weights.layers)
    for (auto* part : {&layer.input, &layer.hidden})
      for (Eigen::Index i = 0; i < part->size(); ++i) part->data()[i] = normal(random);
  for (Eigen::Index i = 0; i < weights.dense.size(); ++i) weights.dense.data()[i] = normal(random);
  const std::string path = (std::filesystem::temp_directory_path() /
                            ("palpate-wrist-" + std::to_string(getpid()) + ".pt"))
                               .string();
  inference::write_model_file(path, weights, card);
  const Eigen::MatrixXd streamed =
      make_methods(read_sensor_model(path), "compiled").at(0).answer(track);
  std::filesystem::remove(path);
  std::filesystem::remove(inference::card_path(path));

  sensing::RecurrentNetwork network(weights);
  std::vector<float> state(network.states(), 0.f), input(places.size());
  Eigen::Matrix<float, 6, 1> output;
  double largest = 0;
  for (Eigen::Index k = 0; k + 1 < streamed.rows(); ++k) {
    for (std::size_t i = 0; i < places.size(); ++i)
      input[i] = static_cast<float>(track.input(k, places[i]));
    network.step(input.data(), state.data(), output.data());
    const math::Vector6d expected =
        sensing::load_wrench(*card.payload, track.samples[static_cast<std::size_t>(k)].motion)
            .vector() +
        output.cast<double>();
    largest = std::max(largest, (streamed.row(k).transpose() - expected).cwiseAbs().maxCoeff());
  }
  // Means of gravity in rotating axes differ slightly from gravity in mean axes.
  EXPECT_LT(largest, 2e-3);
}

/// Difference between a moving wrist's accelerometer and the robot's own motion data, in S, n x 3,
/// m/s^2, without the effect of the lever from the robot's point to the accelerometer.
struct WristMotion {
  explicit WristMotion(const SensorTrack& track) {
    const auto columns = [&](const char* first) {
      return Eigen::MatrixX3d(track.input.middleCols<3>(sensing::observer_input_index(first)));
    };
    const Eigen::MatrixX3d gravity = columns("gravity_x"), rate = columns("rate_S_x"),
                           change = columns("rate_change_S_x"), velocity = columns("velocity_x"),
                           orientation = columns("orientation_x");
    acceleration = columns("acceleration_x") + 9.81 * gravity;
    const Eigen::Index n = acceleration.rows();
    const int w = sensing::observer_input_index("orientation_w");
    Eigen::MatrixXd by_lever = Eigen::MatrixXd::Zero(3 * n, 6);
    Eigen::VectorXd beyond = Eigen::VectorXd::Zero(3 * n);
    for (Eigen::Index k = 0; k < n; ++k) {
      const Eigen::Quaterniond q(track.input(k, w), orientation(k, 0), orientation(k, 1),
                                 orientation(k, 2));
      velocities.push_back(
          {track.time[k], velocity.row(k).transpose(), q.normalized().toRotationMatrix()});
      const Eigen::Matrix3d cross = math::cross_matrix(rate.row(k).transpose());
      by_lever.middleRows<3>(3 * k).leftCols<3>() =
          math::cross_matrix(change.row(k).transpose()) + cross * cross;
      by_lever.middleRows<3>(3 * k).rightCols<3>().setIdentity();
      if (k == 0) continue;
      const double dt = track.time[k] - track.time[k - 1];
      beyond.segment<3>(3 * k) = acceleration.row(k).transpose() -
                                 velocities.back().R_WS.transpose() *
                                     (velocity.row(k) - velocity.row(k - 1)).transpose() / dt;
    }
    const Eigen::VectorXd found = by_lever.colPivHouseholderQr().solve(beyond);
    for (Eigen::Index k = 0; k < n; ++k)
      acceleration.row(k) -=
          (by_lever.middleRows<3>(3 * k).leftCols<3>() * found.head<3>()).transpose();
    offset_S = found.tail<3>();
  }

  /// RMS over the first second from row `begin`, m/s^2, of the offset that is tracked from there.
  double error(Eigen::Index begin, bool by_velocity) const {
    sensing::AccelerometerOffset offset(5);
    double sum = 0;
    int count = 0;
    for (std::size_t k = static_cast<std::size_t>(begin); k + 1 < velocities.size(); ++k) {
      sensing::AccelerometerOffset::Velocity velocity = velocities[k];
      const double since = velocity.time - velocities[static_cast<std::size_t>(begin)].time;
      if (since > 1) break;
      if (!by_velocity) velocity.linear.setZero();
      const double step = velocities[k + 1].time - velocity.time;
      offset.follow(acceleration.row(static_cast<Eigen::Index>(k)).transpose(), step, velocity);
      if (since < 0.1) continue;
      sum += (offset.value_S() - offset_S).squaredNorm();
      ++count;
    }
    return std::sqrt(sum / count);
  }

  std::vector<sensing::AccelerometerOffset::Velocity> velocities;
  Eigen::MatrixX3d acceleration;
  Eigen::Vector3d offset_S;
};

TEST(RealWrist, TheRobotsVelocityDistinguishesMotionFromAnOffset) {
  PALPATE_REQUIRE_RECORDING("ft_imu_panda");
  double plain = 0, by_velocity = 0;
  int count = 0;
  for (const SensorRecording& recording :
       read_sensor_folder(support::recordings() / "ft_imu_panda").recordings) {
    const WristMotion motion(make_track(recording));
    const Eigen::Index n = motion.acceleration.rows();
    for (Eigen::Index begin = 0; begin < n * 3 / 4; begin += n / 8, ++count) {
      plain += motion.error(begin, false);
      by_velocity += motion.error(begin, true);
    }
  }
  std::cout << "offset off in the first second after a start in motion: plain mean "
            << plain / count << " m/s^2, by the robot's velocity " << by_velocity / count << "\n";
  ASSERT_GT(count, 8);
  EXPECT_LT(by_velocity, 0.6 * plain);
}

}  // namespace
}  // namespace palpate::sensor_models

#endif

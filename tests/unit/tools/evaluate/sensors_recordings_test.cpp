#include <gtest/gtest.h>

#ifndef PALPATE_WITHOUT_TORCH

#include <unistd.h>

#include <random>

#include "core/sensing/recurrent_network.hpp"
#include "core/sensing/recurrent_observer_inputs.hpp"
#include "rt/inference/model_file.hpp"
#include "tests/support/recordings.hpp"
#include "tools/evaluate/sensors.hpp"
#include "tools/evaluate/sensors_models.hpp"
#include "tools/evaluate/sensors_stream.hpp"
#include "tools/train/wrist_data.hpp"

namespace palpate::evaluate {
namespace {

constexpr double kDegree = M_PI / 180;

SensorTraining usual_training(SensorKind kind) {
  return training_of(plan_of(kind).data, support::recordings(), false);
}

/// Baselines on one folder of real recordings, fitted as the kind's preset splits it.
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

  // A network of random weights beside a payload, by its own streams' delays.
  const SensorTrack track =
      make_track(read_sensor_folder(support::recordings() / "ft_imu_panda").recordings.at(0));
  const train::DataPlan& plan = plan_of(SensorKind::kWrist).data;
  inference::ModelCard card;
  card.name = "random";
  card.rate = plan.rate;
  card.average = plan.average;
  std::vector<int> places;
  for (const std::string& name : train::columns_of(plan.inputs)) {
    places.push_back(sensing::observer_input_index(name));
    card.inputs.push_back({name, sensing::observer_input_unit(places.back())});
  }
  for (const char* name : {"fx", "fy", "fz"}) card.outputs.push_back({name, "N"});
  for (const char* name : {"tx", "ty", "tz"}) card.outputs.push_back({name, "N m"});
  card.payload = sensing::PayloadParameters{};
  card.payload->mass = 1.15;
  card.payload->first_moment = {0, 0.004, 0.12};
  card.delays = train::load_wrist(plan, track.recording.table).delays;
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
  // Means of gravity in turning axes are not quite gravity in mean axes.
  EXPECT_LT(largest, 2e-3);
}

}  // namespace
}  // namespace palpate::evaluate

#endif

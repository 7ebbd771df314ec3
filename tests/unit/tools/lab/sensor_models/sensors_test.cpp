#include "tools/lab/sensor_models/sensors.hpp"

#ifndef PALPATE_WITHOUT_TORCH

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <fstream>
#include <random>
#include <sstream>

#include "core/sensing/linear_tactile.hpp"
#include "core/sensing/recurrent_network.hpp"
#include "core/sensing/recurrent_observer_inputs.hpp"
#include "rt/inference/model_file.hpp"
#include "tools/lab/sensor_models/sensors_models.hpp"
#include "tools/lab/sensor_models/sensors_report.hpp"
#include "tools/lab/sensor_models/sensors_stream.hpp"

namespace palpate::sensor_models {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kSensorsDegree = M_PI / 180;
const Eigen::Matrix3d kMount = math::exp_rotation({0.4, -2.9, 0.3});

/// A fingertip at rest for a second, then pressed at various points; forces are linear in the
/// counts, normals those of the skin in a rotated frame.
struct Press {
  double time;
  sensing::ElectrodeVector counts;
  double pdc;
  Eigen::Vector3d force, normal;
};

Eigen::Matrix3Xd force_map() {
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0, 2e-3);
  Eigen::Matrix3Xd map(3, sensing::kElectrodeCount);
  for (Eigen::Index i = 0; i < map.size(); ++i) map.data()[i] = normal(random);
  return map;
}

std::vector<Press> presses(double seconds, double polarity, const Eigen::Matrix3d& R_NT, int seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Eigen::Matrix3Xd map = force_map();
  std::vector<Press> list;
  Eigen::Vector3d direction(0, 0, -1);
  for (int k = 0; k < 100 * seconds; ++k) {
    if (k % 25 == 0)
      direction = Eigen::Vector3d(0.2 + 0.6 * std::abs(uniform(random)), 0.7 * uniform(random), -1)
                      .normalized();
    const Eigen::Vector3d place = sensing::kSkinRadius * direction;
    const double strength = k < 100 ? 0 : 100 + 80 * std::sin(0.25 * k);
    Press press;
    press.time = 0.01 * k;
    for (int i = 0; i < sensing::kElectrodeCount; ++i)
      press.counts[i] =
          std::round(polarity * strength *
                     std::exp(-(sensing::electrode_positions().col(i) - place).squaredNorm() /
                              (2 * 3e-3 * 3e-3)));
    press.pdc = std::round(strength);
    press.force = map * press.counts;
    press.normal = R_NT * direction;
    list.push_back(press);
  }
  return list;
}

class Sensors : public ::testing::Test {
 protected:
  Sensors()
      : root_(std::filesystem::temp_directory_path() /
              ("palpate-sensors-" + std::to_string(getpid()))) {
    std::filesystem::create_directories(train());
    std::filesystem::create_directories(held());
  }
  ~Sensors() override { std::filesystem::remove_all(root_); }

  std::filesystem::path train() const { return root_ / "train"; }
  std::filesystem::path held() const { return root_ / "held" / "other"; }

  static std::string electrode_names() {
    std::string names;
    for (int i = 1; i <= sensing::kElectrodeCount; ++i) names += ",e" + std::to_string(i);
    return names;
  }

  /// Force if `with_force`, otherwise direction, of recordings `labels` in sequence.
  static void write(const std::filesystem::path& file, const std::vector<Press>& list,
                    bool with_force, const std::vector<std::string>& labels = {"a"}) {
    std::ofstream out(file);
    out << "log,t,pdc" << electrode_names() << (with_force ? ",pac0,fx,fy,fz\n" : ",nx,ny,nz\n");
    for (const std::string& label : labels)
      for (const Press& press : list) {
        out << label << ',' << press.time << ',' << 2000 + press.pdc;
        for (const double count : press.counts) out << ',' << 3000 + count;
        if (with_force) out << ",2030";
        const Eigen::Vector3d truth =
            with_force ? press.force + Eigen::Vector3d(1, 2, 3) : press.normal;
        out << ',' << truth.x() << ',' << truth.y() << ',' << truth.z() << '\n';
      }
  }

  static SensorTrack track(const std::filesystem::path& folder) {
    return make_track(read_sensor_folder(folder).recordings.at(0));
  }

  /// A module that computes the linear map of the counts; its card names `training`.
  std::filesystem::path write_model(const YAML::Node& training) const {
    inference::ModelCard card;
    card.name = "exact";
    card.rate = 100;
    for (int i = 1; i <= sensing::kElectrodeCount; ++i)
      card.inputs.push_back({"e" + std::to_string(i), "count"});
    card.outputs = {{"fx", "N"}, {"fy", "N"}, {"fz", "N"}};
    card.training = training;
    sensing::RecurrentWeights weights =
        sensing::RecurrentWeights::zero(sensing::kElectrodeCount, 3, {2});
    weights.linear = force_map().cast<float>();
    const std::filesystem::path path = root_ / "exact.pt";
    inference::write_model_file(path.string(), weights, card);
    return path;
  }

  static const SensorScore& score_of(const SensorComparison& comparison, const std::string& method,
                                     SensorTare tare = SensorTare::kNone) {
    for (const SensorScore& score : comparison.scores)
      if (score.method == method && score.recording.empty() && score.tare == tare) return score;
    throw std::runtime_error("no score of " + method);
  }

  static std::vector<SensorScore> baselines(const std::filesystem::path& folder,
                                            const SensorTraining& training) {
    const std::vector<SensorTrack> tracks{track(folder)};
    return compare_sensors(tracks, training,
                           make_baselines(tracks[0].recording.kind, training, tracks))
        .scores;
  }

  std::filesystem::path root_;
};

TEST_F(Sensors, RecordingsAreFoundByTheirColumns) {
  const std::vector<Press> list = presses(3, 1, kMount, 1);
  write(held() / "force.csv", list, true);
  write(held() / "any name.csv", list, false, {"7", "9"});
  std::ofstream(held() / "other.csv") << "t,fx,fy,fz,qw\n0,1,2,3,4\n";
  std::ofstream(held() / "bad.csv") << "t,pdc,pac0" << electrode_names() << ",fx,fy,fz\n0,oops\n";
  const SensorFolder folder = read_sensor_folder(root_ / "held");
  ASSERT_EQ(folder.recordings.size(), 3u);
  EXPECT_EQ(folder.recordings[0].name, "other/any name.csv:7");
  EXPECT_EQ(folder.recordings[1].name, "other/any name.csv:9");
  EXPECT_EQ(folder.recordings[1].kind, SensorKind::kDirection);
  EXPECT_EQ(folder.recordings[2].name, "other/force.csv");
  EXPECT_EQ(folder.recordings[2].kind, SensorKind::kForce);
  EXPECT_THAT(folder.unfit, ElementsAre(HasSubstr("other/other.csv: lacks")));
  EXPECT_THAT(folder.damaged, ElementsAre(HasSubstr("bad.csv:2")));
  EXPECT_THROW(read_sensor_folder(root_ / "nowhere"), std::runtime_error);
}

TEST_F(Sensors, ALinearMapIsFoundAndAModelThatHoldsItIsRight) {
  write(train() / "known.csv", presses(20, 1, kMount, 1), true);
  write(held() / "new.csv", presses(8, 1, kMount, 2), true);
  const std::string hash = read_sensor_folder(train()).recordings.at(0).sha256;
  YAML::Node training;
  training["refit_on_all_parts"] = true;
  training["data"].push_back(YAML::Load("{file: known.csv, sha256: " + hash + "}"));
  SensorsOptions options;
  options.train = train();
  options.data = root_ / "held";
  options.models = {write_model(training)};
  options.output = root_ / "out";
  options.json = root_ / "scores.json";
  std::ostringstream out;
  std::vector<std::string> damaged;
  for (const char* executor : {"compiled", "torch"}) {
    options.executor = executor;
    const std::vector<SensorComparison> comparisons = compare_sensor_folders(options, out, damaged);
    ASSERT_EQ(comparisons.size(), 1u);
    EXPECT_EQ(comparisons[0].origin, "unseen");
    EXPECT_EQ(comparisons[0].file, "other/new.csv");
    const recordings::Errors& exact = score_of(comparisons[0], "exact").errors;
    EXPECT_EQ(exact.rows, 800);
    EXPECT_LT(exact.norms[0], 1e-5);  // N
    EXPECT_GT(exact.correlation.minCoeff(), 0.9999);
    EXPECT_LT(score_of(comparisons[0], "ridge").errors.norms[0], 1e-3);
    EXPECT_GT(score_of(comparisons[0], "mean").errors.norms[0], 0.05);
  }

  EXPECT_EQ(run_sensors(options, out), 0);
  EXPECT_THAT(out.str(), HasSubstr("other/new.csv: unseen, 800 rows, 1 recording"));
  std::ifstream csv(options.output / "sensors.csv");
  std::string line, header;
  std::getline(csv, header);
  int rows = 0;
  for (; std::getline(csv, line); ++rows)
    EXPECT_EQ(std::count(line.begin(), line.end(), ','),
              std::count(header.begin(), header.end(), ','))
        << line;
  EXPECT_EQ(rows, 3);
  const YAML::Node json = YAML::LoadFile(options.json.string());
  EXPECT_EQ(json["comparisons"][0]["scores"][0]["method"].as<std::string>(), "exact");
  EXPECT_LT(json["comparisons"][0]["scores"][0]["force_rms"].as<double>(), 1e-5);

  // Training data are labelled as such.
  options.data = train();
  EXPECT_EQ(compare_sensor_folders(options, out, damaged).at(0).origin, "trained on");
}

TEST_F(Sensors, TruthOfOtherMomentsGivesLargeErrors) {
  std::vector<Press> list = presses(8, 1, kMount, 2);
  write(train() / "right.csv", list, true);
  std::mt19937 random(1);
  std::vector<Eigen::Vector3d> forces;
  for (const Press& press : list) forces.push_back(press.force);
  std::shuffle(forces.begin() + 100, forces.end(), random);
  for (std::size_t k = 0; k < list.size(); ++k) list[k].force = forces[k];
  write(held() / "shuffled.csv", list, true);
  const std::filesystem::path model = write_model({});
  const auto error = [&](const std::filesystem::path& folder) {
    const SensorTrack scored = track(folder);
    const SensorComparison comparison =
        compare_sensors({scored}, {}, make_methods(read_sensor_model(model), "compiled"));
    return comparison.scores.at(0).errors.norms[0];
  };
  EXPECT_LT(error(train()), 1e-5);
  EXPECT_GT(error(root_ / "held"), 0.1);
}

TEST_F(Sensors, TheFrameOfDirectionsIsFoundWhateverTheSign) {
  std::vector<std::vector<SensorScore>> lists;
  for (const auto& [polarity, mount] : {std::pair{1.0, Eigen::Matrix3d::Identity().eval()},
                                        std::pair{1.0, kMount}, std::pair{-1.0, kMount}}) {
    write(train() / "plate.csv", presses(20, polarity, mount, 3), false);
    EXPECT_EQ(polarity_of({track(train())}), polarity);
    SensorTraining training;
    training.files.push_back({track(train()).recording.sha256, {}, {{10, 20}}});
    lists.push_back(baselines(train(), training));
    ASSERT_EQ(lists.back().size(), 8u);  // two weightings by three scatters, ridge, mean
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_NEAR(lists.back()[i].errors.median_angle[0], lists[0][i].errors.median_angle[0], 1e-4)
          << lists[0][i].method;
  }
  EXPECT_LT(lists[0][0].errors.median_angle[0], 12 * kSensorsDegree);
  EXPECT_GT(lists[0][7].errors.median_angle[0], 15 * kSensorsDegree);                 // the mean
  EXPECT_GT(lists[0][1].errors.median_angle[0], lists[0][0].errors.median_angle[0]);  // scattered
}

TEST_F(Sensors, TheComponentPlacesATouchWhereTheNormalOfANetworkSays) {
  write(train() / "plate.csv", presses(5, -1, kMount, 3), false);
  const Eigen::Vector3d normal = Eigen::Vector3d(0.3, -0.4, -0.8).normalized();  // in T
  inference::ModelCard card;
  card.name = "constant";
  card.rate = 100;
  card.inputs = {{"pdc", "count"}};
  card.outputs = {{"nx", "1"}, {"ny", "1"}, {"nz", "1"}};
  auto weights = sensing::RecurrentWeights::zero(1, 3, {2});
  weights.offset = (kMount * normal).cast<float>();
  const std::string path = (root_ / "constant.pt").string();
  inference::write_model_file(path, weights, card);
  FingertipFrame frame;
  frame.R_NT = kMount;
  const SensorTrack scored = track(train());
  const auto methods = make_methods(read_sensor_model(path), "compiled", frame);
  ASSERT_EQ(methods.size(), 2u);
  for (const SensorMethod& method : methods)
    EXPECT_LT((method.answer(scored).row(300).transpose() - kMount * normal).norm(), 1e-5)
        << method.name;
}

TEST(RotationBetween, IsFound) {
  const Eigen::Matrix3Xd from = Eigen::Matrix3Xd::Random(3, 20);
  EXPECT_LT((rotation_between(from, kMount * from) - kMount).norm(), 1e-9);
}

TEST_F(Sensors, OnlyRowsThatWereNotLearnedAreScored) {
  write(train() / "plate.csv", presses(20, 1, kMount, 3), false);
  const SensorTrack scored = track(train());
  const auto count = [](const std::vector<bool>& rows) {
    return std::count(rows.begin(), rows.end(), true);
  };
  SensorTraining training;
  EXPECT_EQ(rows_to_score(training, scored).origin, "unseen");
  EXPECT_EQ(rows_to_score(training, scored).rows, scored.counts);
  EXPECT_EQ(count(rows_to_learn(training, scored)), 0);
  training.files.push_back({scored.recording.sha256, {{5, 8}}, {{8, 12}}});
  const ScoredRows blocks = rows_to_score(training, scored);
  EXPECT_EQ(blocks.origin, "unseen blocks");
  for (std::size_t k = 0; k < blocks.rows.size(); ++k) {
    const bool learned = rows_to_learn(training, scored)[k];
    EXPECT_EQ(blocks.rows[k], scored.counts[k] && k >= 800 && k < 1200);
    EXPECT_EQ(learned, scored.counts[k] && (k < 500 || k >= 1200));
  }
  training.all_parts = true;
  EXPECT_EQ(rows_to_score(training, scored).origin, "trained on");
  EXPECT_EQ(rows_to_learn(training, scored), scored.counts);
}

TEST_F(Sensors, ARecordingThatBeginsInContactIsTaredWhereItRests) {
  std::vector<Press> list = presses(6, 1, kMount, 2);
  std::rotate(list.begin(), list.begin() + 240, list.end());
  for (std::size_t k = 0; k < list.size(); ++k) list[k].time = 0.01 * static_cast<double>(k);
  write(held() / "begins_late.csv", list, true);
  const SensorTrack scored = track(root_ / "held");
  EXPECT_GE(scored.tare_begin, 300);
  const auto methods = make_methods(read_sensor_model(write_model({})), "compiled");
  EXPECT_LT((methods.at(0).answer(scored) - scored.truth).cwiseAbs().maxCoeff(), 1e-4);
}

TEST_F(Sensors, WhatCannotBeScoredIsSaidClearly) {
  SensorsOptions options;
  options.train = options.data = train();
  options.output = root_ / "out";
  std::ostringstream out;
  std::vector<std::string> damaged;
  const auto complaint = [&]() -> std::string {
    try {
      compare_sensor_folders(options, out, damaged);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(complaint(), HasSubstr("no recording of a sensor that is scored"));
  write(train() / "known.csv", presses(3, 1, kMount, 1), true);
  options.models = {root_ / "none.pt"};
  EXPECT_THAT(complaint(), HasSubstr("none.pt"));
  inference::ModelCard card;
  card.name = "thermometer";
  card.rate = 100;
  card.inputs = {{"e1", "count"}};
  card.outputs = {{"warmth", "K"}};
  const std::string path = (root_ / "warmth.pt").string();
  inference::write_model_file(path, sensing::RecurrentWeights::zero(1, 1, {2}), card);
  options.models = {path};
  EXPECT_THAT(complaint(), HasSubstr("it gives warmth; known: fx fy fz"));
  card.inputs = {{"tac", "count"}};
  card.outputs = {{"fx", "N"}, {"fy", "N"}, {"fz", "N"}};
  inference::write_model_file(path, sensing::RecurrentWeights::zero(1, 3, {2}), card);
  EXPECT_THAT(complaint(), HasSubstr("takes an input 'tac'"));
}

TEST_F(Sensors, PresetsWithoutTheirRecordingsAreLeftOut) {
  const std::vector<std::string>& presets = default_sensor_models();
  for (const SensorKind kind : {SensorKind::kForce, SensorKind::kDirection, SensorKind::kWrist})
    EXPECT_TRUE(std::any_of(presets.begin(), presets.end(), [kind](const std::string& preset) {
      return kind_of_preset(preset) == kind;
    })) << name_of(kind);
  for (const std::string& preset : presets)
    EXPECT_FALSE(train_sensor_model(preset, {train(), root_ / "out"}, 1, 1)) << preset;
}

}  // namespace
}  // namespace palpate::sensor_models

#endif

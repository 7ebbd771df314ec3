#include "tools/train/fit.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iomanip>

#include "rt/inference/compiled_executor.hpp"
#include "rt/inference/model_file.hpp"
#include "tests/support/recordings.hpp"
#include "tools/train/report.hpp"

namespace palpate::train {
namespace {

recordings::Plan preset(const std::string& name, const std::vector<std::string>& overrides = {}) {
  return recordings::read_plan(config::Node::load_file(
      std::string(PALPATE_SOURCE_DIR) + "/tools/train/presets/" + name + ".yaml", overrides));
}

FitOptions quiet() {
  FitOptions options;
  options.progress = [](const CurvePoint&) { return true; };
  return options;
}

TEST(Presets, AreAllWellFormed) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(std::string(PALPATE_SOURCE_DIR) +
                                                               "/tools/train/presets")) {
    const recordings::Plan plan = preset(entry.path().stem().string());
    EXPECT_EQ(plan.name, entry.path().stem().string());
    ++count;
  }
  EXPECT_GE(count, 5);
}

TEST(Presets, MistakesAreNamed) {
  EXPECT_THROW(preset("ft_rnnob", {"network.layer=[3]"}), config::Error);
  EXPECT_THROW(preset("ft_rnnob", {"training.burn_in=50"}), config::Error);
  EXPECT_THROW(preset("biotac_linear_lstm", {"data.target=residual"}), config::Error);
  EXPECT_THROW(preset("biotac_linear_lstm", {"data.recordings.0.test=[3, 2]"}), config::Error);
}

constexpr double kInertialDelay = 0.0053;  // s, not a multiple of the sample time
constexpr double kWrenchDelay = 0.0207;
constexpr double kSample = 2e-3;

/// A wrist that rotates and shakes a load of 1.2 kg; inertial unit and wrench are delayed, and the
/// axial force drifts by `drift`, N/s.
class WristRecordingFile {
 public:
  explicit WristRecordingFile(double drift = 0)
      : folder_(std::filesystem::temp_directory_path() /
                ("palpate-wrist-" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
    sensing::PayloadParameters payload;
    payload.mass = 1.2;
    payload.first_moment = {0.01, -0.02, 0.12};
    payload.bias = {{3, -2, 5}, {0.1, 0.2, -0.1}};
    const Eigen::Vector3d gravity(0, 0, -9.81);
    const auto rotation = [](double t) {
      return math::exp_rotation(
          {0.7 * std::sin(1.1 * t), 0.6 * std::sin(1.7 * t + 1), 0.4 * std::sin(0.9 * t)});
    };
    const auto rate = [&](double t) -> Eigen::Vector3d {
      const double h = 1e-4;
      return math::log_rotation(rotation(t - h).transpose() * rotation(t + h)) / (2 * h);
    };
    const auto motion = [&](double t) {
      sensing::LoadMotion m;
      const Eigen::Vector3d shake(0.5 * std::sin(8 * t), 0.4 * std::cos(6 * t), 0);
      m.specific_force = shake - rotation(t).transpose() * gravity;
      m.angular_velocity = rate(t);
      m.angular_acceleration = (rate(t + 1e-3) - rate(t - 1e-3)) / 2e-3;
      return m;
    };
    std::ofstream file(folder_ / "wrist.csv");
    file << "t_s,px,py,pz,qw,qx,qy,qz,vx,vy,vz,gyr_x,gyr_y,gyr_z,acc_x,acc_y,acc_z,fx,fy,fz,tx,ty,"
            "tz\n"
         << std::setprecision(10);
    for (int k = 0; k < 6000; ++k) {
      const double t = 1 + kSample * k;
      const Eigen::Quaterniond q(rotation(t));
      const sensing::LoadMotion imu = motion(t - kInertialDelay);
      math::Wrench wrench = sensing::load_wrench(payload, motion(t - kWrenchDelay));
      wrench.force.z() += drift * (t - 1);
      file << t << ",0,0,0," << q.w() << ',' << q.x() << ',' << q.y() << ',' << q.z() << ",0,0,0";
      for (const Eigen::Vector3d& v :
           {imu.angular_velocity, imu.specific_force, wrench.force, wrench.torque})
        file << ',' << v.x() << ',' << v.y() << ',' << v.z();
      file << '\n';
    }
  }
  ~WristRecordingFile() { std::filesystem::remove_all(folder_); }
  std::string folder() const { return folder_.string(); }

 private:
  std::filesystem::path folder_;
};

TEST(WristData, FindsDelaysAndPayloadAndLeavesNoResidual) {
  const WristRecordingFile file;
  recordings::Plan plan = preset("ft_rnnob", {"data.wrist.acceleration_has_gravity=true"});
  plan.data.recordings = {{"wrist.csv", "", {{8, 9}}, {{9, 12}}}};
  const recordings::DataSet data = recordings::load_data(plan.data, {file.folder()});
  ASSERT_EQ(data.delays.size(), 2u);
  EXPECT_NEAR(data.delays[0].seconds, kInertialDelay, kSample / 2);
  EXPECT_NEAR(data.delays[1].seconds, kWrenchDelay, kSample / 2);
  // The card states the identified values.
  const inference::ModelCard card = make_card(plan, data, {}, {});
  ASSERT_EQ(card.delays.size(), 2u);
  EXPECT_EQ(card.delays[0].stream, "inertial");
  EXPECT_EQ(card.delays[0].seconds, data.delays[0].seconds);
  EXPECT_EQ(card.delays[1].stream, "force_torque");
  EXPECT_EQ(card.delays[1].seconds, data.delays[1].seconds);
  EXPECT_NEAR(data.payload->mass, 1.2, 0.012);
  EXPECT_LT((data.payload->first_moment - Eigen::Vector3d(0.01, -0.02, 0.12)).norm(), 2e-3);
  const Eigen::MatrixXd& rest = data.recordings[0].outputs;
  EXPECT_LT(rest.leftCols(3).bottomRows(rest.rows() - 20).cwiseAbs().maxCoeff(), 0.15);  // N of 12
  EXPECT_LT(rest.rightCols(3).bottomRows(rest.rows() - 20).cwiseAbs().maxCoeff(), 0.02);
}

TEST(WristData, TakesADriftOutOfTheTrainingButNotOutOfTheScore) {
  const double drift = 0.2;  // N/s
  const WristRecordingFile file(drift);
  recordings::Plan plan = preset("ft_rnnob", {"data.wrist.acceleration_has_gravity=true"});
  plan.data.recordings = {{"wrist.csv", "", {}, {{4, 6}}}};
  const recordings::DataSet data = recordings::load_data(plan.data, {file.folder()});
  const recordings::Recording& recording = data.recordings[0];
  EXPECT_NEAR(data.payload->mass, 1.2, 0.012);
  const auto slope_of_fz = [&](recordings::Part part) {
    double t_mean = 0, y_mean = 0, ty = 0, tt = 0, n = 0;
    for (const bool sums : {false, true})
      for (std::size_t k = 20; k < recording.parts.size(); ++k) {
        if (recording.parts[k] != part) continue;
        const auto row = static_cast<Eigen::Index>(k);
        const double t = recording.time[row], y = recording.outputs(row, 2);
        if (!sums)
          t_mean += t, y_mean += y, ++n;
        else
          ty += (t - t_mean / n) * (y - y_mean / n), tt += std::pow(t - t_mean / n, 2);
      }
    return ty / tt;
  };
  EXPECT_NEAR(slope_of_fz(recordings::Part::kTraining), 0, 0.02 * drift);
  EXPECT_NEAR(slope_of_fz(recordings::Part::kTest), drift, 0.1 * drift);
}

TEST(FoamBar, ForceIsWithinItsBarOnLoadsNeverTrainedOn) {
  PALPATE_REQUIRE_RECORDING("biotac_foam_bar");
  const recordings::Plan plan = preset("biotac_linear_lstm", {"training.iterations=50"});
  const recordings::DataSet data =
      recordings::load_data(plan.data, {support::recordings().string()});
  const Fit fit = fit_model(plan, data, quiet());
  const Score score = score_fit(plan, data, fit);
  EXPECT_EQ(score.part, recordings::Part::kTest);
  EXPECT_GT(score.largest_scored[2], 1.25 * score.largest_trained[2]);
  EXPECT_LE(score.methods.front().errors.norms[0], 0.02);  // N

  // Through the file and back: the executors give the scored results.
  const std::string path = (std::filesystem::temp_directory_path() /
                            ("palpate-foam-" + std::to_string(getpid()) + ".pt"))
                               .string();
  inference::write_model_file(path, fit.network, make_card(plan, data, fit, score));
  const auto executor = inference::make_executor(inference::read_model_file(path),
                                                 inference::ExecutorKind::kCompiled);
  const Eigen::MatrixXf x = data.recordings[0].inputs.cast<float>().transpose();
  Eigen::VectorXf y(3);
  for (Eigen::Index k = 0; k < 700; ++k)
    ASSERT_EQ(executor->step(x.col(k).data(), y.data()), inference::Answer::kFresh);
  const Eigen::VectorXd expected = score.methods.front().predictions[0].row(699).transpose();
  EXPECT_LT((y.cast<double>() - expected).norm(), 1e-5);
  std::filesystem::remove(path);
  std::filesystem::remove(inference::card_path(path));
}

}  // namespace
}  // namespace palpate::train

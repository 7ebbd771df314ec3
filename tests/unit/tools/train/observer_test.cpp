// The wrist sensor's observer in the loop and its training use the same numbers.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "core/sensing/ft_rnnob.hpp"
#include "rt/inference/compiled_executor.hpp"
#include "tests/support/recordings.hpp"
#include "tools/recordings/wrist_data.hpp"

namespace palpate::train {
namespace {

const std::string kPreset = PALPATE_SOURCE_DIR "/tools/train/presets/ft_rnnob.yaml";

template <class T, int kCapacity>
void feed(sensing::Stream<T, kCapacity>& stream, const T& sample) {
  stream.freshness = Freshness::kNew;
  stream.age = 0;
  stream.latest = stream.fresh[0] = sample;
  stream.fresh_count = 1;
}

Eigen::Matrix3d orientation(const Eigen::RowVectorXd& row) {
  return Eigen::Quaterniond(row[0], row[1], row[2], row[3]).normalized().toRotationMatrix();
}

/// A row of wrist_columns() as the daemon would receive it. Gravity, which was removed from it, is
/// added back to the acceleration with `felt`, the row whose orientation corresponds to the delayed
/// inertial sample.
void feed_row(const Eigen::RowVectorXd& row, const Eigen::RowVectorXd& felt,
              const Eigen::Vector3d& gravity_W, sensing::Signals& signals) {
  sensing::RobotState robot;
  robot.X_WE.linear() = orientation(row);
  robot.X_WE.translation() = row.segment<3>(19).transpose();
  robot.V_W_E.linear = row.segment<3>(4).transpose();
  feed(signals.robot, robot);
  sensing::Inertial inertial;
  inertial.angular_velocity_I = row.segment<3>(7).transpose();
  inertial.acceleration_I =
      row.segment<3>(10).transpose() - orientation(felt).transpose() * gravity_W;
  feed(signals.inertial, inertial);
  sensing::ForceTorque wrench;
  wrench.F_S = {row.segment<3>(13).transpose(), row.segment<3>(16).transpose()};
  feed(signals.force_torque, wrench);
}

TEST(Observer, GivesInTheLoopWhatItsTrainingSaw) {
  PALPATE_REQUIRE_RECORDING("ft_imu_panda");
  const recordings::Plan plan = recordings::read_plan(config::Node::load_file(kPreset));
  const std::string path =
      (support::recordings() / "ft_imu_panda" / "sessionA_11-32-28.csv.gz").string();
  const recordings::Table table =
      recordings::read_tables(path, "t_s", recordings::wrist_columns(plan.data.wrist), "").front();
  const recordings::WristRecording recording = recordings::load_wrist(plan.data, table);

  sensing::FtRnnob::Options options;
  for (const std::string& name : recordings::columns_of(plan.data.inputs))
    options.inputs.push_back(sensing::observer_input_index(name));
  const auto inputs = static_cast<int>(options.inputs.size());
  options.rate = plan.data.rate;
  options.average = plan.data.average;
  options.inertial_delay = recording.delays[0].seconds;
  options.force_torque_delay = recording.delays[1].seconds;
  recordings::Table felt = table;
  recordings::delay_columns(felt, 0, 4, options.inertial_delay);
  options.payload.mass = 1.15;
  options.payload.first_moment = {0, 0.004, 0.12};
  // So that the network's part varies along the recording.
  Eigen::MatrixXd covered(recording.inputs.rows(), inputs);
  for (int i = 0; i < inputs; ++i)
    covered.col(i) = recording.inputs.col(options.inputs[static_cast<std::size_t>(i)]);
  Eigen::VectorXd deviation(inputs);
  deviation << 0.2, 0.1, 0.1, 0.05, 0.05, 0.05, 0.1, 0.1, 0.1, 2, 0.6, 1;
  options.domain = sensing::cover(covered.topRows(400), deviation, 16, 0.5, 1.5);

  std::mt19937 random(2);
  std::normal_distribution<float> normal(0, 0.4f);
  sensing::RecurrentWeights weights = sensing::RecurrentWeights::zero(inputs, 6, {15, 10});
  for (sensing::LstmWeights& layer : weights.layers)
    for (auto* part : {&layer.input, &layer.hidden})
      for (Eigen::Index i = 0; i < part->size(); ++i) part->data()[i] = normal(random);
  for (Eigen::Index i = 0; i < weights.dense.size(); ++i) weights.dense.data()[i] = normal(random);
  sensing::FtRnnob observer(options, std::make_unique<inference::DirectExecutor>(
                                         std::make_unique<inference::CompiledModel>(weights)));

  sensing::RecurrentNetwork network(weights);
  std::vector<float> state(network.states(), 0.f), input(inputs);
  Eigen::Matrix<float, 6, 1> output;
  sensing::Signals signals;
  double largest = 0, least = 1, most = 0;
  const auto steps = static_cast<int>(recording.samples.size()) - 1;
  for (int tick = 0; tick < 10 * steps; ++tick) {
    feed_row(table.rows.row(tick), felt.rows.row(tick), options.gravity_W, signals);
    sensing::ContactSet contacts;
    static_cast<void>(observer.update(signals, contacts));
    if (tick % 10 != 0) continue;
    const int k = tick / 10;
    for (int i = 0; i < inputs; ++i)
      input[i] = static_cast<float>(recording.inputs(k, options.inputs[i]));
    network.step(input.data(), state.data(), output.data());
    const sensing::MotionSample& sample = recording.samples[k];
    const double trust = options.domain.trust(covered.row(k).transpose());
    least = std::min(least, trust);
    most = std::max(most, trust);
    const math::Vector6d expected = sample.F_S.vector() -
                                    sensing::load_wrench(options.payload, sample.motion).vector() -
                                    trust * output.cast<double>();
    ASSERT_EQ(contacts.count, 1);
    largest =
        std::max(largest, (contacts.contacts[0].wrench.vector() - expected).cwiseAbs().maxCoeff());
  }
  EXPECT_EQ(least, 0);
  EXPECT_EQ(most, 1);
  // Means of gravity in rotating axes differ slightly from gravity in mean axes.
  EXPECT_LT(largest, 2e-3);
}

}  // namespace
}  // namespace palpate::train

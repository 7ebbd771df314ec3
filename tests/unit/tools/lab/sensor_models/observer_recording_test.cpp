#include "tools/lab/sensor_models/observer_recording.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <lcm/lcm-cpp.hpp>
#include <palpate/ft_wrench_t.hpp>
#include <palpate/imu_t.hpp>
#include <palpate/robot_state_t.hpp>

#include "tools/lab/sensor_models/observer_score.hpp"
#include "tools/recordings/csv_reader.hpp"

namespace palpate::sensor_models {
namespace {

namespace fs = std::filesystem;

class ObserverRecording : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("palpate_observer_" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  template <class Message>
  static void write(lcm::LogFile& log, const std::string& channel, const Message& message) {
    std::vector<std::uint8_t> buffer(message.getEncodedSize());
    message.encode(buffer.data(), 0, static_cast<int>(buffer.size()));
    lcm::LogEvent event{};
    event.timestamp = message.utime;
    event.channel = channel;
    event.datalen = static_cast<int>(buffer.size());
    event.data = buffer.data();
    log.writeEvent(&event);
  }

  fs::path folder_;
};

/// A flange that accelerates about its z through the origin of W, the sensor 0.3 m off that axis,
/// the inertial unit 0.1 m further out and rotated: inertial effects on a turntable.
TEST_F(ObserverRecording, MovesTheInertialUnitToTheSensor) {
  registry::Frames frames;
  frames.X_ES.translation() = Eigen::Vector3d(0.3, 0, 0);
  frames.X_EI = math::make_pose(math::exp_rotation({0, 0, M_PI / 2}), {0.4, 0, 0});
  const double alpha = 2;  // rad/s^2
  const fs::path path = folder_ / "spin.log";
  {
    lcm::LogFile log(path.string(), "w");
    for (int i = 0; i < 1000; ++i) {
      const double t = 1e-3 * i, omega = alpha * t, angle = 0.5 * alpha * t * t;
      robot_state_t state{};
      state.utime = 1000 * i;
      math::wxyz_from_rotation(math::exp_rotation({0, 0, angle}), state.quaternion);
      state.twist[5] = omega;
      write(log, "ROBOT_STATE", state);
      imu_t motion{};
      motion.utime = state.utime;
      // Outwards is -y of I, along the turn -(-x): of E, (-r omega^2, r alpha).
      motion.acceleration[0] = 0.4 * alpha;
      motion.acceleration[1] = 0.4 * omega * omega;
      motion.acceleration[2] = 9.81;
      motion.angular_velocity[2] = omega;
      write(log, "IMU", motion);
      ft_wrench_t wrench{};
      wrench.utime = state.utime;
      wrench.wrench[4] = t;
      write(log, "FT_WRENCH", wrench);
    }
  }
  write_wrist_csv(path, frames, 200, folder_ / "spin.csv");
  recordings::CsvReader csv((folder_ / "spin.csv").string());
  const auto cell = [&csv](const char* name) { return csv.number(csv.column(name)); };
  int rows = 0;
  while (csv.next()) {
    ++rows;
    const double t = cell("t_s");
    if (t < 0.01) continue;
    const double omega = alpha * t;
    ASSERT_NEAR(cell("gyr_z"), omega, 1e-6);
    ASSERT_NEAR(cell("acc_x"), -0.3 * omega * omega, 1e-6) << t;
    ASSERT_NEAR(cell("acc_y"), 0.3 * alpha, 1e-6) << t;
    ASSERT_NEAR(cell("acc_z"), 9.81, 1e-6);
    // Tangential.
    const double angle = 0.5 * alpha * t * t;
    ASSERT_NEAR(cell("vx"), -0.3 * omega * std::sin(angle), 1e-6);
    ASSERT_NEAR(cell("vy"), 0.3 * omega * std::cos(angle), 1e-6);
    ASSERT_NEAR(cell("qw"), std::cos(angle / 2), 1e-6);
    ASSERT_NEAR(cell("ty"), t, 1e-6);
  }
  EXPECT_EQ(rows, 1000);
}

TEST_F(ObserverRecording, ALogWithoutAStreamIsNamed) {
  {
    lcm::LogFile log((folder_ / "robot.log").string(), "w");
    write(log, "ROBOT_STATE", robot_state_t{});
  }
  EXPECT_THROW(write_wrist_csv(folder_ / "robot.log", {}, 200, folder_ / "robot.csv"),
               std::runtime_error);
}

/// The ground truth of the collision equals the arm's load: at rest under contact, the sensor's
/// reading has changed by it.
TEST_F(ObserverRecording, TheTrueForceIsWhatTheSensorFeels) {
  const MotionLogs logs = record_motion(
      PALPATE_SOURCE_DIR "/sim/scenes/payload_collision.yaml",
      {"motion={start_delay: 0.2, poses: [{move: 1, hold: 1, translation: [-0.045, 0, 0]}]}",
       "sensors.force_torque.cable={stiffness: 0, torsion: 0}",
       "sensors.force_torque.force.hysteresis=0"},
      folder_, "press");
  const ForceSeries truth = read_true_touch(logs.housekeeping);
  ASSERT_FALSE(truth.time.empty());
  EXPECT_EQ(truth.force.col(0).norm(), 0);
  const Eigen::Vector3d pressed = truth.force.rightCols<1>();
  EXPECT_LT(pressed.x(), -10) << "the hand pushes away from the arm";

  write_wrist_csv(logs.control,
                  registry::read_frames(config::Node::load_file(
                      PALPATE_SOURCE_DIR "/rt/config/examples/payload_arm.yaml")),
                  200, folder_ / "press.csv");
  recordings::CsvReader csv((folder_ / "press.csv").string());
  double before = 0, after = 0;
  int first = 0, last = 0;
  while (csv.next()) {
    const double t = csv.number(0), fz = csv.number(csv.column("fz"));
    if (t < 0.15) before += fz, ++first;
    if (t > 1.7) after += fz, ++last;
  }
  // z of the sensor points along -x of O; it measures its wrench on the hand.
  EXPECT_NEAR(after / last - before / first, -pressed.x(), 0.1);
}

}  // namespace
}  // namespace palpate::sensor_models

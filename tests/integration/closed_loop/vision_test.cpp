// The filter with a camera that observes the object, in the simulator, under every model error at
// once (tools/lab/studies/mismatch.yaml): the daemon's E, Poisson's ratio and mesh are wrong, its
// force sensor and hand pose have errors, the pads are compliant.
#include "tests/integration/closed_loop/closed_loop.hpp"

namespace palpate {
namespace {

constexpr const char* kVisionScene = "sim/scenes/bar_long_soft_control_camera.yaml";
constexpr const char* kBlindScene = "sim/scenes/bar_long_soft_control.yaml";
constexpr const char* kVisionConfiguration = "rt/config/examples/bar_long_soft.yaml";

const std::vector<std::string> kDaemonErrors = {
    "estimation.component=pose_wrench_filter", "object.material.young_modulus=39e3",
    "object.material.poisson_ratio=0.15", "object.mesh.box.cells=[7, 1, 1]",
    "control.dead_band_mm=0"};  // whose edge is a step of the command

std::vector<std::string> scene_errors(std::vector<std::string> more = {}) {
  more.insert(more.end(), {"sensors.force_torque.bias=[0.0333, 0.0167, -0.0333, 0, 0, 0]",
                           "sensors.kinematics_error={position: [0.000333, 0.000667, -0.000667], "
                           "rpy_deg: [0.333, -0.167, 0.333]}",
                           "object.pads.stiffness=2e4"});
  return more;
}

/// Controls the middle of the bar, and checks its ground truth.
class Steered {
 public:
  Steered(const std::string& scene, std::vector<std::string> overrides)
      : loop_(scene, kVisionConfiguration, std::move(overrides), kDaemonErrors) {
    loop_.run(0.1);
    loop_.send_event("start");
    loop_.run(0.9);
  }
  void aim(const Eigen::Vector3d& way) {
    rest_point_ = loop_.daemon().pipeline().feature().rest_points()[0];
    target_ = rest_point_ + way;
    loop_.send_target("point", target_);
  }
  void run(double seconds) {
    loop_.run(seconds, [this] {
      const pipeline::Condition condition = loop_.daemon().pipeline().condition();
      if (condition.state != pipeline::LifeCycle::kActive) ++inactive_ticks_;
      twist_command_t command;
      std::int64_t arrival_ns = 0;
      while (loop_.twists().take(command, arrival_ns)) {
        const Eigen::Vector3d now = Eigen::Map<const Eigen::Vector3d>(command.twist);
        largest_step_ = std::max(largest_step_, (now - before_).norm());
        before_ = now;
      }
    });
  }
  double point_error() {  // m, of the true point
    return (loop_.simulation().plant().position_at(rest_point_) - target_).norm();
  }
  Eigen::VectorXd shape_errors() { return loop_.shape_error(); }            // m, of each node
  double take_largest_step() { return std::exchange(largest_step_, 0.0); }  // m/s per tick
  ClosedLoop& loop() { return loop_; }
  int inactive_ticks() const { return inactive_ticks_; }

 private:
  ClosedLoop loop_;
  Eigen::Vector3d rest_point_, target_;
  Eigen::Vector3d before_ = Eigen::Vector3d::Zero();
  double largest_step_ = 0;
  int inactive_ticks_ = 0;
};

TEST(Vision, BringsAPointWithinAMillimetreOfItsTarget) {
  const Eigen::Vector3d way(0, 0.01, 0.03);
  Steered blind(kBlindScene, scene_errors());
  blind.aim(way);
  blind.run(6);
  Steered seen(kVisionScene, scene_errors());
  seen.aim(way);
  seen.run(6);
  const Eigen::VectorXd unseen = blind.shape_errors(), errors = seen.shape_errors();
  std::printf(
      "point: blind %.2f mm, seen %.2f mm; shape, mean / max: %.2f / %.2f mm, %.2f / %.2f mm\n",
      1e3 * blind.point_error(), 1e3 * seen.point_error(), 1e3 * unseen.mean(),
      1e3 * unseen.maxCoeff(), 1e3 * errors.mean(), 1e3 * errors.maxCoeff());
  // A rigid patch cannot be correct at each of its nodes, so that the worst of them says little
  // about the shape: its bound is the one for blind shapes, 1.5 % of the length.
  EXPECT_LT(errors.maxCoeff(), 0.015 * 0.5);
  EXPECT_LT(errors.mean(), unseen.mean());
  EXPECT_LT(seen.point_error(), 1e-3);
  EXPECT_LT(seen.point_error(), blind.point_error());
  EXPECT_EQ(seen.inactive_ticks(), 0);
}

TEST(Vision, OcclusionCausesNoStepOfTheCommand) {
  // Visible until 4 s, occluded until 9 s, visible again.
  Steered hand(kVisionScene, scene_errors({"camera.occlusions=[{at: 4, duration: 5}]"}));
  hand.aim({0, 0, 0.03});
  hand.run(2.9);  // until just before the occlusion
  hand.take_largest_step();
  hand.run(5.0);
  const double hidden = hand.take_largest_step(), error_hidden = hand.point_error();
  hand.run(4.0);
  const double again = hand.take_largest_step();
  const control::GateLimits limits;
  std::printf(
      "largest step of the command: %.4f mm/s hidden, %.4f mm/s again; limit %.4f mm/s; "
      "point %.2f mm, then %.2f mm\n",
      1e3 * hidden, 1e3 * again, limits.linear_acceleration, 1e3 * error_hidden,
      1e3 * hand.point_error());
  const double limit = 1e-3 * limits.linear_acceleration;  // m/s per tick
  EXPECT_LT(hidden, 0.5 * limit);
  EXPECT_LT(again, 0.5 * limit);
  EXPECT_LT(hand.point_error(), 1e-3);
  EXPECT_LT(error_hidden, 5e-3);
  EXPECT_EQ(hand.inactive_ticks(), 0) << "nothing need be seen";
}

}  // namespace
}  // namespace palpate

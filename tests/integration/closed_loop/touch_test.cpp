// Guarded motions in the simulator: a ball on the finger of the hand against a soft block.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <palpate/touch_request_t.hpp>
#include <palpate/touch_t.hpp>
#include <random>
#include <sstream>

#include "tests/integration/closed_loop/closed_loop.hpp"

namespace palpate {
namespace {

const char* const kTouchScene = "sim/scenes/touch_block.yaml";
const char* const kTouchConfiguration = "rt/config/examples/touch_block.yaml";
constexpr double kBlock = 0.06, kBall = 0.01;  // m

class TouchLoop {
 public:
  explicit TouchLoop(const std::vector<std::string>& scene = {},
                     const std::vector<std::string>& daemon = {})
      : loop_(kTouchScene, kTouchConfiguration, scene, daemon),
        requests_(loop_.user_bus(), "TOUCH_REQUEST"),
        touches_(loop_.user_bus(), "TOUCH", 64) {
    loop_.run(0.8);
    loop_.send_event("start");
    loop_.run(0.1);
  }

  void ask(const Eigen::Vector3d& direction_W, double force, double distance = 0) {
    request_ = {};
    request_.session = 1;
    request_.request = 1;
    std::copy_n(direction_W.data(), 3, request_.direction);
    request_.force = force;
    request_.distance = distance;
    requests_.publish(request_);
  }
  void cancel() {
    request_.action = touch_request_t::CANCEL;
    requests_.publish(request_);
  }

  /// Until the motion has ended, or reaches `state`.
  const touch_t& run(double seconds, std::int32_t state = -1) {
    for (int i = 0; i < static_cast<int>(100 * seconds); ++i) {
      loop_.run(0.01);
      std::int64_t arrival_ns = 0;
      while (touches_.take(touch_, arrival_ns)) {
      }
      most_force_ = std::max(most_force_, loop_.simulation().plant().touch(0).force.norm());
      if (touch_.request == 1 && (touch_.state == state || touch_.state >= touch_t::TOUCHED)) break;
    }
    return touch_;
  }

  const char* reason() const { return bus::get_text(touch_.reason); }
  ClosedLoop& loop() { return loop_; }
  double most_force() const { return most_force_; }
  double flange_speed() { return loop_.simulation().robot().flange_twist().linear.norm(); }

  /// Distance of the ball's surface from the free side of the block along the normal, m, with the
  /// ball's centre at `centre_W`: zero if the touch was found exactly.
  double gap(const Eigen::Vector3d& centre_W) {
    const math::Pose& X_WO = loop_.simulation().scene().X_WO;
    const Eigen::Vector3d centre_O = X_WO.inverse() * centre_W;
    const object::HyperelasticPlant& plant = loop_.simulation().plant();
    // Of the deformed side at the place that faces the centre; after the retreat it is free again.
    const Eigen::Vector3d facing(kBlock, std::clamp(centre_O.y(), 0.0, kBlock),
                                 std::clamp(centre_O.z(), 0.0, kBlock));
    return centre_O.x() - plant.position_at(facing).x() - kBall;
  }

 private:
  ClosedLoop loop_;
  bus::TypedPublisher<touch_request_t> requests_;
  bus::TypedSubscription<touch_t> touches_;
  touch_request_t request_{};
  touch_t touch_{};
  double most_force_ = 0;
};

TEST(Touch, FindsTheSurfaceAtZeroForce) {
  TouchLoop touch;
  touch.ask({1, 0, 0}, 0.3);
  const touch_t& result = touch.run(30);
  ASSERT_EQ(result.state, touch_t::TOUCHED) << touch.reason();
  touch.loop().run(1);  // the block comes to rest
  const double error = touch.gap(Eigen::Vector3d(result.centre));
  std::printf("error %.3f mm, deviation %.3f mm, stiffness %.0f +- %.0f N/m, indentation %.2f mm\n",
              1e3 * error, 1e3 * result.point_deviation, result.stiffness,
              result.stiffness_deviation, 1e3 * result.indentation);
  ASSERT_GT(result.point_deviation, 0) << touch.reason();
  EXPECT_LT(std::abs(error), 0.5e-3);
  EXPECT_LT(std::abs(error), 3 * result.point_deviation);
  EXPECT_GT(result.indentation, 2 * std::abs(error)) << "the point where the hand stopped is worse";
  EXPECT_GT(touch.most_force(), 0.25);
  EXPECT_LT(touch.most_force(), 0.6);
  EXPECT_EQ(touch.loop().simulation().plant().touch(0).force.norm(), 0) << "it has backed off";
}

TEST(Touch, WithoutContactItEndsAtItsDistance) {
  TouchLoop touch;
  const double before = touch.loop().simulation().robot().flange_pose().translation().x();
  touch.ask({-1, 0, 0}, 0.3, 0.015);
  const touch_t& result = touch.run(30);
  EXPECT_EQ(result.state, touch_t::NO_CONTACT) << touch.reason();
  touch.loop().run(0.5);
  const double after = touch.loop().simulation().robot().flange_pose().translation().x();
  EXPECT_NEAR(before - after, 0.015, 1e-3);
  EXPECT_EQ(touch.most_force(), 0);
}

TEST(Touch, CancelAndStaleSensorsStopTheHand) {
  for (const bool is_cancelled : {true, false}) {
    TouchLoop touch;
    touch.ask({1, 0, 0}, 0.3);
    touch.run(5, touch_t::APPROACHING);
    touch.loop().run(1);
    ASSERT_GT(touch.flange_speed(), 0.002);
    if (is_cancelled)
      touch.cancel();
    else
      touch.loop().mute("FT_WRENCH");
    const touch_t& result = touch.run(2);
    EXPECT_EQ(result.state, touch_t::STOPPED);
    EXPECT_NE(std::string(touch.reason()).find(is_cancelled ? "cancelled" : "too old"),
              std::string::npos)
        << touch.reason();
    touch.loop().run(0.5);
    EXPECT_LT(touch.flange_speed(), 2e-4);
    EXPECT_EQ(touch.most_force(), 0);
  }
}

// Pose and inclination of the block, direction, modulus, threshold and noise are drawn; the cables'
// play of 0.1 N is stated.
TEST(Touch, IntervalsHoldOverDraws) {
  constexpr int kDraws = 6;
  std::vector<double> errors;
  int covered = 0, touched = 0;
  double squares = 0, deviations = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    std::mt19937 generator(100U + static_cast<unsigned>(draw));
    std::uniform_real_distribution<double> unit(-1, 1);
    std::ostringstream position, angles, modulus;
    position << "object.pose.position=[" << 1.06 + 5e-3 * unit(generator) << ", "
             << 0.041 + 10e-3 * unit(generator) << ", " << 0.0435 + 10e-3 * unit(generator) << "]";
    angles << "object.pose.rpy_deg=[0, " << 6 * unit(generator) << ", " << 180 + 6 * unit(generator)
           << "]";
    modulus << "object.material.young_modulus=" << 30e3 * std::pow(2, unit(generator));
    const Eigen::Vector3d direction(1, 0.1 * unit(generator), 0.1 * unit(generator));
    const double force = 0.3 + 0.1 * unit(generator);
    TouchLoop touch(
        {position.str(), angles.str(), modulus.str(), "seed=" + std::to_string(100 + draw)});
    touch.ask(direction, force);
    const touch_t& result = touch.run(30);
    if (result.state != touch_t::TOUCHED || result.point_deviation < 0) {
      std::printf("%2d: state %d, %s\n", draw, result.state, touch.reason());
      continue;
    }
    ++touched;
    touch.loop().run(1);
    const double error = touch.gap(Eigen::Vector3d(result.centre));
    errors.push_back(1e3 * std::abs(error));
    squares += error * error;
    deviations += result.point_deviation * result.point_deviation;
    covered += std::abs(error) < 1.96 * result.point_deviation;
    std::printf(
        "%2d: error %+.3f mm, deviation %.3f mm, stiffness %4.0f N/m, indentation %.2f mm\n", draw,
        1e3 * error, 1e3 * result.point_deviation, result.stiffness, 1e3 * result.indentation);
  }
  ASSERT_GE(touched, kDraws - 1);
  std::sort(errors.begin(), errors.end());
  std::printf(
      "touched %d of %d: median %.3f mm, RMS %.3f mm, worst %.3f mm, RMS deviation %.3f mm, "
      "%d within 95 %%\n",
      touched, kDraws, errors[errors.size() / 2], 1e3 * std::sqrt(squares / touched), errors.back(),
      1e3 * std::sqrt(deviations / touched), covered);
  EXPECT_LT(errors.back(), 0.8);
  EXPECT_GE(covered, touched - 1);
}

}  // namespace
}  // namespace palpate

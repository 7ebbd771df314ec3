#include "core/control/guarded_motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace palpate::control {
namespace {

using Eigen::Vector3d;

constexpr double kTick = 1e-3;  // s

/// A hand that moves as commanded towards a soft half-space, whose surface is `surface` m along the
/// direction from the tip's front.
class Cell {
 public:
  explicit Cell(const GuardedMotion::Options& options = defaults())
      : options_(options), motion_(options, 0.1) {}

  static GuardedMotion::Options defaults() {
    GuardedMotion::Options options;
    options.tip_G = {0.1, -0.02, 0.03};
    options.tip_radius = 4e-3;
    return options;
  }
  static TouchRequest request(double force = 0.2) {
    TouchRequest request;
    request.direction_W = {0, 0, -2};
    request.force = force;
    return request;
  }

  Vector3d tip() const { return X_WG * options_.tip_G; }
  double travel() const { return direction.dot(tip() - start_); }

  /// Until the motion ends; at most `seconds`.
  void run(double seconds = 60) {
    if (start_.isZero()) start_ = tip();
    for (double time = 0; time < seconds && motion_.is_running(); time += kTick) {
      GuardedMotion::Inputs inputs;
      inputs.dt = kTick;
      inputs.is_usable = usable;
      inputs.reason = "too old";
      inputs.X_WG = X_WG;
      const double depth = travel() - surface;
      const double force = depth > 0 ? stiffness * std::pow(depth, 1.5) : 0;
      inputs.force_W = offset_W + force * direction;
      inputs.is_rejected = rejected;
      inputs.gate_reason = gate_reason;
      largest_force = std::max(largest_force, force);
      const Vector3d velocity = motion_.advance(inputs);
      largest_change = std::max(largest_change, (velocity - last_).norm() / kTick);
      last_ = velocity;
      if (obeys) X_WG.translation() += kTick * velocity;
      least_travel = std::min(least_travel, travel());
      most_speed = std::max(most_speed, velocity.norm());
    }
  }

  GuardedMotion& motion() { return motion_; }
  const TouchReport& report() const { return motion_.report(); }
  std::string reason() const { return report().reason.data(); }

  math::Pose X_WG = math::make_pose(math::exp_rotation({0.3, -0.2, 0.5}), {0.4, 0.1, 0.3});
  Vector3d direction{0, 0, -1};
  double surface = 0.02;    // m
  double stiffness = 2780;  // N/m^1.5: a ball of 4 mm on 30 kPa
  Vector3d offset_W{0.3, -0.2, 1};
  bool usable = true, rejected = false, obeys = true;
  const char* gate_reason = "";
  double largest_force = 0, least_travel = 0, most_speed = 0, largest_change = 0;

 private:
  GuardedMotion::Options options_;
  GuardedMotion motion_;
  Vector3d start_ = Vector3d::Zero(), last_ = Vector3d::Zero();
};

TEST(GuardedMotion, ReportsTheSurfaceAtZeroForceAndBacksOff) {
  Cell cell;
  const Vector3d before = cell.tip();
  ASSERT_STREQ(cell.motion().begin(Cell::request()), "");
  EXPECT_EQ(cell.report().state, TouchState::kWaiting);
  cell.run();
  const TouchReport& report = cell.report();
  ASSERT_EQ(report.state, TouchState::kTouched) << cell.reason();
  EXPECT_LT((report.centre_W - (before + 0.02 * cell.direction)).norm(), 2e-5);
  EXPECT_LT((report.point_W - (before + 0.024 * cell.direction)).norm(), 2e-5);
  EXPECT_GT(report.point_deviation, 0);
  EXPECT_LT(report.point_deviation, 1e-4);
  EXPECT_NEAR(report.indentation, std::pow(0.2 / 2780, 2.0 / 3), 2e-4);
  EXPECT_NEAR(report.stiffness, 2780 * std::sqrt(report.indentation), 3);
  EXPECT_NEAR(cell.travel(), 0.01, 2e-4) << "10 mm before the surface";
  EXPECT_LT(cell.largest_force, 0.3) << "the threshold, and the way of braking";
  EXPECT_NEAR(report.force, cell.largest_force, 1e-3);
  EXPECT_NEAR(cell.most_speed, 0.005, 1e-9);
  EXPECT_TRUE(cell.X_WG.linear().isApprox(math::exp_rotation({0.3, -0.2, 0.5}), 1e-12));
}

TEST(GuardedMotion, ValuesOfTheRequestReplaceThoseOfTheConfiguration) {
  Cell cell;
  TouchRequest request = Cell::request();
  request.speed = 0.01;
  request.retreat = 0.004;
  cell.motion().begin(request);
  cell.run();
  ASSERT_EQ(cell.report().state, TouchState::kTouched) << cell.reason();
  EXPECT_NEAR(cell.most_speed, 0.01, 1e-9);
  EXPECT_NEAR(cell.travel(), 0.016, 2e-4);
}

TEST(GuardedMotion, NeverBacksOffBeyondItsStart) {
  Cell cell;
  cell.surface = 0.004;
  cell.motion().begin(Cell::request());
  cell.run();
  ASSERT_EQ(cell.report().state, TouchState::kTouched) << cell.reason();
  EXPECT_GT(cell.least_travel, -2e-4);
  EXPECT_LT(cell.travel(), 2e-4);
}

TEST(GuardedMotion, WithoutContactTheHandStaysAtTheEndOfTheLine) {
  Cell cell;
  cell.surface = 1;
  TouchRequest request = Cell::request();
  request.distance = 0.015;
  cell.motion().begin(request);
  cell.run();
  EXPECT_EQ(cell.report().state, TouchState::kNoContact);
  EXPECT_NE(cell.reason(), "");
  EXPECT_NEAR(cell.travel(), 0.015, 2e-4);
  EXPECT_LT(cell.report().point_deviation, 0);
}

TEST(GuardedMotion, AcceleratesWithinItsLimitUntilTheEnd) {
  Cell cell;
  cell.surface = 1;
  cell.motion().begin(Cell::request());
  cell.run(1.5);
  EXPECT_LE(cell.largest_change, 0.05 * (1 + 1e-9));
}

TEST(GuardedMotion, AStiffSurfaceIsReportedWithoutDeviation) {
  Cell cell;
  cell.stiffness = 1e6;
  cell.motion().begin(Cell::request());
  cell.run();
  ASSERT_TRUE(cell.report().state == TouchState::kTouched ||
              cell.report().state == TouchState::kStopped);
  EXPECT_LT(cell.report().point_deviation, 0);
  EXPECT_NE(cell.reason(), "");
}

TEST(GuardedMotion, AForceAboveItsLimitMakesTheHandBackOff) {
  GuardedMotion::Options options = Cell::defaults();
  options.force_limit = 0.3;
  options.force_smoothing = 0.5;  // so slow that the limit comes first
  Cell cell(options);
  cell.motion().begin(Cell::request(0.25));
  cell.run();
  EXPECT_EQ(cell.report().state, TouchState::kStopped);
  EXPECT_NE(cell.reason().find("force_limit"), std::string::npos) << cell.reason();
  EXPECT_LT(cell.largest_force, 0.45);
  EXPECT_LT(cell.travel(), cell.surface);
}

TEST(GuardedMotion, StopsWhereItIs) {
  struct Case {
    const char* name;
    void (*disturb)(Cell&);
    const char* reason;
  };
  const Case cases[] = {
      {"cancelled", [](Cell& cell) { cell.motion().stop("cancelled"); }, "cancelled"},
      {"stale", [](Cell& cell) { cell.usable = false; }, "too old"},
      {"rejected",
       [](Cell& cell) {
         cell.rejected = true;
         cell.gate_reason = "contact force or torque is above its limit";
       },
       "above its limit"},
      {"wall",
       [](Cell& cell) {
         cell.obeys = false;
         cell.gate_reason = "workspace";
       },
       "limited by the gate: workspace"},
      {"blocked", [](Cell& cell) { cell.obeys = false; }, "does not follow"},
      {"not finite", [](Cell& cell) { cell.offset_W.x() = cell.offset_W.z() = std::nan(""); },
       "not finite"},
      {"reset", [](Cell& cell) { cell.motion().reset(); }, "reset"},
  };
  for (const Case& one : cases) {
    Cell cell;
    cell.motion().begin(Cell::request());
    cell.run(2);
    ASSERT_EQ(cell.report().state, TouchState::kApproaching) << one.name;
    one.disturb(cell);
    const double before = cell.travel();
    cell.run();
    EXPECT_EQ(cell.report().state, TouchState::kStopped) << one.name;
    EXPECT_NE(cell.reason().find(one.reason), std::string::npos)
        << one.name << ": " << cell.reason();
    EXPECT_NEAR(cell.travel(), before, 1e-5) << one.name;
    EXPECT_TRUE(cell.motion().advance({}).isZero(0)) << one.name;
  }
}

TEST(GuardedMotion, WaitsForUsableInputsForASecond) {
  Cell cell;
  cell.usable = false;
  cell.motion().begin(Cell::request());
  cell.run(0.5);
  EXPECT_EQ(cell.report().state, TouchState::kWaiting);
  cell.usable = true;
  cell.run();
  EXPECT_EQ(cell.report().state, TouchState::kTouched);
  cell.usable = false;
  cell.motion().begin(Cell::request());
  cell.run();
  EXPECT_EQ(cell.report().state, TouchState::kStopped);
  EXPECT_EQ(cell.reason(), "too old");
}

TEST(GuardedMotion, RefusesWhatItCannotDo) {
  Cell cell;
  const auto refused = [&](auto change) {
    TouchRequest request = Cell::request();
    change(request);
    const std::string reason = cell.motion().begin(request);
    EXPECT_EQ(cell.report().state, TouchState::kIdle) << reason;
    return reason;
  };
  EXPECT_NE(refused([](TouchRequest& r) { r.direction_W.setZero(); }), "");
  EXPECT_NE(refused([](TouchRequest& r) { r.direction_W.x() = std::nan(""); }), "");
  EXPECT_NE(refused([](TouchRequest& r) { r.force = 0; }), "");
  EXPECT_NE(refused([](TouchRequest& r) { r.force = std::nan(""); }), "");
  EXPECT_NE(refused([](TouchRequest& r) { r.force = 3.1; }).find("force_limit"), std::string::npos);
  EXPECT_NE(refused([](TouchRequest& r) { r.speed = 0.2; }).find("gate.linear_speed"),
            std::string::npos);
  EXPECT_NE(refused([](TouchRequest& r) { r.speed = -0.01; }), "");
  EXPECT_NE(refused([](TouchRequest& r) { r.distance = 2; }), "");
  EXPECT_NE(refused([](TouchRequest& r) { r.retreat = -1; }), "");
  EXPECT_STREQ(cell.motion().begin(Cell::request()), "");
  EXPECT_STRNE(cell.motion().begin(Cell::request()), "") << "one at a time";
}

TEST(GuardedMotion, CorrectsTheDelayOfTheForce) {
  // The force of 20 ms ago, at 5 mm/s: without correction the surface seems 0.1 mm further away.
  double found[2] = {};
  for (const bool corrected : {false, true}) {
    GuardedMotion::Options options = Cell::defaults();
    options.force_delay = corrected ? 0.02 : 0;
    GuardedMotion motion(options, 0.1);
    motion.begin(Cell::request());
    Vector3d position = Vector3d::Zero();
    std::array<double, 20> delayed{};
    for (int tick = 0; tick < 60000 && motion.is_running(); ++tick) {
      GuardedMotion::Inputs inputs;
      inputs.is_usable = true;
      inputs.X_WG.translation() = position - options.tip_G;
      const double depth = -position.z() - 0.02;
      std::swap(inputs.force_W.z(), delayed[static_cast<std::size_t>(tick % 20)]);
      delayed[static_cast<std::size_t>(tick % 20)] = depth > 0 ? -2780 * std::pow(depth, 1.5) : 0;
      position += 1e-3 * motion.advance(inputs);
    }
    ASSERT_EQ(motion.report().state, TouchState::kTouched);
    found[corrected ? 1 : 0] = -motion.report().centre_W.z();
  }
  EXPECT_NEAR(found[0], 0.0201, 2e-5);
  EXPECT_NEAR(found[1], 0.02, 2e-5);
}

TEST(GuardedMotion, OptionsAreChecked) {
  const auto error_of = [](auto change) -> std::string {
    GuardedMotion::Options options;
    change(options);
    try {
      GuardedMotion motion(options, 0.1);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(error_of([](auto&) {}), "");
  EXPECT_NE(error_of([](auto& o) { o.speed = 0.2; }).find("gate.linear_speed"), std::string::npos);
  EXPECT_NE(error_of([](auto& o) { o.tip_radius = -1; }).find("tip_radius"), std::string::npos);
  EXPECT_NE(error_of([](auto& o) { o.fit.exponent = 9; }).find("exponent"), std::string::npos);
}

}  // namespace
}  // namespace palpate::control

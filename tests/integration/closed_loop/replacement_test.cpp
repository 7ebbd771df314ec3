#include <algorithm>

#include "tests/integration/closed_loop/closed_loop.hpp"

namespace palpate {
namespace {

const char* const kReplacementScene = "sim/scenes/bar_long_soft_control.yaml";
const char* const kReplacementConfiguration = "rt/config/examples/bar_long_soft.yaml";
constexpr double kGateAcceleration = 0.5;  // m/s^2, of the configuration

struct Replace {
  const char* slot;
  const char* component;
  const char* parameters;
};

/// There and back, while the loop controls a point of the bar.
struct Pair {
  const char* name;
  Replace there, back;
  std::vector<std::string> overrides;
};

void PrintTo(const Pair& pair, std::ostream* out) { *out << pair.name; }

class ReplacementPair : public testing::TestWithParam<Pair> {
 protected:
  void prepare() {
    loop_ = std::make_unique<ClosedLoop>(kReplacementScene, kReplacementConfiguration,
                                         std::vector<std::string>{}, GetParam().overrides);
    loop_->run(0.1);
    loop_->send_event("start");
    loop_->run(0.6);
    const Eigen::Vector3d rest_point = loop_->daemon().pipeline().feature().rest_points()[0];
    loop_->send_target("point", Eigen::Vector3d(rest_point + Eigen::Vector3d(0, 0, 0.03)));
    loop_->run(0.4);
    loop_->take_events();
    forget_twists();
  }
  void forget_twists() {
    twist_command_t twist;
    std::int64_t arrival_ns = 0;
    while (loop_->twists().take(twist, arrival_ns)) last_ = twist;
  }
  /// Continues and checks every command: finite, valid, and within the gate's acceleration of the
  /// previous one.
  double largest_step(double seconds) {
    double largest = 0;
    loop_->run(seconds, [&] {
      twist_command_t twist;
      std::int64_t arrival_ns = 0;
      while (loop_->twists().take(twist, arrival_ns)) {
        const Eigen::Map<const Eigen::Vector3d> now(twist.twist), before(last_.twist);
        largest = std::max(largest, (now - before).norm());
        last_ = twist;
      }
    });
    return largest;
  }
  std::string replace(const Replace& what) {
    loop_->send_replace(what.slot, what.component, what.parameters);
    largest_ = std::max(largest_, largest_step(1.0));
    std::string all;
    for (const std::string& event : loop_->take_events()) all += event + "\n";
    return all;
  }

  std::unique_ptr<ClosedLoop> loop_;
  twist_command_t last_{};
  double largest_ = 0;
};

TEST_P(ReplacementPair, ThereAndBackWithoutAJump) {
  prepare();
  const Eigen::Matrix3Xd before = loop_->daemon().pipeline().model().positions();
  EXPECT_NE(replace(GetParam().there).find("replaced: "), std::string::npos);
  EXPECT_EQ(loop_->daemon().replacing().replaced(), 1);
  EXPECT_TRUE(loop_->daemon().pipeline().is_running())
      << loop_->daemon().pipeline().condition().reason;
  EXPECT_NE(replace(GetParam().back).find("replaced: "), std::string::npos);
  EXPECT_EQ(loop_->daemon().replacing().replaced(), 2);
  EXPECT_EQ(loop_->daemon().pipeline().model().positions().cols(), before.cols());
  EXPECT_LE(largest_, 1.02e-3 * kGateAcceleration) << "m/s in a tick";
  EXPECT_GE(loop_->daemon().pipeline().target().revision, 1) << "the target was lost";
  // The restored component continues as if nothing had happened.
  loop_->run(4.0);
  const Eigen::Vector3d rest_point = loop_->daemon().pipeline().feature().rest_points()[0];
  const Eigen::Vector3d truth = loop_->simulation().plant().position_at(rest_point);
  EXPECT_LT((truth - rest_point - Eigen::Vector3d(0, 0, 0.03)).norm(), 5e-3);
}

// Its memory, freed by then, is not accessed either.
TEST(ReplacementLoop, WhatOnlyTheLastEstimatorKnewIsNotPublished) {
  ClosedLoop loop(kReplacementScene, kReplacementConfiguration, {},
                  {"estimation={component: pose_wrench_filter}"});
  loop.send_event("start");
  loop.run(0.5);
  const estimation::Estimate& estimate = loop.daemon().pipeline().estimate();
  ASSERT_GT(estimate.pose_deviation[0].minCoeff(), 0);
  ASSERT_NE(estimate.node_deviation, nullptr);
  loop.send_replace("estimation", "pose_driven", "");
  loop.run(1.0);
  ASSERT_EQ(loop.daemon().replacing().replaced(), 1);
  const estimation::Estimate& now = loop.daemon().pipeline().estimate();
  EXPECT_EQ(now.node_deviation, nullptr);
  EXPECT_LT(now.pose_deviation[0].maxCoeff(), 0);
  EXPECT_LT(now.reaction_deviation[0].maxCoeff(), 0);
  EXPECT_LT(now.innovation_test, 0);
}

const Pair kPairs[] = {
    {"linear_to_quadratic",
     {"object", "", "order: linear"},
     {"object", "", "order: quadratic"},
     {}},
    {"coarser_mesh",
     {"object", "", "mesh: {box: {size: [0.5, 0.06, 0.06], cells: [6, 1, 1]}}"},
     {"object", "", "mesh: {box: {size: [0.5, 0.06, 0.06], cells: [10, 1, 1]}}"},
     {}},
    {"dynamic",
     {"deformation", "corotational_dynamic", ""},
     {"deformation", "corotational_quasistatic", ""},
     {}},
    {"force_driven",
     {"estimation", "force_driven", "variant: repaired"},
     {"estimation", "pose_driven", ""},
     {}},
#ifdef PALPATE_HAS_BASELINES
    {"as_rigid_as_possible",
     {"deformation", "as_rigid_as_possible", ""},
     {"deformation", "corotational_quasistatic", ""},
     {"plugins=[{library: palpate-baselines.so}]"}},
#endif
    {"filter", {"estimation", "pose_wrench_filter", ""}, {"estimation", "pose_driven", ""}, {}},
    {"quadratic_program",
     {"control", "", "law: quadratic_program"},
     {"control", "", "law: proportional_twist"},
     {}},
    {"kinematic", {"control", "", "provider: kinematic"}, {"control", "", "provider: fem"}, {}},
    {"tare_only",
     {"sensing", "ft_tare_only", "tare_at_start: true"},
     {"sensing", "ft_newton_euler", "payload: {mass: 4.8, center_of_mass: [0, 0, 0.11]}"},
     {}},
    {"all_at_once",
     {"all", "",
      "{object: {order: linear}, deformation: {component: corotational_dynamic}, "
      "control: {provider: kinematic}}"},
     {"all", "",
      "{object: {order: quadratic}, deformation: {component: corotational_quasistatic}, "
      "control: {provider: fem}}"},
     {}},
};

INSTANTIATE_TEST_SUITE_P(Pairs, ReplacementPair, testing::ValuesIn(kPairs),
                         [](const auto& of_pair) { return of_pair.param.name; });

class Refusal : public testing::TestWithParam<Replace> {};

TEST_P(Refusal, LeavesWhatRunsAlone) {
  const Replace what = GetParam();
  std::vector<Eigen::Matrix3Xd> shapes;
  std::string events;
  for (const bool ask : {false, true}) {
    ClosedLoop loop(kReplacementScene, kReplacementConfiguration);
    loop.send_event("start");
    loop.run(0.5);
    loop.take_events();
    if (ask) loop.send_replace(what.slot, what.component, what.parameters);
    loop.run(0.5);
    if (ask)
      for (const std::string& event : loop.take_events()) events += event + "\n";
    EXPECT_EQ(loop.daemon().replacing().replaced(), 0);
    shapes.push_back(loop.daemon().pipeline().model().positions());
  }
  std::printf("%s", events.c_str());
  EXPECT_NE(events.find("refused: "), std::string::npos);
  EXPECT_TRUE((shapes[0].array() == shapes[1].array()).all()) << "to the bit";
}

const Replace kRefused[] = {
    {"slot", "", "a: 1"},
    {"gate", "", "force: 100"},
    {"all", "", "gate: {force: 100}"},
    {"all", "", "loop: {rate: 500}"},
    {"deformation", "corotational_dynamic", "iterations: 1000"},
    {"deformation", "corotational_dynamic", "iteration: 3"},
    {"deformation", "corotational_dynamic", "{iterations: 3"},
    {"deformation", "no_such_model", ""},
    {"deformation", "", ""},
    {"object", "", "mesh: {box: {size: [1.5, 0.06, 0.06], cells: [10, 1, 1]}}"},
    {"object", "", "mesh: {file: no_such_file.msh}"},
    {"object", "", "material: {young_modulus: .nan}"},
    {"sensing", "biotac_lstm", "{finger: 0, model_file: no_such_model.pt}"},
};

INSTANTIATE_TEST_SUITE_P(Cases, Refusal, testing::ValuesIn(kRefused));

TEST(Replacements, OneAtATime) {
  ClosedLoop loop(kReplacementScene, kReplacementConfiguration);
  loop.send_replace("control", "", "gain: 0.5");
  loop.send_replace("control", "", "gain: 0.7");
  loop.run(0.6);
  std::string events;
  for (const std::string& event : loop.take_events()) events += event + "\n";
  EXPECT_NE(events.find("refused: another replacement is under way"), std::string::npos) << events;
  EXPECT_EQ(loop.daemon().replacing().replaced(), 1) << events;
}

}  // namespace
}  // namespace palpate

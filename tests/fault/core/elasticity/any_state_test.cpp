// From an arbitrary state: nodes anywhere within three times the size of the body, and forces a
// hundred times the bearable ones. A long run:
//   PALPATE_FAULT_STATES=100000 bin/fault_core_elasticity

#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>

#include "core/elasticity/corotational_model.hpp"
#include "core/math/random.hpp"
#include "core/mesh/tetrahedral_mesh.hpp"

namespace palpate::elasticity {
namespace {

constexpr int kMostSteps = 500;
constexpr double kDt = 1e-3, kRest = 0.01;  // s, relative to the body's size

long states() {
  const char* text = std::getenv("PALPATE_FAULT_STATES");
  return text == nullptr ? 200 : std::max(1L, std::atol(text));
}

Body bar(mesh::ElementOrder order) {
  Body body;
  body.mesh = mesh::make_element_mesh(mesh::make_box({0.12, 0.06, 0.06}, {2, 1, 1}), order);
  body.material.young_modulus = 30e3;
  for (int n = 0; n < body.mesh.node_count(); ++n)
    if (body.mesh.nodes(0, n) == 0) body.fixed_nodes.push_back(n);
  return body;
}

/// One step, and the factorisation that it may request, as a worker computes it between two steps.
/// Returns whether the model reset its shape.
bool step(DeformationModel& model) {
  const StepReport report = model.step(kDt);
  if (Refactorisation* wanted = model.wanted_refactorisation()) {
    wanted->run();
    model.install(*wanted);
  }
  return report.restarted;
}

struct Outcome {
  long not_finite = 0;
  long restless = 0;
  long restarted = 0;
  int slowest = 0;  // steps to rest
};

/// Releases the body and waits for rest, without loads.
void settle(DeformationModel& model, Outcome& outcome) {
  const Eigen::Matrix3Xd& rest = model.body().mesh.nodes;
  const double near = kRest * (rest.rowwise().maxCoeff() - rest.rowwise().minCoeff()).norm();
  model.loads().setZero();
  bool finite = true, at_rest = false, restarted = false;
  for (int k = 1; k <= kMostSteps && finite && !at_rest; ++k) {
    restarted |= step(model);
    finite = model.positions().allFinite() && model.velocities().allFinite();
    at_rest = (model.positions() - rest).colwise().norm().maxCoeff() <= near;
    if (at_rest) outcome.slowest = std::max(outcome.slowest, k);
  }
  outcome.not_finite += finite ? 0 : 1;
  outcome.restless += at_rest ? 0 : 1;
  outcome.restarted += restarted ? 1 : 0;
}

class AnyState : public ::testing::TestWithParam<mesh::ElementOrder> {
 protected:
  void judge(const Outcome& outcome) {
    std::cout << states() << " states, " << outcome.restless << " not at rest after " << kMostSteps
              << " steps, the others after " << outcome.slowest << " at most; " << outcome.restarted
              << " from a new start\n";
    EXPECT_EQ(outcome.not_finite, 0);
    EXPECT_LE(static_cast<double>(outcome.restless), 1e-3 * static_cast<double>(states()));
    EXPECT_GE(outcome.restarted, states() / 20) << "states that are too easy";
  }
  const Body body_ = bar(GetParam());
  const double size_ = body_.mesh.nodes.rowwise().maxCoeff().norm();
  math::Random random_{7, "any state"};
};

TEST_P(AnyState, NodesAnywhereComeBack) {
  CorotationalQuasistatic model(body_);
  model.prepare();
  Outcome outcome;
  for (long state = 0; state < states(); ++state) {
    Eigen::Matrix3Xd x = body_.mesh.nodes;
    const double reach = random_.uniform(0, 3) * size_;
    for (double& coordinate : x.reshaped()) coordinate += random_.uniform(-reach, reach);
    for (const int n : body_.fixed_nodes) x.col(n) = body_.mesh.nodes.col(n);
    ASSERT_TRUE(model.restore(x, Eigen::Matrix3Xd::Zero(3, x.cols())));
    settle(model, outcome);
    model.reset();
  }
  judge(outcome);
}

TEST_P(AnyState, AHundredTimesTheForceLeavesNumbersAndAWayBack) {
  CorotationalQuasistatic model(body_);
  model.prepare();
  // A hundred times the load that stretches the bar by a tenth of its length.
  const double force = 100 * 0.1 * body_.material.young_modulus * 0.06 * 0.06;
  Outcome outcome;
  for (long state = 0; state < states(); ++state) {
    Eigen::Matrix3Xd& loads = model.loads();
    for (int n = 0; n < loads.cols(); ++n)
      for (int axis = 0; axis < 3; ++axis)
        loads(axis, n) = random_.uniform(-force, force) / static_cast<double>(loads.cols());
    for (int k = 0; k < 10; ++k) {
      step(model);
      if (!model.positions().allFinite()) ++outcome.not_finite;
    }
    settle(model, outcome);
    model.reset();
  }
  judge(outcome);
}

INSTANTIATE_TEST_SUITE_P(Orders, AnyState,
                         ::testing::Values(mesh::ElementOrder::kLinear,
                                           mesh::ElementOrder::kQuadratic));

}  // namespace
}  // namespace palpate::elasticity

// The example of each slot (tools/examples/plugin) in the pipeline of the example's bar.

#include <cmath>

#include "tests/unit/rt/plugin/plugged_pipeline.hpp"

namespace palpate::plugin {
namespace {

const std::string kExamples = std::string("plugins=[{library: ") + PALPATE_EXAMPLE_PLUGINS + "}]";

void expect_active(const Running& running) {
  EXPECT_EQ(running.pipeline.condition().state, pipeline::LifeCycle::kActive)
      << running.pipeline.condition().reason;
}

TEST(Examples, EachSteersTheBarInItsSlot) {
  for (const char* setting :
       {"sensing=[{component: ft_median, tare_samples: 10}]",
        "contact=[{component: nearest_nodes}]", "estimation={component: smoothed_hand}",
        "deformation={component: blended}", "control={provider: fem, law: integral_twist}",
        "control={provider: smoothed_fem, law: proportional_twist}"}) {
    Running running({kExamples, "sensing=[]", setting});
    running.run(100);
    expect_active(running);
    EXPECT_GT(running.speed, 1e-4) << setting;
  }
}

TEST(Examples, TheMidpointLiesBetweenItsNodes) {
  const pipeline::Pipeline pipeline(
      example({kExamples,
               "feature={component: midpoint, first: [0.2, 0.03, 0.06], second: [0.3, "
               "0.03, 0.06]}"}),
      1e-3);
  const shape::Feature& feature = pipeline.feature();
  const Eigen::Matrix3Xd& positions = pipeline.model().positions();
  ASSERT_EQ(feature.support().size(), 2u);
  const Eigen::Vector3d middle =
      0.5 * (positions.col(feature.support()[0]) + positions.col(feature.support()[1]));
  EXPECT_LT((pipeline.feature_state().value - middle).norm(), 1e-12);
  EXPECT_LT((middle - Eigen::Vector3d(0.25, 0.03, 0.06)).norm(), 0.02);
  EXPECT_EQ(feature.jacobian().rows(), 3);
  EXPECT_NEAR(feature.jacobian().sum(), 3, 1e-12);
}

TEST(Examples, OptionsOutOfRangeAreRefusedWithTheirMeaning) {
  expect_complaint({kExamples, "contact=[{component: nearest_nodes, nodes: 17}]"},
                   {"contact.0.nodes", "1 to 16", "number of nodes that share a force"});
  expect_complaint({kExamples, "feature={component: midpoint, first: [0, 0, 0]}"},
                   {"feature.second", "point of the rest shape"});
  expect_complaint({kExamples, "control={provider: smoothed_fem, time_constant_ms: -1}"},
                   {"control.time_constant_ms", "0 to 10000", "time constant"});
  expect_complaint({kExamples, "sensing=[{component: ft_median, samples: 4}]"},
                   {"sensing.0.component", "samples must be odd"});
}

}  // namespace
}  // namespace palpate::plugin

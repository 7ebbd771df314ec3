#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/recordings.hpp"
#include "tools/fit/experiments/beam.hpp"
#include "tools/fit/experiments/beam_model.hpp"

namespace palpate::fit {
namespace {

/// With the constants identified by palpate-fit from all recordings together, the silicone beam
/// comes to rest within 1 mm, with 5 % error of the period and 20 % of the decay.
TEST(BeamRecordings, OneMaterialExplainsRestAndSwing) {
  PALPATE_REQUIRE_RECORDING("beam_dragonskin/gravity_a.csv");
  const std::string preset =
      std::string(PALPATE_SOURCE_DIR) + "/tools/fit/presets/beam_dragonskin.yaml";
  const std::vector<config::Node> nodes = config::Node::load_file(preset).list("recordings");
  ASSERT_EQ(nodes.size(), 3u);
  Eigen::VectorXd light(kBeamParameters), loaded(kBeamParameters);
  light << 3.023e5, 0.499, 1070, 2.04, 1.342e-3, 0, 0.0019, -0.003, 0, 0, 0, 0.0024, 0.165;
  loaded << 3.023e5, 0.499, 1070, 2.04, 1.342e-3, 0.0028, 0.0143, 0.0077, 3e-4, 0, 0, 0.0178, 0.268;
  for (int k : {0, 2}) {
    const auto beam = make_beam(nodes[k], support::recordings());
    const std::vector<Finding> findings = beam->findings(k == 0 ? light : loaded);
    ASSERT_EQ(findings.size(), 4u);
    for (const Finding& f : findings) {
      EXPECT_LE(std::abs(f.predicted - f.measured), f.allowed) << beam->name() << " " << f.what;
    }
  }
}

}  // namespace
}  // namespace palpate::fit

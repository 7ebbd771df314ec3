#include "core/solid/solid_indentation.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::solid {
namespace {

/// Johnson, Contact Mechanics, 1985, eq. 4.23.
double hertz(double depth, double nu) { return 4.0 / 3 / (1 - nu * nu) * std::pow(depth, 1.5); }

TEST(SolidIndentation, IsHertzAtSmallDepthOnAThickLayer) {
  for (double nu : {0.3, 0.499}) {
    const IndentationCurve curve =
        indent_layer(make_solid_material(1, nu).coefficients, 20, {0.1, 3, 0.06});
    ASSERT_EQ(curve.depth.size(), 3);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(curve.force[k] / hertz(curve.depth[k], nu), 1, 0.04) << curve.depth[k];
    }
  }
}

/// Refinement hardly changes the result, deep in a thin layer.
TEST(SolidIndentation, DoesNotDependOnItsMesh) {
  const SolidCoefficients c = make_solid_material(1, 0.49).coefficients;
  const IndentationCurve coarse = indent_layer(c, 4, {0.8, 4, 0.08});
  const IndentationCurve fine = indent_layer(c, 4, {0.8, 4, 0.05});
  ASSERT_EQ(coarse.force.size(), 4);
  ASSERT_EQ(fine.force.size(), 4);
  for (int k = 1; k < 4; ++k) {
    EXPECT_NEAR(coarse.force[k] / fine.force[k], 1, 0.01);
  }
}

/// Dimitriadis et al. (Biophysical Journal 82, 2002), eq. 8: a bonded incompressible layer at small
/// strain, by the ratio of contact radius to thickness.
TEST(SolidIndentation, ThinLayersAreStifferAsTheyShouldBe) {
  const double thickness = 2, nu = 0.4995;
  const IndentationCurve curve =
      indent_layer(make_solid_material(1, nu).coefficients, thickness, {0.1, 3, 0.04});
  ASSERT_EQ(curve.depth.size(), 3);
  for (int k = 0; k < 3; ++k) {
    const double chi = std::sqrt(curve.depth[k]) / thickness;
    const double factor =
        1 + 1.133 * chi + 1.283 * chi * chi + 0.769 * std::pow(chi, 3) + 0.0975 * std::pow(chi, 4);
    if (k > 0) {
      EXPECT_NEAR(curve.force[k] / hertz(curve.depth[k], 0.5) / factor, 1, 0.05) << chi;
    }
  }
}

TEST(SolidIndentation, RefusesWhatIsNoLayer) {
  EXPECT_THROW(indent_layer(make_solid_material(1, 0.3).coefficients, 0), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::solid

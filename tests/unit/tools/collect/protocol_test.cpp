#include "tools/collect/protocol.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/sensing/biotac_geometry.hpp"

namespace palpate::collect {
namespace {

TEST(Protocol, IsThatOfTheThesis) {
  const std::vector<Trial> trials = make_trials(Profiles::kThesis);
  ASSERT_EQ(trials.size(), 7u * 9 * 3 * 5);
  EXPECT_EQ(make_trials(Profiles::kExtended).size(), 2 * trials.size());
  for (std::size_t i = 0; i < trials.size(); ++i) {
    EXPECT_EQ(trials[i].number, static_cast<int>(i));
    EXPECT_LE(trials[i].profile.force, 0.4);
    EXPECT_EQ(trials[i].profile.shear, 0);
  }
}

TEST(Protocol, ForceIsHeldForThreeSecondsAndLetGo) {
  EXPECT_EQ(envelope(0), 0);
  EXPECT_EQ(envelope(kRest), 0);
  EXPECT_EQ(envelope(kRest + kApproach), 1);
  EXPECT_EQ(envelope(kRest + kApproach + kHold), 1);
  EXPECT_EQ(envelope(kTrialTime), 0);
}

// A sphere on a cylinder approximated by a sphere: the load of the indented foundation is the
// force.
TEST(Protocol, TouchGrowsAsTheFoundationSays) {
  const Probe sphere{"", ProbeShape::kSphere, 5e-3};
  const double foundation = 3e7, force = 0.7;
  const double a = contact_radius(sphere, force, foundation);
  const double curvature = 1 / sensing::kSkinRadius + 1 / sphere.radius;
  double load = 0;
  const int rings = 10000;
  for (int i = 0; i < rings; ++i) {
    const double r = a * (i + 0.5) / rings;
    load += foundation * 0.5 * curvature * (a * a - r * r) * 2 * M_PI * r * a / rings;
  }
  EXPECT_NEAR(load, force, 1e-5);
  const Probe flat{"", ProbeShape::kFlat, 3e-3}, hollow{"", ProbeShape::kConcave, 10e-3};
  EXPECT_LT(a, contact_radius({"", ProbeShape::kFlat, 1}, force, foundation));
  EXPECT_EQ(contact_radius(flat, 1e3, foundation), 3e-3);
  EXPECT_GT(contact_radius(hollow, force, foundation),
            contact_radius({"", ProbeShape::kFlat, 1}, force, foundation));
}

}  // namespace
}  // namespace palpate::collect

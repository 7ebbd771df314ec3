#include "tools/common/discrepancy_text.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace palpate::common {
namespace {

/// A message with one explanation: sizes 3-4-0 and 0-0-1 times `scale`, at (0.21, 0, -0.03) m.
discrepancy_t explained_by(int cause, double scale) {
  discrepancy_t message{};
  message.cause_count = 1;
  message.cause[0] = cause;
  message.cause_hand[0] = 1;
  message.location[0][0] = 0.21;
  message.location[0][2] = -0.03;
  message.value[0][0] = 3 * scale;
  message.value[0][1] = 4 * scale;
  message.value[0][5] = scale;
  return message;
}

std::string text_of(int cause, double scale) {
  return explanation_text(explained_by(cause, scale), 0);
}

TEST(DiscrepancyText, NamesCausePlaceAndSize) {
  using D = discrepancy_t;
  EXPECT_EQ(text_of(D::CAUSE_CONTACT, 0.1),
            "external contact near (0.210, 0.000, -0.030) m, 0.50 N");
  EXPECT_EQ(text_of(D::CAUSE_WEIGHT, 0.2),
            "additional weight near (0.210, 0.000, -0.030) m, 1.00 N");
  EXPECT_EQ(text_of(D::CAUSE_SLIP, 0.01), "slip in hand 1 by 50.0 mm, 0.6 deg");
  EXPECT_EQ(text_of(D::CAUSE_CLAMP_PLACE, 1e-3), "clamp displaced by 5.0 mm, 0.1 deg");
  EXPECT_EQ(text_of(D::CAUSE_SENSOR_BIAS, 0.1), "sensor bias of hand 1, 0.50 N, 100.0 mN m");
  EXPECT_EQ(text_of(D::CAUSE_UNKNOWN, 1), "none of the known causes");
}

TEST(DiscrepancyText, ComplianceIsOfDisplacementAndRotation) {
  discrepancy_t message = explained_by(discrepancy_t::CAUSE_CLAMP_COMPLIANCE, 0);
  message.value[0][0] = 2e-3;  // m/N
  message.value[0][1] = 0.1;   // rad/(N m)
  EXPECT_EQ(explanation_text(message, 0), "compliant clamp, 2.00 mm/N, 5.73 deg/(N m)");
}

TEST(DiscrepancyText, StiffnessIsAFactorOfTheNominalOne) {
  discrepancy_t message = explained_by(discrepancy_t::CAUSE_UNEVEN_STIFFNESS, 0);
  message.value[0][0] = std::log(0.5);
  message.value[0][1] = std::log(2);
  EXPECT_EQ(explanation_text(message, 0),
            "uneven stiffness, 0.50 times nominal at the clamp, 2.00 times at the hand");
}

TEST(DiscrepancyText, NamesTheComponentThatDiffersMost) {
  discrepancy_t message{};
  message.axis = 2;
  EXPECT_EQ(component_text(message), "force of hand 0 along z");
  message.axis = 3;
  message.hand = 1;
  EXPECT_EQ(component_text(message), "torque of hand 1 about x");
}

TEST(DiscrepancyText, WhateverAMessageContainsIsInRange) {
  discrepancy_t message{};
  message.cause_count = std::numeric_limits<int>::max();
  EXPECT_EQ(explanation_count(message), 8);
  message.cause_count = -3;
  EXPECT_EQ(explanation_count(message), 0);
  message.axis = std::numeric_limits<int>::min();
  EXPECT_EQ(component_text(message), "force of hand 0 along x");
  EXPECT_EQ(text_of(99, 1), "none of the known causes");
}

}  // namespace
}  // namespace palpate::common

#include "core/estimation/rest_baseline.hpp"

#include <gtest/gtest.h>

namespace palpate::estimation {
namespace {

/// Innovation of the hands `held` whose rows all equal `value`.
Innovation innovation(double value, std::array<bool, 2> held = {true, false}) {
  const int rows = 6 * (static_cast<int>(held[0]) + static_cast<int>(held[1]));
  Innovation result;
  result.held = held;
  result.H = WrenchFilter::Rows::Ones(rows, 16);
  result.y = WrenchFilter::Wrenches::Constant(rows, value);
  result.R = WrenchFilter::Noise::Identity(rows, rows);
  result.measured = WrenchFilter::Wrenches::Constant(rows, value + 5);
  return result;
}

class RestBaselineTest : public ::testing::Test {
 protected:
  void rest(double seconds, double value, std::array<bool, 2> held = {true, false}) {
    for (int i = 0; i < sampling_.updates_in(seconds); ++i) {
      baseline_.accumulate(innovation(value, held));
      baseline_.extend(innovation(value, held));
    }
  }

  WrenchSampling sampling_;
  RestBaseline baseline_{sampling_};
};

TEST_F(RestBaselineTest, IsEstablishedAfterEightTenthsOfASecondForTheSameHands) {
  rest(0.7, 1);
  EXPECT_FALSE(baseline_.is_established());
  rest(0.2, 1);
  EXPECT_TRUE(baseline_.is_established());
  EXPECT_TRUE(baseline_.is_established({true, false}));
  EXPECT_FALSE(baseline_.is_established({true, true}));
  baseline_.forget();
  EXPECT_FALSE(baseline_.is_established());
}

TEST_F(RestBaselineTest, OtherHandsBeginAnotherBaseline) {
  rest(1, 1);
  baseline_.accumulate(innovation(2, {true, true}));
  EXPECT_FALSE(baseline_.is_established());
  EXPECT_EQ(baseline_.latest_change().size(), 12);
}

TEST_F(RestBaselineTest, AChangeIsRelativeToTheMeanAtRest) {
  rest(1, 3);
  EXPECT_TRUE(baseline_.latest_change().isZero(1e-12));
  EXPECT_TRUE(baseline_.measured().isApproxToConstant(8, 1e-12));
  baseline_.accumulate(innovation(4));
  EXPECT_TRUE(baseline_.latest_change().isApproxToConstant(1, 1e-12));
  const Innovation mean = baseline_.change(innovation(4), 13);
  EXPECT_TRUE(mean.y.isApproxToConstant(0.2, 1e-12));  // one of five updates in 50 ms
  EXPECT_TRUE(mean.H.leftCols(13).isZero(0));
  EXPECT_TRUE(mean.H.rightCols(3).isOnes(0));
  // noise of an exponential mean over five updates
  EXPECT_NEAR(mean.R(0, 0), sampling_.force * sampling_.force / 9, 1e-12);
  EXPECT_NEAR(mean.R(5, 5), sampling_.torque * sampling_.torque / 9, 1e-12);
}

TEST_F(RestBaselineTest, NoiseHasALowerBoundAndGrowsWithTheContact) {
  rest(1, 3);  // without any noise
  WrenchFilter::Wrenches pushed = WrenchFilter::Wrenches::Zero(6);
  const double least = 0.3 * sampling_.force;
  EXPECT_NEAR(baseline_.noise(pushed, 1)(0, 0), least * least, 1e-12);
  EXPECT_NEAR(baseline_.noise(pushed, 4)(0, 0), least * least / 4, 1e-12);
  pushed[1] = 2;  // N, of which 5 % are uncertain in each direction
  EXPECT_NEAR(baseline_.noise(pushed, 1)(0, 0), least * least + 0.01, 1e-12);
}

TEST_F(RestBaselineTest, ACorrectionOfTheStatesIsNoChange) {
  rest(1, 3);
  baseline_.follow(WrenchFilter::Wrenches::Constant(6, 2), false);
  baseline_.accumulate(innovation(1));
  EXPECT_TRUE(baseline_.latest_change().isZero(1e-12));
}

TEST_F(RestBaselineTest, TheForceOfAContactChangesTheRowsOfItsHand) {
  rest(1, 3, {true, true});
  baseline_.follow_contact(1, math::Vector6d::Constant(0.5));
  EXPECT_TRUE(baseline_.latest_change().head<6>().isZero(1e-12));
  EXPECT_TRUE(baseline_.latest_change().tail<6>().isApproxToConstant(-0.5, 1e-12));
  rest(1, 3, {false, true});  // the second hand alone
  baseline_.follow_contact(0, math::Vector6d::Constant(0.5));
  EXPECT_TRUE(baseline_.latest_change().isZero(1e-12));
  baseline_.follow_contact(1, math::Vector6d::Constant(0.5));
  EXPECT_TRUE(baseline_.latest_change().isApproxToConstant(-0.5, 1e-12));
}

}  // namespace
}  // namespace palpate::estimation

#include "core/estimation/consistency/wrench_states.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::estimation {
namespace {

using math::Vector6d;

const WrenchStates kStates{1};
constexpr double kMemory = 300;  // s

/// A hand on a spring, stiff along x, that stretches it by `stretch` (m) in the nominal model.
HandRecord record_of(double stretch, double travel = 0) {
  HandRecord hand;
  hand.valid = true;
  hand.H = HandRecord::Rows::Zero(6, kStates.count());
  Vector6d stiffness;
  stiffness << 1000, 10, 10, 0.1, 0.5, 0.5;
  for (const int first : {kStates.offset(0), kStates.pose_error(0)})
    hand.H.middleCols<6>(first).diagonal() = stiffness;
  hand.H.middleCols<6>(kStates.bias(0)).setIdentity();
  hand.H(0, kStates.log_young()) = 1000 * stretch;
  hand.y.setZero();
  hand.R = 1e-6 * math::Matrix6d::Identity();
  hand.size.setConstant(1000 * std::abs(stretch));
  hand.travel = travel;
  return hand;
}

WrenchKnowledge::Vector deviations(std::initializer_list<std::pair<int, double>> of_states) {
  WrenchKnowledge::Vector all = WrenchKnowledge::Vector::Constant(kStates.count(), 1e-9);
  for (const auto& [state, deviation] : of_states) all[state] = deviation;
  return all;
}

// The spring is 1.4 times as stiff as in the model and 2 mm longer: without the product of both,
// 0.8 N, no pair of values explains the wrenches.
TEST(WrenchKnowledge, ModulusAndOffsetAreFoundFromTheirProduct) {
  const double log_young = std::log(1.4), offset = -0.002;
  WrenchKnowledge known(
      kStates, deviations({{kStates.log_young(), 0.4}, {kStates.offset(0), 0.003}}), kMemory);
  const WrenchKnowledge::Appended none = WrenchKnowledge::Appended::Zero(6, 0);
  for (const double stretch : {0.0, 0.001, -0.004, 0.01}) {
    HandRecord hand = record_of(stretch);
    hand.y[0] = 1400 * (stretch + offset) - 1000 * stretch;
    known.correct(hand, none, hand.R);
    const WrenchKnowledge::Comparison again = known.compare(hand);
    ASSERT_TRUE(again.valid);
    EXPECT_LT(again.difference.norm(), 0.05) << stretch;
  }
  EXPECT_NEAR(known.mean()[kStates.log_young()], log_young, 0.01);
  EXPECT_NEAR(known.mean()[kStates.offset(0)], offset, 3e-5);
}

// A stiffness that differs along x alone is no contradiction within its deviation, whatever the
// size of the wrench; the same wrench across is one.
TEST(WrenchKnowledge, TheStiffnessOfADirectionHasAnErrorOfItsOwn) {
  const WrenchKnowledge known(kStates, deviations({{kStates.stiffness(0), 0.1}}), kMemory);
  HandRecord hand = record_of(0.02);
  hand.y[0] = 0.1 * 20;
  EXPECT_NEAR(known.compare(hand).squared, 1, 0.01);
  std::swap(hand.y[0], hand.y[1]);
  EXPECT_GT(known.compare(hand).squared, 1e6);
}

TEST(WrenchKnowledge, ErrorsThatVaryWithThePoseReturnToTheirDeviationsAsTheHandMoves) {
  const int error = kStates.wrench_error(0), pose = kStates.pose_error(0);
  WrenchKnowledge known(kStates, deviations({{error, 0.05}, {pose, 3e-4}}), kMemory);
  HandRecord hand = record_of(0.02);
  hand.y[0] = 1;
  known.correct(hand, WrenchKnowledge::Appended::Zero(6, 0), hand.R);
  const double learnt = known.mean()[error], left = known.covariance()(error, error);
  EXPECT_GT(learnt, 0.04);
  EXPECT_LT(left, 0.25 * 0.05 * 0.05);
  known.advance({record_of(0.02, 0.5), HandRecord()});
  EXPECT_NEAR(known.mean()[error], std::exp(-0.5) * learnt, 1e-12);
  EXPECT_NEAR(known.covariance()(error, error),
              std::exp(-1.0) * left + (1 - std::exp(-1.0)) * 0.05 * 0.05, 1e-12);
  known.advance({record_of(0.02, 50), HandRecord()});
  EXPECT_NEAR(known.mean()[error], 0, 1e-12);
  EXPECT_NEAR(std::sqrt(known.covariance()(error, error)), 0.05, 1e-9);
  EXPECT_NEAR(std::sqrt(known.covariance()(pose, pose)), 3e-4, 1e-9);
}

// What is known of the steady states fades with time, whether or not the hand moves.
TEST(WrenchKnowledge, SteadyStatesReturnToTheirDeviationsWithinTheMemory) {
  const int bias = kStates.bias(0) + 1;
  WrenchKnowledge known(kStates, deviations({{bias, 0.4}}), kMemory);
  HandRecord hand = record_of(0.01);
  hand.y[1] = 0.3;
  known.correct(hand, WrenchKnowledge::Appended::Zero(6, 0), hand.R);
  const double learnt = known.mean()[bias], left = known.covariance()(bias, bias);
  EXPECT_NEAR(learnt, 0.3, 1e-3);
  hand.time = 150;
  known.advance({hand, HandRecord()});
  const double kept = std::exp(-0.5);
  EXPECT_NEAR(known.mean()[bias], kept * learnt, 1e-12);
  EXPECT_NEAR(known.covariance()(bias, bias), kept * kept * left + (1 - kept * kept) * 0.16, 1e-12);
}

TEST(WrenchKnowledge, TheOffsetOfAFilterIsTheSteadyOneWithItsPresentError) {
  const int offset = kStates.offset(0), error = kStates.pose_error(0);
  WrenchKnowledge known(
      kStates,
      deviations(
          {{offset, 2e-3}, {error, 1e-3}, {kStates.log_young(), 0.2}, {kStates.bias(0) + 2, 0.05}}),
      kMemory);
  HandRecord hand = record_of(0.01);
  hand.y[0] = 1.5;
  known.correct(hand, WrenchKnowledge::Appended::Zero(6, 0), hand.R);
  WrenchKnowledge::Vector mean;
  WrenchKnowledge::Matrix covariance;
  known.write(mean, covariance);
  ASSERT_EQ(mean.size(), 13);
  const WrenchKnowledge::Matrix& P = known.covariance();
  EXPECT_NEAR(mean[0], known.mean()[offset] + known.mean()[error], 1e-15);
  EXPECT_NEAR(covariance(0, 0), P(offset, offset) + P(error, error) + 2 * P(offset, error), 1e-15);
  const int log_young = kStates.log_young(), bias = kStates.bias(0) + 2;
  EXPECT_EQ(mean[6], known.mean()[log_young]);
  EXPECT_NEAR(covariance(6, 0), P(log_young, offset) + P(log_young, error), 1e-15);
  EXPECT_EQ(mean[9], known.mean()[bias]);
  EXPECT_NEAR(covariance(9, 9), P(bias, bias), 1e-15);
}

TEST(WrenchKnowledge, TheSizeOfAWrenchIncludesWhatOffsetsMayAdd) {
  const WrenchKnowledge known(kStates, deviations({{kStates.offset(0), 0.002}}), kMemory);
  const HandRecord hand = record_of(0.001);
  Vector6d nominal = Vector6d::Zero();
  nominal[0] = 1;
  const Vector6d size = known.size_of_wrench(hand, nominal, 0.2);
  EXPECT_NEAR(size[1], std::hypot(1, 2), 1e-6);        // N: 1000 N/m times 2 mm
  EXPECT_NEAR(size[4], 0.2 * std::hypot(1, 2), 1e-6);  // N m, at a lever of 0.2 m
}

}  // namespace
}  // namespace palpate::estimation

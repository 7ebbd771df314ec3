#include "rt/daemon/discrepancy_telemetry.hpp"

#include <gtest/gtest.h>

#include "rt/loop/allocation_counter.hpp"

namespace palpate::daemon {
namespace {

using estimation::Cause;
using estimation::DiscrepancyReport;

constexpr std::int64_t kSession = 42;

class DiscrepancyTelemetryTest : public ::testing::Test {
 protected:
  DiscrepancyTelemetryTest()
      : received_(*outside_, "DISCREPANCY", 16), telemetry_(*inside_, kSession) {
    report_.tests = 7;
    report_.test = 1.5;
    report_.threshold = 4.9;
  }
  /// Number of messages published since the last call; the last one is in message_.
  int published() {
    int count = 0;
    std::int64_t arrival_ns = 0;
    while (received_.take(message_, arrival_ns)) ++count;
    return count;
  }
  void contradict() {
    ++report_.tests;
    report_.is_inconsistent = true;
    report_.time = 0.4;
    report_.test = 8;
    report_.hand = 1;
    report_.axis = 4;
    report_.difference[1] << 1, 2, 3, 4, 5, 6;
    report_.deviation[1].setConstant(0.5);
    report_.count = 2;
    report_.explanations[0] = {Cause::kContact, 0.8, 0, {0.2, 0, 0.03}, math::Vector6d::Zero()};
    report_.explanations[0].value << 0, 0, -1.2, 0, 0, 0;
    report_.explanations[1] = {Cause::kSensorBias, 0.1, 1, {0, 0, 0}, math::Vector6d::Ones()};
    report_.adopted = Cause::kSlip;
  }

  std::shared_ptr<bus::MemoryHub> hub_ = bus::make_memory_hub();
  std::unique_ptr<bus::MessageBus> outside_ = bus::make_memory_bus(hub_);
  std::unique_ptr<bus::MessageBus> inside_ = bus::make_memory_bus(hub_);
  bus::TypedSubscription<discrepancy_t> received_;
  DiscrepancyTelemetry telemetry_;
  DiscrepancyReport report_;
  discrepancy_t message_{};
};

TEST_F(DiscrepancyTelemetryTest, PublishesEachTestOnce) {
  for (int cycle = 0; cycle < 100; ++cycle) {
    if (cycle % 50 == 0) ++report_.tests;
    telemetry_.publish(&report_, 1, 1000 * cycle);
  }
  EXPECT_EQ(published(), 2);
  EXPECT_EQ(message_.seq, 2);
  EXPECT_EQ(message_.session, kSession);
  EXPECT_EQ(message_.utime, 50'000);
  EXPECT_EQ(message_.inconsistent, 0);
  EXPECT_EQ(message_.test, 1.5);
  EXPECT_EQ(message_.threshold, 4.9);
  EXPECT_EQ(message_.grasp_count, 1);
  EXPECT_EQ(message_.cause_count, 0);
}

TEST_F(DiscrepancyTelemetryTest, NothingWithoutATest) {
  telemetry_.publish(nullptr, 1, 1);
  report_.tests = 0;
  telemetry_.publish(&report_, 1, 2);
  EXPECT_EQ(published(), 0);
}

TEST_F(DiscrepancyTelemetryTest, AResetOfTheTestIsPublished) {
  contradict();
  telemetry_.publish(&report_, 1, 1);
  report_ = {};
  telemetry_.publish(&report_, 1, 2);
  EXPECT_EQ(published(), 2);
  EXPECT_EQ(message_.inconsistent, 0) << "readers must not keep the contradiction";
  EXPECT_LT(message_.test, 0);
  EXPECT_EQ(message_.cause_count, 0);
  EXPECT_EQ(message_.probability[0], 0);
}

TEST_F(DiscrepancyTelemetryTest, ContainsTheReport) {
  contradict();
  telemetry_.publish(&report_, 2, 1);
  ASSERT_EQ(published(), 1);
  EXPECT_EQ(message_.inconsistent, 1);
  EXPECT_EQ(message_.duration, 0.4);
  EXPECT_EQ(message_.hand, 1);
  EXPECT_EQ(message_.axis, 4);
  EXPECT_EQ(message_.grasp_count, 2);
  EXPECT_EQ(message_.difference[1][3], 4);
  EXPECT_EQ(message_.deviation[1][3], 0.5);
  EXPECT_LT(message_.deviation[0][3], 0) << "no wrench";
  ASSERT_EQ(message_.cause_count, 2);
  EXPECT_EQ(message_.cause[0], discrepancy_t::CAUSE_CONTACT);
  EXPECT_EQ(message_.probability[0], 0.8);
  EXPECT_EQ(message_.location[0][2], 0.03);
  EXPECT_EQ(message_.value[0][2], -1.2);
  EXPECT_EQ(message_.cause[1], discrepancy_t::CAUSE_SENSOR_BIAS);
  EXPECT_EQ(message_.cause_hand[1], 1);
  EXPECT_EQ(message_.value[1][5], 1);
  EXPECT_EQ(message_.adopted, discrepancy_t::CAUSE_SLIP);
}

TEST_F(DiscrepancyTelemetryTest, DoesNotAllocate) {
  contradict();
  telemetry_.publish(&report_, 2, 1);
  const loop::NoAllocationScope scope;
  for (int i = 0; i < 8; ++i) {
    ++report_.tests;
    telemetry_.publish(&report_, 2, i);
  }
  EXPECT_EQ(scope.count(), 0);
}

}  // namespace
}  // namespace palpate::daemon

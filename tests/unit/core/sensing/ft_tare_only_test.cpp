#include "core/sensing/ft_tare_only.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/core/sensing/wrist_signals.hpp"

namespace palpate::sensing {
namespace {

void grow_old(Signals& signals, double age) {
  signals.force_torque.freshness = Freshness::kOld;
  signals.force_torque.fresh_count = 0;
  signals.force_torque.age = age;
}

TEST(FtTareOnly, SubtractsTheMeanOfTheTareSamples) {
  FtTareOnly::Options options;
  options.tare_samples = 4;
  FtTareOnly sensor(options);
  Signals signals;
  ContactSet contacts;
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(contacts.count, 0);
    feed_wrench(signals, {{1.0 + i, 0, 0}, {0, 0, 0.5}});
    static_cast<void>(sensor.update(signals, contacts = {}));
  }
  feed_wrench(signals, {{5, 2, 0}, {0, 0, 0.5}});
  ASSERT_EQ(sensor.update(signals, contacts = {}).status, Status::kOk);
  ASSERT_EQ(contacts.count, 1);
  EXPECT_EQ(contacts.contacts[0].source, Source::kWrist0);
  EXPECT_LT((contacts.contacts[0].wrench.force - Eigen::Vector3d(2.5, 2, 0)).norm(), 1e-14);
  EXPECT_LT(contacts.contacts[0].wrench.torque.norm(), 1e-14);
}

TEST(FtTareOnly, KeepsItsOldZeroWhileItTaresAgain) {
  FtTareOnly::Options options;
  options.tare_samples = 2;
  FtTareOnly sensor(options);
  Signals signals;
  ContactSet contacts;
  feed_wrench(signals, {{1, 0, 0}, {0, 0, 0}});
  static_cast<void>(sensor.update(signals, contacts = {}));
  static_cast<void>(sensor.update(signals, contacts = {}));
  sensor.zero();
  feed_wrench(signals, {{4, 0, 0}, {0, 0, 0}});
  static_cast<void>(sensor.update(signals, contacts = {}));
  ASSERT_EQ(contacts.count, 1);
  EXPECT_NEAR(contacts.contacts[0].wrench.force.x(), 3, 1e-14);
  static_cast<void>(sensor.update(signals, contacts = {}));
  EXPECT_NEAR(contacts.contacts[0].wrench.force.x(), 0, 1e-14);
}

TEST(FtTareOnly, AveragesAndDelays) {
  FtTareOnly::Options options;
  options.tare_at_start = false;
  options.delay = 2;
  options.moving_average = 3;
  FtTareOnly sensor(options);
  Signals signals;
  ContactSet contacts;
  for (int i = 0; i <= 10; ++i) {
    feed_wrench(signals, {{double(i), 0, 0}, {0, 0, 0}});
    static_cast<void>(sensor.update(signals, contacts = {}));
  }
  EXPECT_NEAR(contacts.contacts[0].wrench.force.x(), (8 + 7 + 6) / 3.0, 1e-12);
}

TEST(FtTareOnly, DegradesWithoutFreshReadingsAndRecovers) {
  FtTareOnly::Options options;
  options.tare_at_start = false;
  FtTareOnly sensor(options);
  Signals signals;
  ContactSet contacts;
  EXPECT_EQ(sensor.update(signals, contacts).status, Status::kDegraded);
  feed_wrench(signals, {{1, 0, 0}, {0, 0, 0}});
  EXPECT_EQ(sensor.update(signals, contacts = {}).status, Status::kOk);
  grow_old(signals, 0.024);
  EXPECT_EQ(sensor.update(signals, contacts = {}).status, Status::kOk);
  EXPECT_EQ(contacts.count, 1);
  grow_old(signals, 0.026);
  const UpdateResult late = sensor.update(signals, contacts = {});
  EXPECT_EQ(late.status, Status::kDegraded);
  EXPECT_STRNE(late.reason, "");
  EXPECT_EQ(contacts.count, 0);
  feed_wrench(signals, {{1, 0, 0}, {0, 0, 0}});
  EXPECT_EQ(sensor.update(signals, contacts = {}).status, Status::kOk);
}

TEST(FtTareOnly, PassesOverNumbersThatAreNotFiniteAndCountsThem) {
  FtTareOnly::Options options;
  options.tare_at_start = false;
  options.moving_average = 5;
  FtTareOnly sensor(options);
  Signals signals;
  ContactSet contacts;
  feed_wrench(signals, {{1, 2, 3}, {0, 0, 0}});
  static_cast<void>(sensor.update(signals, contacts = {}));
  feed_wrench(signals, {{NAN, 0, 0}, {0, 0, 0}});
  static_cast<void>(sensor.update(signals, contacts = {}));
  EXPECT_EQ(sensor.skipped(), 1);
  EXPECT_LT((contacts.contacts[0].wrench.force - Eigen::Vector3d(1, 2, 3)).norm(), 1e-14);
}

TEST(FtTareOnly, RefusesOptionsThatMakeNoSense) {
  FtTareOnly::Options options;
  options.polarity = 0.5;
  EXPECT_THROW(FtTareOnly{options}, std::invalid_argument);
  options = {};
  options.moving_average = 0;
  EXPECT_THROW(FtTareOnly{options}, std::invalid_argument);
}

}  // namespace
}  // namespace palpate::sensing

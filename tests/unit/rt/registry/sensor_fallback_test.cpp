#include "rt/registry/fallbacks.hpp"

#include <gtest/gtest.h>

namespace palpate::registry {
namespace {

/// Outputs one contact of `force` along x and a configurable status.
struct Scripted final : sensing::SensorModel {
  explicit Scripted(double f) : force(f) {}
  UpdateResult update(const sensing::Signals&, sensing::ContactSet& contacts) noexcept override {
    ++updates;
    sensing::Contact contact;
    contact.wrench.force.x() = force;
    contacts.push(contact);
    return answer;
  }
  void zero() noexcept override { ++zeros; }
  void reset() noexcept override { answer = {}; }
  double force;
  UpdateResult answer;
  int updates = 0, zeros = 0;
};

class SensorFallbackTest : public ::testing::Test {
 protected:
  SensorFallbackTest() {
    auto first = std::make_unique<Scripted>(1);
    auto second = std::make_unique<Scripted>(2);
    first_ = first.get();
    second_ = second.get();
    model_ = std::make_unique<SensorFallback>(std::move(first), std::move(second), "taken over");
  }
  UpdateResult update() {
    contacts_.count = 1;  // another sensor's
    return model_->update({}, contacts_);
  }
  double force() const { return contacts_.contacts[1].wrench.force.x(); }

  Scripted *first_, *second_;
  std::unique_ptr<SensorFallback> model_;
  sensing::ContactSet contacts_;
};

TEST_F(SensorFallbackTest, OnlyOneReportsWhileBothSeeAll) {
  for (int i = 0; i < 20; ++i) EXPECT_EQ(update().status, Status::kOk);
  EXPECT_EQ(contacts_.count, 2);
  EXPECT_EQ(force(), 1);
  EXPECT_EQ(second_->updates, 20);
  model_->zero();
  EXPECT_EQ(first_->zeros + second_->zeros, 2);
}

TEST_F(SensorFallbackTest, ADegradedFirstIsStillTheFirst) {
  first_->answer = {Status::kDegraded, "late"};
  EXPECT_STREQ(update().reason, "late");
  EXPECT_EQ(force(), 1);
}

TEST_F(SensorFallbackTest, AFaultHandsOverUntilReset) {
  first_->answer = {Status::kFault, "broken"};
  const UpdateResult result = update();
  EXPECT_EQ(result.status, Status::kDegraded);
  EXPECT_STREQ(result.reason, "taken over");
  EXPECT_EQ(contacts_.count, 2);
  EXPECT_EQ(force(), 2);
  second_->answer = {Status::kDegraded, "taring"};
  EXPECT_STREQ(update().reason, "taring");
  model_->reset();
  EXPECT_EQ(update().status, Status::kOk);
  EXPECT_EQ(force(), 1);
}

}  // namespace
}  // namespace palpate::registry

#include <gtest/gtest.h>

#include <limits>

#include "core/sensing/fingertip.hpp"

namespace palpate::sensing {
namespace {

class FingertipContactTest : public ::testing::Test {
 protected:
  UpdateResult update(const FingertipContact& sample) {
    Stream<FingertipContact, 4>& stream = signals_.fingertip[2];
    stream.freshness = Freshness::kNew;
    stream.age = 0;
    stream.latest = stream.fresh[0] = sample;
    stream.fresh_count = 1;
    contacts_.count = 0;
    return model_->update(signals_, contacts_);
  }
  void feed(const FingertipContact& sample) { static_cast<void>(update(sample)); }
  static FingertipContact touch(double force) {
    FingertipContact sample;
    sample.touches = true;
    sample.place_T = {0.001, 0.002, -0.007};
    sample.normal_T = {0, 0, -1};
    sample.force_T = {0, 0, -force};
    return sample;
  }
  static Fingertip::Options third() {
    Fingertip::Options options;
    options.finger = 2;
    return options;
  }

  Signals signals_;
  ContactSet contacts_;
  std::unique_ptr<Fingertip> model_ = std::make_unique<Fingertip>(third());
};

TEST_F(FingertipContactTest, IsAContactAtItsPlaceWithoutTorque) {
  FingertipContact sample = touch(0.8);
  sample.force_T.x() = 0.1;
  EXPECT_TRUE(update(sample).is_ok());
  ASSERT_EQ(contacts_.count, 1);
  const Contact& contact = contacts_.contacts[0];
  EXPECT_EQ(contact.source, Source::kFinger2);
  EXPECT_EQ(contact.location, sample.place_T);
  EXPECT_EQ(contact.wrench.force, sample.force_T);
  EXPECT_EQ(contact.wrench.torque.norm(), 0);
  EXPECT_EQ(contact.force_deviation, third().force_deviation) << "the sensor reports none";
  sample.force_deviation = 0.2;
  feed(sample);
  EXPECT_EQ(contacts_.contacts[0].force_deviation, 0.2);
}

TEST_F(FingertipContactTest, BeginsAndEndsWithHysteresis) {
  const auto touches_at = [this](double force) {
    EXPECT_TRUE(update(touch(force)).is_ok());
    return contacts_.count == 1;
  };
  EXPECT_FALSE(touches_at(0.12));
  EXPECT_TRUE(touches_at(0.16));
  EXPECT_TRUE(touches_at(0.12));
  EXPECT_FALSE(touches_at(0.09));
  EXPECT_FALSE(touches_at(0.12));
  EXPECT_TRUE(touches_at(1));
  FingertipContact off = touch(1);
  off.touches = false;
  EXPECT_TRUE(update(off).is_ok());
  EXPECT_EQ(contacts_.count, 0) << "whatever its force";
}

TEST_F(FingertipContactTest, WithoutAUsableSampleIsDegraded) {
  EXPECT_EQ(model_->update(signals_, contacts_).status, Status::kDegraded) << "none yet";
  FingertipContact pulls = touch(-0.5);
  EXPECT_EQ(update(pulls).status, Status::kDegraded);
  EXPECT_EQ(contacts_.count, 0);
  FingertipContact vague = touch(0.5);
  vague.place_deviation = 6e-3;
  EXPECT_EQ(update(vague).status, Status::kDegraded);
  EXPECT_EQ(contacts_.count, 0);
  vague.place_deviation = 4e-3;
  EXPECT_TRUE(update(vague).is_ok());
  signals_.fingertip[2].age = 0.051;
  signals_.fingertip[2].fresh_count = 0;
  EXPECT_EQ(model_->update(signals_, contacts_).status, Status::kDegraded) << "old";
}

TEST_F(FingertipContactTest, TaresWhileNothingIsTouched) {
  FingertipContact rest = touch(0);
  rest.touches = false;
  rest.force_T = {0.3, 0, 0};
  model_->zero();
  for (int i = 0; i < 100; ++i) {
    feed(touch(2));  // does not count
    if (i < 50) feed(rest);
  }
  FingertipContact sample = touch(1);
  sample.force_T += rest.force_T;
  feed(sample);
  ASSERT_EQ(contacts_.count, 1);
  EXPECT_LT((contacts_.contacts[0].wrench.force - touch(1).force_T).norm(), 1e-12);

  Fingertip next(third());
  EXPECT_TRUE(next.restore(model_->save())) << "a replacement takes the offset over";
  contacts_.count = 0;
  static_cast<void>(next.update(signals_, contacts_));
  EXPECT_LT((contacts_.contacts[0].wrench.force - touch(1).force_T).norm(), 1e-12);
}

TEST_F(FingertipContactTest, RefusesWrongOptions) {
  Fingertip::Options options = third();
  options.finger = 5;
  EXPECT_THROW(Fingertip{options}, std::invalid_argument);
  options = third();
  options.release_force = 0.2;
  EXPECT_THROW(Fingertip{options}, std::invalid_argument) << "above contact_force";
  options = third();
  options.max_place_deviation = 0;
  EXPECT_THROW(Fingertip{options}, std::invalid_argument);
}

}  // namespace
}  // namespace palpate::sensing

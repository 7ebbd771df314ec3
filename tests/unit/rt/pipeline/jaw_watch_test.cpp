#include "rt/pipeline/jaw_watch.hpp"

#include <gtest/gtest.h>

namespace palpate::pipeline {
namespace {

class Jaws : public ::testing::Test {
 protected:
  Jaws() : watch_(object()) {
    inputs_.grasp_count = 1;
    inputs_.grasps[0].pose_freshness = Freshness::kNew;
  }

  static registry::Object object() {
    registry::Object object;
    object.jaws[0] = registry::Box{{-1, -1, -1}, {1, 1, 1}};
    return object;
  }

  /// Whether the estimator sees a hold, of a hand at height `z`.
  bool holds(bool holding, double z = 0) {
    inputs_.grasps[0].holding = holding;
    inputs_.grasps[0].X_OG.translation().z() = z;
    last_ = watch_.update(inputs_);
    return inputs_.grasps[0].holding;
  }

  JawWatch watch_;
  estimation::EstimationInputs inputs_;
  UpdateResult last_;
};

TEST_F(Jaws, TheGraspOfTheConfigurationIsKnown) {
  EXPECT_TRUE(holds(true));
  EXPECT_TRUE(last_.is_ok());
  EXPECT_FALSE(watch_.wanted());
}

TEST_F(Jaws, AGraspAfterAnOpeningIsHiddenUntilItIsFound) {
  EXPECT_FALSE(holds(false));
  EXPECT_TRUE(last_.is_ok());
  EXPECT_FALSE(watch_.wanted());
  EXPECT_FALSE(holds(true, 0.3));
  EXPECT_EQ(last_.status, Status::kDegraded);
  ASSERT_TRUE(watch_.wanted());
  EXPECT_EQ(watch_.wanted()->hand, 0);
  EXPECT_FALSE(holds(true, 0.4));
  EXPECT_EQ(watch_.wanted()->X_OG.translation().z(), 0.3) << "where it closed";
  watch_.begin(0);
  EXPECT_FALSE(watch_.wanted());
  EXPECT_FALSE(holds(true));
  watch_.end(0, true);
  EXPECT_TRUE(holds(true));
  EXPECT_TRUE(last_.is_ok());
}

TEST_F(Jaws, AHandThatHoldsNothingKnownMayTryAgain) {
  holds(false);
  holds(true);
  watch_.begin(0);
  watch_.end(0, false);
  EXPECT_FALSE(holds(true));
  EXPECT_STREQ(last_.reason, "the closed hand holds no known part of the object");
  EXPECT_FALSE(watch_.wanted());
  holds(false);
  holds(true);
  EXPECT_TRUE(watch_.wanted());
}

TEST_F(Jaws, AHandThatOpensWhileItsGraspIsBeingFoundIsOpen) {
  holds(false);
  holds(true);
  watch_.begin(0);
  holds(false);
  watch_.end(0, true);
  EXPECT_FALSE(holds(true)) << "what was found is no longer what it holds";
  EXPECT_TRUE(watch_.wanted());
}

TEST_F(Jaws, BeforeTheFirstPoseNothingChanges) {
  inputs_.grasps[0].pose_freshness = Freshness::kNoData;
  holds(false);
  inputs_.grasps[0].pose_freshness = Freshness::kNew;
  EXPECT_TRUE(holds(true));
}

TEST(JawWatch, AHandWithoutJawsIsNotWatched) {
  JawWatch watch{registry::Object()};
  estimation::EstimationInputs inputs;
  inputs.grasp_count = 1;
  inputs.grasps[0].pose_freshness = Freshness::kNew;
  EXPECT_TRUE(watch.update(inputs).is_ok());
  inputs.grasps[0].holding = true;
  EXPECT_TRUE(watch.update(inputs).is_ok());
  EXPECT_TRUE(inputs.grasps[0].holding);
  EXPECT_FALSE(watch.wanted());
}

}  // namespace
}  // namespace palpate::pipeline

#include "rt/pipeline/life_cycle.hpp"

#include <gtest/gtest.h>

namespace palpate::pipeline {
namespace {

TEST(LifeCycle, NamesOfEventsAreReadBack) {
  for (const Event event : {Event::kStart, Event::kStop, Event::kReset, Event::kZero,
                            Event::kCalibrate, Event::kReplace}) {
    EXPECT_EQ(event_from(name(event)), event);
  }
  EXPECT_EQ(event_from("explode"), Event::kUnknown);
  EXPECT_EQ(event_from(""), Event::kUnknown);
}

TEST(LifeCycle, DegradedRecoversAndFaultLatches) {
  Condition condition{LifeCycle::kActive, ""};
  condition.apply({Status::kDegraded, "old input"});
  EXPECT_EQ(condition.state, LifeCycle::kDegraded);
  EXPECT_STREQ(condition.reason, "old input");
  condition.apply({Status::kOk, ""});
  EXPECT_EQ(condition.state, LifeCycle::kActive);
  condition.apply({Status::kFault, "broken"});
  condition.apply({Status::kOk, ""});
  EXPECT_EQ(condition.state, LifeCycle::kFaulted);
}

TEST(LifeCycle, InactiveStaysInactive) {
  Condition condition{LifeCycle::kInactive, ""};
  condition.apply({Status::kOk, ""});
  EXPECT_EQ(condition.state, LifeCycle::kInactive);
}

}  // namespace
}  // namespace palpate::pipeline

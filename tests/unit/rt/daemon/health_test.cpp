// When HEALTH is sent in addition to 10 Hz.

#include "rt/daemon/health.hpp"

#include <gtest/gtest.h>

#include <palpate/ft_wrench_t.hpp>

namespace palpate::daemon {
namespace {

using pipeline::Condition;
using pipeline::LifeCycle;

class HealthNews : public ::testing::Test {
 protected:
  HealthNews() {
    bus_->start();
    now_ms_ = 1000;
    publish_if_news(kActive);
  }
  /// One cycle of 1 ms.
  bool publish_if_news(const Condition& condition) {
    now_ms_ += 1;
    bus::set_time(*hub_, 1'000'000 * now_ms_);
    inputs_.read(1'000'000 * now_ms_, 1e-3);
    if (!health_.has_new_data(condition, inputs_, 1'000'000 * now_ms_)) return false;
    health_.publish(counters_, condition, inputs_, {}, 1000 * now_ms_);
    return true;
  }
  int news_in(int cycles, const Condition& condition) {
    int count = 0;
    for (int i = 0; i < cycles; ++i) count += publish_if_news(condition) ? 1 : 0;
    return count;
  }
  void lose_a_message() {
    ft_wrench_t message{};
    message.session = 1;
    message.seq = seq_ += 2;
    message.utime = 1000 * seq_;
    bus::TypedPublisher<ft_wrench_t>(*outside_, "FT_WRENCH").publish(message);
  }

  static constexpr Condition kActive{LifeCycle::kActive, ""};
  static constexpr Condition kDegraded{LifeCycle::kDegraded, "late"};
  std::shared_ptr<bus::MemoryHub> hub_ = bus::make_memory_hub();
  std::unique_ptr<bus::MessageBus> bus_ = bus::make_memory_bus(hub_);
  std::unique_ptr<bus::MessageBus> outside_ = bus::make_memory_bus(hub_);
  Inputs inputs_{*bus_};
  Health health_{*bus_, *bus_, 1, 0, 0};
  Counters counters_;
  std::int64_t now_ms_ = 0;
  std::int32_t seq_ = 0;
};

TEST_F(HealthNews, AStateIsReportedInTheCycleOfItsChangeAndOnce) {
  EXPECT_EQ(news_in(100, kActive), 0);
  EXPECT_TRUE(publish_if_news(kDegraded));
  EXPECT_EQ(news_in(100, kDegraded), 0);
  EXPECT_TRUE(publish_if_news(kActive));
}

TEST_F(HealthNews, AStateThatFlickersIsReportedAHundredTimesASecondAtMost) {
  int published = 0;
  for (int i = 0; i < 1000; ++i)
    published += publish_if_news(i % 2 == 0 ? kDegraded : kActive) ? 1 : 0;
  EXPECT_LE(published, 100);
  EXPECT_GE(published, 80);
}

TEST_F(HealthNews, ALossIsReportedAtOnceAndManyTwentyTimesASecond) {
  lose_a_message();
  news_in(100, kActive);
  lose_a_message();
  EXPECT_TRUE(publish_if_news(kActive));
  int published = 0;
  for (int i = 0; i < 1000; ++i) {
    lose_a_message();
    published += publish_if_news(kActive) ? 1 : 0;
  }
  EXPECT_EQ(published, 20);
}

}  // namespace
}  // namespace palpate::daemon

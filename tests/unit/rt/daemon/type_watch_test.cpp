#include "rt/daemon/inputs.hpp"

#include <gtest/gtest.h>

#include <palpate/ft_wrench_t.hpp>
#include <palpate/imu_t.hpp>

namespace palpate::daemon {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

class TypeWatchTest : public ::testing::Test {
 protected:
  void send_wrong(const char* channel) {
    bus::TypedPublisher<imu_t>(*bus_, channel).publish(imu_t{});
  }
  /// The channel now reported; empty if there is none.
  std::string reported(std::int64_t now_ns) {
    const bus::Subscription* channel = watch_.look(now_ns);
    return channel == nullptr ? "" : channel->channel();
  }

  std::unique_ptr<bus::MessageBus> bus_ = bus::make_memory_bus(bus::make_memory_hub());
  bus::TypedSubscription<ft_wrench_t> first_{*bus_, "FT_WRENCH", 4};
  bus::TypedSubscription<ft_wrench_t> second_{*bus_, "FT_WRENCH_1", 4};
  TypeWatch watch_{*bus_};
};

TEST_F(TypeWatchTest, SaysNothingOfMessagesOfTheRightType) {
  bus::TypedPublisher<ft_wrench_t>(*bus_, "FT_WRENCH").publish(ft_wrench_t{});
  EXPECT_EQ(reported(kSecond), "");
}

TEST_F(TypeWatchTest, ReportsAtOnceThenAtMostOnceASecond) {
  send_wrong("FT_WRENCH");
  EXPECT_EQ(reported(5), "FT_WRENCH");
  EXPECT_EQ(reported(6), "") << "nothing new";
  send_wrong("FT_WRENCH");
  EXPECT_EQ(reported(5 + kSecond - 1), "") << "too soon";
  EXPECT_EQ(reported(5 + kSecond), "FT_WRENCH") << "what came in between is reported later";
  EXPECT_EQ(reported(5 + 3 * kSecond), "") << "reported already";
}

TEST_F(TypeWatchTest, HoldsEachChannelByItself) {
  send_wrong("FT_WRENCH");
  EXPECT_EQ(reported(5), "FT_WRENCH");
  send_wrong("FT_WRENCH_1");
  EXPECT_EQ(reported(6), "FT_WRENCH_1");
  send_wrong("FT_WRENCH");
  send_wrong("FT_WRENCH_1");
  EXPECT_EQ(reported(5 + kSecond), "FT_WRENCH") << "one a look";
  EXPECT_EQ(reported(6 + kSecond), "FT_WRENCH_1");
}

}  // namespace
}  // namespace palpate::daemon

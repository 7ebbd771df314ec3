#include "rt/bus/telemetry_publisher.hpp"

#include <gtest/gtest.h>

#include <future>
#include <palpate/shape_t.hpp>

#include "rt/loop/allocation_counter.hpp"
#include "tests/unit/rt/bus/messages.hpp"

namespace palpate::bus {
namespace {

shape_t shape_number(int number, int values) {
  shape_t shape{};
  shape.seq = number;
  shape.xyz_count = values;
  shape.xyz.assign(static_cast<std::size_t>(values), static_cast<float>(number));
  return shape;
}

bool hand_over(TelemetryPublisher& publisher, const char* channel,
               const std::vector<std::uint8_t>& message) {
  const int size = static_cast<int>(message.size());
  std::uint8_t* place = publisher.buffer(size);
  if (place == nullptr) return false;
  std::memcpy(place, message.data(), message.size());
  return publisher.commit(channel, size);
}

TelemetryPublisher::Send to(MessageBus& bus) {
  return [&bus](const char* channel, const void* data, int size) {
    return bus.publish(channel, data, size);
  };
}

TEST(TelemetryPublisher, PublishesFromItsThreadWhatTheLoopHandsOver) {
  const auto hub = make_memory_hub();
  const auto bus = make_memory_bus(hub);
  std::vector<Published> published;
  record(*hub, &published);
  constexpr int kShapes = 200;
  {
    TelemetryPublisher publisher(to(*bus), kShapes, 5000);
    for (int i = 0; i < kShapes; ++i)
      EXPECT_TRUE(hand_over(publisher, "SHAPE", wire::encoded(shape_number(i, 1 + i * 5))));
    EXPECT_EQ(publisher.lost(), 0);
  }
  ASSERT_EQ(published.size(), static_cast<std::size_t>(kShapes));
  for (int i = 0; i < kShapes; ++i) {
    EXPECT_EQ(published[static_cast<std::size_t>(i)].channel, "SHAPE");
    EXPECT_EQ(published[static_cast<std::size_t>(i)].data,
              wire::encoded(shape_number(i, 1 + i * 5)));
  }
}

TEST(TelemetryPublisher, CountsWhatIsTooLarge) {
  const auto hub = make_memory_hub();
  const auto bus = make_memory_bus(hub);
  TelemetryPublisher publisher(to(*bus), 4, 500);
  EXPECT_FALSE(hand_over(publisher, "SHAPE", wire::encoded(shape_number(1, 1000))));
  EXPECT_FALSE(hand_over(publisher, "", wire::encoded(shape_number(1, 1))));
  EXPECT_FALSE(publisher.commit(std::string(kLongestChannel + 1, 'C').c_str(), 1));
  EXPECT_FALSE(publisher.commit("SHAPE", 501));
  EXPECT_FALSE(publisher.commit("SHAPE", -1));
  EXPECT_EQ(publisher.lost(), 5);
  EXPECT_THROW(TelemetryPublisher(to(*bus), 4, 0), std::invalid_argument);
}

TEST(TelemetryPublisher, AFullQueueDropsTheOldest) {
  std::promise<void> first_taken, go_on;
  std::vector<std::string> sent;  // by the publisher's thread
  const std::string long_name(kLongestChannel, 'C');
  {
    TelemetryPublisher publisher(
        [&](const char* channel, const void* data, int size) {
          if (sent.empty()) {
            first_taken.set_value();
            go_on.get_future().wait();
          }
          sent.push_back(channel + std::string(" ") +
                         std::string(static_cast<const char*>(data), size));
          return true;
        },
        2, 10);
    EXPECT_TRUE(hand_over(publisher, "A", {'0'}));
    first_taken.get_future().wait();
    for (const char text : {'1', '2', '3'}) hand_over(publisher, "A", {std::uint8_t(text)});
    EXPECT_TRUE(hand_over(publisher, long_name.c_str(), {}));
    EXPECT_EQ(publisher.lost(), 2);
    go_on.set_value();
  }
  EXPECT_EQ(sent, (std::vector<std::string>{"A 0", "A 3", long_name + " "}));
}

TEST(TelemetryPublisher, CountsWhatTheBusRejects) {
  std::promise<void> tried;
  TelemetryPublisher publisher(
      [&](const char*, const void*, int) { return tried.set_value(), false; }, 4, 10);
  EXPECT_TRUE(hand_over(publisher, "A", {1}));
  tried.get_future().wait();
  while (publisher.lost() == 0) std::this_thread::yield();
  EXPECT_EQ(publisher.lost(), 1);
}

TEST(TelemetryPublisher, TheLoopsSideDoesNotAllocate) {
  const auto hub = make_memory_hub();
  const auto bus = make_memory_bus(hub);
  TelemetryPublisher publisher(to(*bus), 4, 50'000);
  const std::vector<std::uint8_t> shape = wire::encoded(shape_number(1, 9000));
  const loop::NoAllocationScope scope;
  for (int i = 0; i < 50; ++i) hand_over(publisher, "SHAPE", shape);
  EXPECT_EQ(scope.count(), 0);
}

}  // namespace
}  // namespace palpate::bus

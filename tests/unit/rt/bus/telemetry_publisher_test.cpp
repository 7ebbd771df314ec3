#include "rt/bus/telemetry_publisher.hpp"

#include <gtest/gtest.h>

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
  EXPECT_EQ(publisher.lost(), 2);
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

#include "rt/daemon/service_manager.hpp"

#include <gtest/gtest.h>
#include <vector>

#include "tests/support/notify_socket.hpp"

namespace palpate::daemon {
namespace {

using Messages = std::vector<std::string>;
constexpr std::int64_t kMs = 1'000'000;

TEST(LoopWatch, ReadyAfterTheFirstCycleThenPingsTwiceInTheInterval) {
  support::NotifySocket socket;
  ServiceManager manager(socket.name(), 1'000'000);
  EXPECT_EQ(manager.watchdog_ns(), 1000 * kMs);
  LoopWatch watch(manager);
  watch.look(1 * kMs, 0);
  EXPECT_EQ(socket.take(), Messages{});
  watch.look(1000 * kMs, 5);
  EXPECT_EQ(socket.take(), (Messages{"READY=1", "WATCHDOG=1"}));
  int pings = 0;
  for (int ms = 1050; ms <= 11000; ms += 50) {
    watch.look(ms * kMs, ms);
    pings += static_cast<int>(socket.take().size());
  }
  EXPECT_EQ(pings, 20);
}

TEST(LoopWatch, LoopThatHangsIsSaidOnceAndNotPingedFor) {
  support::NotifySocket socket;
  ServiceManager manager(socket.name(), 1'000'000);
  LoopWatch watch(manager);
  watch.look(1000 * kMs, 1);
  watch.look(1500 * kMs, 2);
  socket.take();
  int stalls = 0;
  for (int ms = 1550; ms <= 20000; ms += 50)
    if (watch.look(ms * kMs, 2) == LoopWatch::Verdict::kStalled) ++stalls;
  EXPECT_EQ(stalls, 1);
  EXPECT_EQ(socket.take(), Messages{});
  EXPECT_EQ(watch.look(20050 * kMs, 3), LoopWatch::Verdict::kRecovered);
  EXPECT_EQ(socket.take(), Messages{"WATCHDOG=1"});
  EXPECT_EQ(watch.look(20100 * kMs, 4), LoopWatch::Verdict::kNothing);
}

TEST(LoopWatch, StatusIsSentWhenItChanges) {
  support::NotifySocket socket;
  ServiceManager manager(socket.name(), 0);
  LoopWatch watch(manager);
  watch.set_status("active");
  watch.set_status("active");
  watch.set_status("faulted: why");
  EXPECT_EQ(socket.take(), (Messages{"STATUS=active", "STATUS=faulted: why"}));
}

TEST(ServiceManager, WithoutASocketOrAListenerNothingHappens) {
  ServiceManager none("", 1'000'000);
  EXPECT_EQ(none.watchdog_ns(), 0);
  EXPECT_FALSE(none.notify("READY=1"));
  ServiceManager unread("@palpate_no_listener_here", 1'000'000);
  EXPECT_FALSE(unread.notify("READY=1"));
  ServiceManager too_long(std::string(300, 'x'), 1'000'000);
  EXPECT_FALSE(too_long.notify("READY=1"));
}

}  // namespace
}  // namespace palpate::daemon

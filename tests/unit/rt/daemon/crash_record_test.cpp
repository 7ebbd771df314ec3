#include "rt/daemon/crash_record.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <palpate/estimate_t.hpp>
#include <palpate/ft_wrench_t.hpp>

#include "rt/bus/event_log_reader.hpp"
#include "rt/loop/allocation_counter.hpp"
#include "tests/support/scratch_folder.hpp"

namespace palpate::daemon {
namespace {

namespace fs = std::filesystem;
constexpr std::int64_t kRecordMs = 1'000'000;  // ns
constexpr std::int64_t kWallClock = 1'700'000'000'000'000;

/// A loop that receives a wrench and publishes an estimate each millisecond.
class CrashRecordTest : public ::testing::Test {
 protected:
  void cycle(CrashRecord& record, int ms) {
    record.begin_cycle(ms * kRecordMs, kWallClock + 1000 * ms);
    ft_wrench_t wrench{};
    wrench.seq = ms;
    sensor_.publish(wrench);
    std::int64_t arrival_ns = 0;
    wrenches_.take(wrench, arrival_ns);
    estimate_t estimate{};
    estimate.seq = ms;
    estimates_.publish(estimate);
  }
  RecordSettings settings(int keep = 20) const { return {folder_.path().string(), 0.1, keep}; }

  support::ScratchFolder folder_;
  std::shared_ptr<bus::MemoryHub> hub_ = bus::make_memory_hub();
  std::unique_ptr<bus::MessageBus> outside_ = bus::make_memory_bus(hub_);
  std::unique_ptr<bus::MessageBus> control_ = bus::make_memory_bus(hub_);
  bus::TypedPublisher<ft_wrench_t> sensor_{*outside_, "FT_WRENCH"};
  bus::TypedSubscription<ft_wrench_t> wrenches_{*control_, "FT_WRENCH", 8};
  bus::TypedPublisher<estimate_t> estimates_{*control_, "ESTIMATE"};
};

TEST_F(CrashRecordTest, HoldsTheLastInputsAndOutputsBeforeTheFaultInOrder) {
  CrashRecord record(settings(), 1e-3, *control_);
  for (int ms = 0; ms < 500; ++ms) cycle(record, ms);
  record.hand_over("fault");
  EXPECT_EQ(record.write_handed_over(), "") << "not before the cycle is done";
  for (int ms = 500; ms < 600; ++ms) cycle(record, ms);  // continues before the file is written
  const std::string path = record.write_handed_over();
  ASSERT_NE(path, "");
  EXPECT_EQ(record.write_handed_over(), "") << "once";

  bus::EventLogReader log(path);
  int expected = 399, events = 0;
  while (const bus::LoggedEvent* event = log.next()) {
    const bool input = events % 2 == 0;
    ASSERT_EQ(event->channel, input ? "FT_WRENCH" : "ESTIMATE");
    ASSERT_EQ(event->utime, kWallClock + 1000 * expected);
    if (input) {
      ft_wrench_t wrench;
      ASSERT_GE(wrench.decode(event->data, 0, event->size), 0);
      ASSERT_EQ(wrench.seq, expected);
    } else {
      ++expected;
    }
    ++events;
  }
  EXPECT_EQ(expected, 500) << "up to the fault and no further";
  EXPECT_EQ(events, 2 * 101);
}

TEST_F(CrashRecordTest, WallClockThatJumpsDoesNotReorderIt) {
  CrashRecord record(settings(), 1e-3, *control_);
  cycle(record, 0);
  record.begin_cycle(1 * kRecordMs, kWallClock - 3'600'000'000);
  estimates_.publish(estimate_t{});
  record.hand_over("fault");
  record.begin_cycle(2 * kRecordMs, kWallClock + 2000);
  bus::EventLogReader log(record.write_handed_over());
  std::int64_t last = 0;
  while (const bus::LoggedEvent* event = log.next()) last = event->utime;
  EXPECT_EQ(last, kWallClock + 1000);
}

TEST_F(CrashRecordTest, AFaultBeforeTheLastRecordIsWrittenDoesNotTouchIt) {
  CrashRecord record(settings(), 1e-3, *control_);
  cycle(record, 0);
  record.hand_over("fault");
  cycle(record, 1);
  record.hand_over("fault");
  cycle(record, 2);
  bus::EventLogReader log(record.write_handed_over());
  EXPECT_EQ(log.next()->utime, kWallClock);
  EXPECT_EQ(record.write_handed_over(), "");
  record.hand_over("fault");
  cycle(record, 3);
  bus::EventLogReader second(record.write_handed_over());
  EXPECT_EQ(second.next()->utime, kWallClock + 1000);
}

TEST_F(CrashRecordTest, OnRequestAndWithOldRecordsRemovedButNothingElse) {
  CrashRecord record(settings(2), 1e-3, *control_);
  std::ofstream(folder_.path() / "foreign.lcmlog") << "not a crash record";
  std::vector<std::string> paths;
  for (int i = 0; i < 4; ++i) {
    cycle(record, 2 * i);
    record.request();
    EXPECT_EQ(record.write_handed_over(), "") << "not before the next cycle";
    cycle(record, 2 * i + 1);
    paths.push_back(record.write_handed_over());
    EXPECT_NE(paths.back().find("-request."), std::string::npos) << paths.back();
  }
  EXPECT_TRUE(fs::exists(folder_.path() / "foreign.lcmlog"));
  EXPECT_TRUE(fs::exists(paths[3]));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()), 3);
}

TEST_F(CrashRecordTest, CostsTheLoopNoAllocationAndLittleTime) {
  constexpr int kCycles = 5000;
  const auto run = [&](CrashRecord* record) {
    const auto began = std::chrono::steady_clock::now();
    for (int ms = 0; ms < kCycles; ++ms) {
      if (record != nullptr) record->begin_cycle(ms * kRecordMs, ms);
      // About the size in bytes of a cycle with all messages of a daemon.
      for (int i = 0; i < 4; ++i) estimates_.publish(estimate_t{});
    }
    const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - began;
    return took.count() / kCycles;
  };
  run(nullptr);
  const double without = run(nullptr);
  CrashRecord record(settings(), 1e-3, *control_);
  const std::int64_t before = loop::allocations_of_this_thread();
  const double with = run(&record);
  EXPECT_EQ(loop::allocations_of_this_thread(), before);
  std::printf("4 messages of %d bytes: %.2f us a cycle with a record, %.2f us without\n",
              estimate_t().getEncodedSize(), with, without);
}

}  // namespace
}  // namespace palpate::daemon

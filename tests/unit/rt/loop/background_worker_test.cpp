#include "rt/loop/background_worker.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

namespace palpate::loop {
namespace {

struct Sum {
  std::vector<int> terms;
  long total = 0;
};

void add_up(void* argument) noexcept {
  Sum& sum = *static_cast<Sum*>(argument);
  sum.total = std::accumulate(sum.terms.begin(), sum.terms.end(), 0L);
}

void* await(BackgroundWorker& worker) {
  for (;;) {
    if (void* argument = worker.finished()) return argument;
    std::this_thread::yield();
  }
}

TEST(BackgroundWorker, WaitsForTheJobThatIsRunning) {
  BackgroundWorker worker;
  EXPECT_EQ(worker.wait(), nullptr) << "there is none";
  for (int i = 1; i <= 300; ++i) {
    Sum sum{std::vector<int>(static_cast<std::size_t>(50 * i), 2)};
    ASSERT_TRUE(worker.submit(add_up, &sum));
    // Sometimes collected by polling, whose leftovers must not end the next wait early.
    ASSERT_EQ(i % 3 == 0 ? await(worker) : worker.wait(), &sum);
    ASSERT_EQ(sum.total, 100 * i);
    ASSERT_FALSE(worker.busy());
  }
}

TEST(BackgroundWorker, RunsAJobAndHandsItsArgumentBackOnce) {
  BackgroundWorker worker;
  EXPECT_FALSE(worker.busy());
  EXPECT_EQ(worker.finished(), nullptr);
  Sum sum{{1, 2, 3}, 0};
  ASSERT_TRUE(worker.submit(add_up, &sum));
  EXPECT_EQ(await(worker), &sum);
  EXPECT_EQ(sum.total, 6);
  EXPECT_EQ(worker.finished(), nullptr);
  EXPECT_FALSE(worker.busy());
}

struct Gate {
  std::atomic<bool> open{false};
};

void wait_for(void* argument) noexcept {
  while (!static_cast<Gate*>(argument)->open) std::this_thread::yield();
}

TEST(BackgroundWorker, TakesNoSecondJobBeforeTheFirstIsCollected) {
  BackgroundWorker worker;
  Gate gate;
  ASSERT_TRUE(worker.submit(wait_for, &gate));
  EXPECT_TRUE(worker.busy());
  EXPECT_FALSE(worker.submit(wait_for, &gate));
  EXPECT_EQ(worker.finished(), nullptr);
  gate.open = true;
  EXPECT_EQ(await(worker), &gate);
  EXPECT_TRUE(worker.submit(wait_for, &gate));
  EXPECT_EQ(await(worker), &gate);
}

struct Course {
  std::atomic<bool> begun{false};
  std::atomic<bool> may_end{false};
  std::atomic<bool> ended{false};
};

void run_course(void* argument) noexcept {
  Course& course = *static_cast<Course*>(argument);
  course.begun = true;
  while (!course.may_end) std::this_thread::yield();
  course.ended = true;
}

TEST(BackgroundWorker, WaitsForARunningJobAtItsEnd) {
  Course course;
  std::thread permit;
  {
    BackgroundWorker worker;
    ASSERT_TRUE(worker.submit(run_course, &course));
    while (!course.begun) std::this_thread::yield();
    permit = std::thread([&course] { course.may_end = true; });
  }
  EXPECT_TRUE(course.ended);
  permit.join();
}

TEST(BackgroundWorker, ManyHandoversKeepTheArgumentsWhole) {
  BackgroundWorker worker;
  std::vector<int> terms(50);
  for (int round = 0; round < 5000; ++round) {
    std::fill(terms.begin(), terms.end(), round);
    Sum sum{terms, -1};
    ASSERT_TRUE(worker.submit(add_up, &sum));
    ASSERT_EQ(await(worker), &sum);
    ASSERT_EQ(sum.total, 50L * round);
  }
}

}  // namespace
}  // namespace palpate::loop

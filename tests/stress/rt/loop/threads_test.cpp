#include <gtest/gtest.h>

#include <numeric>
#include <vector>

#include "rt/loop/background_worker.hpp"
#include "rt/loop/spin_team.hpp"
#include "tests/stress/rhythm.hpp"

namespace palpate::loop {
namespace {

struct Sum {
  std::vector<int> terms;
  long total = 0;
};

void add_up(void* argument) noexcept {
  Sum& sum = *static_cast<Sum*>(argument);
  sum.total = std::accumulate(sum.terms.begin(), sum.terms.end(), 0L);
  for (int& term : sum.terms) term = -1;
}

TEST(BackgroundWorkerStress, AJobIsOfOneThreadAtATime) {
  BackgroundWorker worker;
  stress::Rhythm rhythm(1);
  Sum sum{std::vector<int>(50), 0};
  for (int round = 0; round < 5000; ++round) {
    std::fill(sum.terms.begin(), sum.terms.end(), round);
    ASSERT_TRUE(worker.submit(add_up, &sum));
    void* done = nullptr;
    // As collected by the loop, and by a deterministic run.
    while (round % 3 != 0 && (done = worker.finished()) == nullptr) rhythm.beat();
    if (done == nullptr) done = worker.wait();
    ASSERT_EQ(done, &sum);
    ASSERT_EQ(sum.total, 50L * round);
    ASSERT_EQ(sum.terms.front(), -1);
    if (round % 500 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

TEST(BackgroundWorkerStress, EndsAtAnyMoment) {
  for (int round = 0; round < 300; ++round) {
    Sum sum{std::vector<int>(50, 1), 0};
    {
      BackgroundWorker worker;
      stress::Rhythm rhythm(static_cast<unsigned>(round));
      ASSERT_TRUE(worker.submit(add_up, &sum));
      for (int i = 0; i < round; ++i) rhythm.beat();
    }
    ASSERT_TRUE(sum.total == 50 || sum.total == 0);
  }
}

/// Each run uses the output of all members in the previous one.
TEST(SpinTeamStress, RunsSeeWhatRunsBeforeWrote) {
  for (const int size : {2, 3, 5}) {
    for (const double patience : {0., 20e-6, 1e-3}) {
      SpinTeamOptions options;
      options.size = size;
      options.patience = patience;
      SpinTeam team(options);
      stress::Rhythm rhythm(7);
      std::vector<long> now(101, 1), next(101);
      long expected = 101;
      for (int run = 1; run <= 2000; ++run) {
        rhythm.beat();
        if (run % 5 == 0) team.call_up();
        const auto task = [&](int member, int of) {
          const math::Share own(101, member, of);
          for (int i = own.begin; i < own.end; ++i) next[i] = now[100 - i] + run;
        };
        team.run(task);
        now.swap(next);
        expected += 101L * run;
        ASSERT_EQ(std::accumulate(now.begin(), now.end(), 0L), expected) << "run " << run;
      }
    }
  }
}

}  // namespace
}  // namespace palpate::loop

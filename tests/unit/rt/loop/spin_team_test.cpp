#include "rt/loop/spin_team.hpp"

#include <gtest/gtest.h>
#include <sched.h>

#include <array>
#include <chrono>
#include <numeric>

#include "rt/loop/allocation_counter.hpp"

namespace palpate::loop {
namespace {

SpinTeam team_of(int size, double patience = 200e-6) {
  SpinTeamOptions options;
  options.size = size;
  options.patience = patience;
  return SpinTeam(options);
}

TEST(SpinTeam, CallsEveryMemberOnceAndTheFirstHere) {
  for (int size : {1, 2, 3, 8}) {
    SpinTeam team = team_of(size);
    ASSERT_EQ(team.size(), size);
    for (int round = 0; round < 300; ++round) {
      std::array<int, 8> calls{};
      std::thread::id first;
      const auto task = [&](int member, int of) {
        calls[member] += of == size ? 1 : 100;
        if (member == 0) first = std::this_thread::get_id();
      };
      team.run(task);
      ASSERT_EQ(first, std::this_thread::get_id());
      for (int m = 0; m < 8; ++m) ASSERT_EQ(calls[m], m < size ? 1 : 0) << "member " << m;
    }
  }
}

/// Work of a few hundred nanoseconds or, sometimes, much more, so that members finish in every
/// order.
double toil(unsigned seed) {
  const int steps = seed % 61 == 0 ? 20000 : static_cast<int>(seed % 97) * 4;
  double x = seed % 7;
  for (int k = 0; k < steps; ++k) x = 0.5 * x + 1;
  return x;
}

/// Consecutive runs, each using the output of all members in the previous one: a share executed
/// twice, not at all, too early or invisible to others changes the numbers permanently.
std::int64_t chain(math::Team& team, int runs, int pause_every) {
  constexpr int kCells = 257;
  std::vector<std::int64_t> now(kCells), next(kCells);
  std::iota(now.begin(), now.end(), 1);
  std::vector<double> waste(static_cast<std::size_t>(team.size()));
  for (int run = 0; run < runs; ++run) {
    const auto task = [&](int member, int size) {
      waste[member] += toil(static_cast<unsigned>(run * 31 + member * 17));
      const math::Share own(kCells, member, size);
      for (int i = own.begin; i < own.end; ++i) {
        next[i] = (now[i] * 5 + now[(i + 129) % kCells] * 3 + run) % 1000003;
      }
    };
    team.run(task);
    std::swap(now, next);
    if (pause_every > 0 && run % pause_every == 0) {
      std::this_thread::sleep_for(std::chrono::microseconds(run % 3 * 100));
    }
    if (run % 7 == 0) team.call_up();
  }
  return std::accumulate(now.begin(), now.end(), std::int64_t{0});
}

TEST(SpinTeam, LongChainsOfUnevenRunsComeOutAsTheyDoAlone) {
  const std::int64_t alone = chain(math::solo_team, 20000, 0);
  for (int size : {2, 3, 4, 8}) {
    SpinTeam team = team_of(size);
    EXPECT_EQ(chain(team, 20000, 0), alone) << size << " members";
  }
}

TEST(SpinTeam, WorkersThatFallAsleepLoseNothing) {
  const std::int64_t alone = chain(math::solo_team, 3000, 0);
  for (double patience : {0.0, 1e-6, 50e-6}) {
    SpinTeam team = team_of(4, patience);
    EXPECT_EQ(chain(team, 3000, 5), alone) << patience << " s";
  }
}

TEST(SpinTeam, AllMembersOnOneProcessorMakeProgress) {
  const std::int64_t alone = chain(math::solo_team, 500, 0);
  std::int64_t crowded = 0;
  std::thread([&crowded] {
    cpu_set_t before, one;
    sched_getaffinity(0, sizeof(before), &before);
    int cpu = 0;
    while (!CPU_ISSET(cpu, &before)) ++cpu;
    CPU_ZERO(&one);
    CPU_SET(cpu, &one);
    sched_setaffinity(0, sizeof(one), &one);
    SpinTeam team = team_of(4);  // inherits
    crowded = chain(team, 500, 50);
  }).join();
  EXPECT_EQ(crowded, alone);
}

// While the calling thread is busy with its own share, the worker takes the other.
TEST(SpinTeam, WorkersTakeTheirShares) {
  if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "one processor";
  SpinTeam team = team_of(2, 1);
  const auto here = std::this_thread::get_id();
  int elsewhere = 0;
  for (int run = 0; run < 200; ++run) {
    std::thread::id second;
    const auto task = [&](int member, int) {
      const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(1);
      while (member == 0 && std::chrono::steady_clock::now() < end) {
      }
      if (member == 1) second = std::this_thread::get_id();
    };
    team.run(task);
    elsewhere += second != here ? 1 : 0;
  }
  EXPECT_GT(elsewhere, 0);
}

TEST(SpinTeam, StartsAndStopsAtAnyMoment) {
  for (int round = 0; round < 200; ++round) {
    SpinTeam team = team_of(1 + round % 4, round % 3 * 20e-6);
    std::atomic<int> calls{0};
    const auto task = [&](int, int) { ++calls; };
    for (int run = 0; run < round % 5; ++run) team.run(task);
    ASSERT_EQ(calls, round % 5 * team.size());
  }
}

TEST(SpinTeam, RunsWithoutAllocation) {
  if (allocations_of_this_thread() < 0) GTEST_SKIP() << "a sanitizer owns malloc";
  SpinTeam team = team_of(3, 1e-6);
  std::array<std::int64_t, 3> allocated{};
  const auto task = [&](int member, int) {
    allocated[member] -= allocations_of_this_thread();
    allocated[member] += allocations_of_this_thread();
  };
  const NoAllocationScope scope;
  for (int run = 0; run < 1000; ++run) {
    team.call_up();
    team.run(task);
  }
  EXPECT_EQ(scope.count(), 0);
}

TEST(SpinTeam, SaysWhatTheSystemRefusedAndWhatCannotBe) {
  SpinTeamOptions options;
  options.size = 3;
  options.cpus = {100'000};
  const SpinTeam team(options);
  EXPECT_NE(team.remarks().find("100000"), std::string::npos) << team.remarks();
  EXPECT_TRUE(team_of(3).remarks().empty());
  EXPECT_THROW(team_of(0), std::invalid_argument);
  EXPECT_THROW(team_of(65), std::invalid_argument);
  EXPECT_THROW(team_of(2, -1), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::loop

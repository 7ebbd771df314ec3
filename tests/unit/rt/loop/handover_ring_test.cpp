#include "rt/loop/handover_ring.hpp"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <deque>
#include <random>
#include <thread>
#include <vector>

namespace palpate::loop {
namespace {

TEST(HandoverRing, GivesBackInOrder) {
  HandoverRing<int> ring(4, 0);
  EXPECT_EQ(ring.take(), nullptr);
  for (int i = 1; i <= 3; ++i) {
    ring.back() = i;
    EXPECT_FALSE(ring.publish());
  }
  for (int i = 1; i <= 3; ++i) {
    const int* taken = ring.take();
    ASSERT_NE(taken, nullptr);
    EXPECT_EQ(*taken, i);
  }
  EXPECT_EQ(ring.take(), nullptr);
}

TEST(HandoverRing, WhenFullTheNewestSurvive) {
  HandoverRing<int> ring(3, 0);
  int dropped = 0;
  for (int i = 1; i <= 10; ++i) {
    ring.back() = i;
    dropped += ring.publish() ? 1 : 0;
  }
  EXPECT_EQ(dropped, 7);
  for (int i = 8; i <= 10; ++i) EXPECT_EQ(*ring.take(), i);
  EXPECT_EQ(ring.take(), nullptr);
}

TEST(HandoverRing, IsABoundedQueueForAnyInterleaving) {
  std::mt19937 random(11);
  for (const int depth : {1, 2, 3, 8, 33}) {
    HandoverRing<int> ring(depth, 0);
    std::deque<int> model;
    for (int step = 0; step < 20000; ++step) {
      // Long runs of one side make the ring both full and empty.
      const bool produce = std::bernoulli_distribution(step / 100 % 2 == 0 ? 0.8 : 0.2)(random);
      if (produce) {
        ring.back() = step;
        const bool full = static_cast<int>(model.size()) == depth;
        if (full) model.pop_front();
        model.push_back(step);
        ASSERT_EQ(ring.publish(), full);
      } else {
        const int* taken = ring.take();
        ASSERT_EQ(taken == nullptr, model.empty());
        if (taken == nullptr) continue;
        ASSERT_EQ(*taken, model.front());
        model.pop_front();
      }
    }
  }
}

TEST(HandoverRing, RefusesADepthOutOfRange) {
  EXPECT_THROW(HandoverRing<int>(0, 0), std::invalid_argument);
  EXPECT_THROW(HandoverRing<int>(40000, 0), std::invalid_argument);
}

/// A slot that reveals simultaneous access by two threads: all its numbers are equal, or it is
/// torn.
using Wide = std::array<std::uint64_t, 64>;

template <class Ring>
struct StressResult {
  std::int64_t taken = 0;
  std::int64_t dropped = 0;
  std::int64_t torn = 0;
  std::int64_t out_of_order = 0;
};

template <class Ring>
StressResult<Ring> stress(Ring& ring, std::uint64_t messages) {
  StressResult<Ring> result;
  std::atomic<bool> done{false};
  std::thread consumer([&] {
    std::uint64_t last = 0;
    for (bool finished = false;;) {
      const Wide* slot = ring.take();
      if (slot == nullptr) {
        if (finished) return;
        finished = done.load(std::memory_order_acquire);
        continue;
      }
      const Wide copy = *slot;
      for (const std::uint64_t word : copy) result.torn += word == copy[0] ? 0 : 1;
      result.out_of_order += copy[0] > last ? 0 : 1;
      last = copy[0];
      ++result.taken;
    }
  });
  for (std::uint64_t i = 1; i <= messages; ++i) {
    ring.back().fill(i);
    result.dropped += ring.publish() ? 1 : 0;
    // Pauses let the consumer catch up, so that the ring also runs empty.
    if (i % 1000 == 0) std::this_thread::yield();
  }
  done.store(true, std::memory_order_release);
  consumer.join();
  return result;
}

TEST(HandoverRing, TwoThreadsLoseOnlyWhatIsCountedAndTearNothing) {
  for (const int depth : {1, 2, 16}) {
    HandoverRing<Wide> ring(depth, Wide{});
    const auto result = stress(ring, 300'000);
    EXPECT_EQ(result.taken + result.dropped, 300'000) << "depth " << depth;
    EXPECT_EQ(result.torn, 0) << "depth " << depth;
    EXPECT_EQ(result.out_of_order, 0) << "depth " << depth;
  }
}

/// The error that HandoverRing avoids: the slot stays in the cell while the consumer reads it.
class SharedSlotRing {
 public:
  explicit SharedSlotRing(std::uint64_t depth) : depth_(depth), slots_(depth) {}
  Wide& back() { return scratch_; }
  bool publish() {
    for (std::size_t i = 0; i < scratch_.size(); ++i)
      slots_[head_ % depth_][i].store(scratch_[i], std::memory_order_relaxed);
    const bool full = head_ - tail_.load() >= depth_;
    if (full) tail_.fetch_add(1);
    published_.store(++head_);
    return full;
  }
  Wide* take() {
    if (tail_.load() >= published_.load()) return nullptr;
    const std::uint64_t at = tail_.fetch_add(1);
    for (std::size_t i = 0; i < taken_.size(); ++i) {
      taken_[i] = slots_[at % depth_][i].load(std::memory_order_relaxed);
      if (i == taken_.size() / 2) std::this_thread::yield();
    }
    return &taken_;
  }

 private:
  std::uint64_t depth_;
  std::vector<std::array<std::atomic<std::uint64_t>, 64>> slots_;
  Wide scratch_{};
  Wide taken_{};
  std::uint64_t head_ = 0;
  std::atomic<std::uint64_t> tail_{0};
  std::atomic<std::uint64_t> published_{0};
};

TEST(HandoverRing, TheStressTestFindsABrokenRing) {
  std::int64_t faults = 0;
  for (int attempt = 0; attempt < 20 && faults == 0; ++attempt) {
    SharedSlotRing ring(2);
    const auto result = stress(ring, 300'000);
    faults = result.torn + result.out_of_order;
  }
  EXPECT_GT(faults, 0);
}

}  // namespace
}  // namespace palpate::loop

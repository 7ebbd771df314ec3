#include "rt/loop/allocation_counter.hpp"

#include <gtest/gtest.h>
#include <malloc.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <thread>
#include <vector>

#include "rt/loop/real_time.hpp"
#include "rt/loop/sanitizer.hpp"

namespace palpate::loop {
namespace {

#define SKIP_WHERE_NOT_COUNTED() \
  if (kSanitized) GTEST_SKIP() << "a sanitizer has its own malloc"

// Hidden from the compiler, which may otherwise remove an unused allocation.
void use(void* block) { asm volatile("" : : "r"(block) : "memory"); }

TEST(AllocationCounter, CountsEachKindOfAllocation) {
  SKIP_WHERE_NOT_COUNTED();
  const std::int64_t before = allocations_of_this_thread();
  void* a = std::malloc(10);
  use(a);
  void* b = std::calloc(3, 10);
  use(b);
  a = std::realloc(a, 1000);
  use(a);
  void* c = std::aligned_alloc(64, 128);
  use(c);
  void* d = nullptr;
  ASSERT_EQ(posix_memalign(&d, 32, 100), 0);
  use(d);
  void* e = memalign(128, 100);
  use(e);
  int* f = new int(1);
  use(f);
  char* g = strdup("by the C library itself");
  use(g);
  void* h = valloc(100);
  use(h);
  EXPECT_EQ(allocations_of_this_thread() - before, 9);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(h) % 4096, 0u);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(c) % 64, 0u);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(d) % 32, 0u);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(e) % 128, 0u);
  for (void* block : {a, b, c, d, e, static_cast<void*>(g), h}) std::free(block);
  delete f;
  EXPECT_EQ(allocations_of_this_thread() - before, 9);
}

TEST(AllocationCounter, PosixMemalignKeepsItsErrors) {
  SKIP_WHERE_NOT_COUNTED();
  void* block = nullptr;
  EXPECT_EQ(posix_memalign(&block, 24, 10), EINVAL);
  EXPECT_EQ(posix_memalign(&block, 4, 10), EINVAL);
}

TEST(AllocationCounter, CountsEachThreadForItself) {
  SKIP_WHERE_NOT_COUNTED();
  std::int64_t there = 0;
  std::int64_t here = 0;
  {
    std::thread other([&there] {
      const std::int64_t before = allocations_of_this_thread();
      for (int i = 0; i < 1000; ++i) use(std::make_unique<int>(i).get());
      there = allocations_of_this_thread() - before;
    });
    const std::int64_t before = allocations_of_this_thread();
    other.join();
    here = allocations_of_this_thread() - before;
  }
  EXPECT_EQ(there, 1000);
  EXPECT_EQ(here, 0);
}

TEST(NoAllocationScope, CountsWithinItself) {
  SKIP_WHERE_NOT_COUNTED();
  abort_on_allocation(false);
  std::vector<int> outside(100);
  const NoAllocationScope scope;
  EXPECT_EQ(scope.count(), 0);
  std::vector<int> inside(100);
  use(inside.data());
  EXPECT_EQ(scope.count(), 1);
}

TEST(NoAllocationScopeDeathTest, AbortsWhereThatIsAskedFor) {
  SKIP_WHERE_NOT_COUNTED();
  EXPECT_DEATH(
      {
        abort_on_allocation(true);
        const NoAllocationScope scope;
        use(std::malloc(10));
      },
      "allocation where none is allowed");
}

#ifdef PALPATE_RTCHECK

TEST(NoAllocationScopeDeathTest, AbortsAtALock) {
  std::mutex mutex;
  std::shared_mutex shared;
  const auto hold = [](auto lock) { use(&lock); };
  EXPECT_DEATH(
      {
        const NoAllocationScope scope;
        hold(std::unique_lock(mutex));
      },
      "lock where none is allowed");
  EXPECT_DEATH(
      {
        const NoAllocationScope scope;
        hold(std::shared_lock(shared));
      },
      "lock where none is allowed");
  EXPECT_DEATH(
      {
        const NoAllocationScope scope;
        hold(std::unique_lock(shared));
      },
      "lock where none is allowed");
  hold(std::unique_lock(mutex));
}

TEST(NoAllocationScopeDeathTest, AbortsAtAPageFaultWhereMemoryIsLocked) {
  constexpr std::size_t kSize = 1 << 20;
  const auto touch_fresh_pages = [] {
    void* fresh = mmap(nullptr, kSize, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    std::memset(fresh, 1, kSize);
    munmap(fresh, kSize);
  };
  {
    const NoAllocationScope scope;  // not locked: no guarantee
    touch_fresh_pages();
  }
  // In a child process, since locked memory stays locked.
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    if (!lock_and_prefault_memory().empty()) _exit(77);
    munlockall();  // so that fresh pages are not present immediately
    {
      const NoAllocationScope scope;
      touch_fresh_pages();
    }
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 77)
    GTEST_SKIP() << "locking memory is not granted here";
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT);
}

#endif

TEST(WatcherScopeDeathTest, IsNeitherCountedNorEnded) {
  SKIP_WHERE_NOT_COUNTED();
  const auto watch = [] {
    const WatcherScope watcher;
    use(std::make_unique<int>(1).get());
  };
  abort_on_allocation(true);
  std::int64_t counted = -1;
  {
    const NoAllocationScope scope;
    watch();
    counted = scope.count();
  }
  EXPECT_EQ(counted, 0);
  EXPECT_DEATH(
      {
        const NoAllocationScope scope;
        watch();
        use(std::malloc(10));
      },
      "allocation where none is allowed");
  abort_on_allocation(false);
}

TEST(NoAllocationScope, EndsWithItsBlock) {
  abort_on_allocation(true);
  { const NoAllocationScope scope; }
  void* block = std::malloc(10);
  use(block);
  std::free(block);
  abort_on_allocation(false);
}

TEST(PageFaults, RiseWhenFreshMemoryIsTouched) {
  const std::int64_t before = page_faults_of_this_thread();
  constexpr std::size_t kPages = 64;
  const std::size_t page = 4096;
  void* fresh = std::aligned_alloc(page, 8 << 20);  // so large that it is mapped from the system
  for (std::size_t i = 0; i < kPages; ++i) static_cast<volatile char*>(fresh)[i * page] = 1;
  EXPECT_GE(page_faults_of_this_thread(), before + 1);
  std::free(fresh);
}

}  // namespace
}  // namespace palpate::loop

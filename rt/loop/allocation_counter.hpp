#pragma once

#include <cstdint>

namespace palpate::loop {

/// Heap allocations that the calling thread has made since it started: every malloc, calloc,
/// realloc, memalign, aligned_alloc, posix_memalign and valloc of the process, be it of our code,
/// of operator new, or of a library; not free, not mmap. -1 where they are not counted, which is in
/// builds with an address or thread sanitizer. Using it is what makes a program count: this file's
/// definitions of the malloc family, which pass on to the C library's, are then linked in.
std::int64_t allocations_of_this_thread() noexcept;

/// Page faults of the calling thread since it started, minor and major together.
std::int64_t page_faults_of_this_thread() noexcept;

/// A stretch of code that must not allocate in this thread. Counts; aborts with a line on stderr at
/// the first allocation in builds with PALPATE_RTCHECK, or after abort_on_allocation(true). With
/// PALPATE_RTCHECK taking a mutex or a read-write lock ends it likewise, and a page fault does at
/// the end of the scope, where the memory of the process is locked. Scopes nest and stay in their
/// thread.
class NoAllocationScope {
 public:
  NoAllocationScope() noexcept;
  ~NoAllocationScope();
  NoAllocationScope(const NoAllocationScope&) = delete;
  NoAllocationScope& operator=(const NoAllocationScope&) = delete;

  /// Allocations since the scope began; 0 where they are not counted.
  std::int64_t count() const noexcept;

 private:
  std::int64_t before_;
  std::int64_t page_faults_before_ = 0;  // looked at with PALPATE_RTCHECK only
};

/// Within a NoAllocationScope, a stretch that is not of the loop but watches it, and so may
/// allocate and lock: it is neither counted nor ended.
class WatcherScope {
 public:
  WatcherScope() noexcept;
  ~WatcherScope();
  WatcherScope(const WatcherScope&) = delete;
  WatcherScope& operator=(const WatcherScope&) = delete;

 private:
  std::int64_t allocations_before_;
  int forbidden_before_;
};

/// For tests of the check itself.
void abort_on_allocation(bool abort) noexcept;

}  // namespace palpate::loop

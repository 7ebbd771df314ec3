#pragma once

#include <cstdint>

namespace palpate::loop {

/// Number of heap allocations of the calling thread since its start: every malloc, calloc, realloc,
/// memalign, aligned_alloc, posix_memalign and valloc of the process, including operator new and
/// libraries; not free, not mmap. -1 if not counted, i.e. in builds with address or thread
/// sanitizer. A program counts only if it uses this function: the definitions of the malloc family
/// in this file, which forward to the C library's, are then linked.
std::int64_t allocations_of_this_thread() noexcept;

/// Page faults of the calling thread since its start, minor and major.
std::int64_t page_faults_of_this_thread() noexcept;

/// Scope in which this thread must not allocate. Counts allocations; aborts with a message on
/// stderr at the first one in builds with PALPATE_RTCHECK, or after abort_on_allocation(true). With
/// PALPATE_RTCHECK locking a mutex or a read-write lock also aborts, as does, at the end of the
/// scope, a page fault if the memory of the process is locked. Scopes may be nested and must not
/// change threads.
class NoAllocationScope {
 public:
  NoAllocationScope() noexcept;
  ~NoAllocationScope();
  NoAllocationScope(const NoAllocationScope&) = delete;
  NoAllocationScope& operator=(const NoAllocationScope&) = delete;

  /// Allocations since the scope began; 0 if not counted.
  std::int64_t count() const noexcept;

 private:
  std::int64_t before_;
  std::int64_t page_faults_before_ = 0;  // used with PALPATE_RTCHECK only
};

/// Exempts monitoring code within a NoAllocationScope, which is not part of the loop: its
/// allocations and locks are neither counted nor fatal.
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

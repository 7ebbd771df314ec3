#include "rt/loop/allocation_counter.hpp"

#include <dlfcn.h>
#include <pthread.h>
#include <sys/resource.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "rt/loop/real_time.hpp"
#include "rt/loop/sanitizer.hpp"

namespace palpate::loop {
namespace {

// zero-initialised and trivial: access never allocates, not even at the start of a thread
thread_local std::int64_t allocations = 0;
thread_local int forbidden = 0;

#ifdef PALPATE_RTCHECK
constexpr bool kChecked = true;
#else
constexpr bool kChecked = false;
#endif
std::atomic<bool> abort_at_once{kChecked};

/// Aborts if this thread is inside a scope.
[[maybe_unused]] void forbid(const char* what) noexcept {
  if (forbidden == 0 || !abort_at_once.load(std::memory_order_relaxed)) return;
  forbidden = 0;
  constexpr char kBegin[] = "palpate: ";
  constexpr char kEnd[] = " where none is allowed; see the stack of this abort\n";
  iovec parts[] = {{const_cast<char*>(kBegin), sizeof(kBegin) - 1},
                   {const_cast<char*>(what), std::strlen(what)},
                   {const_cast<char*>(kEnd), sizeof(kEnd) - 1}};
  const ssize_t written = writev(STDERR_FILENO, parts, 3);
  static_cast<void>(written);
  std::abort();
}

/// Called before every allocation.
[[maybe_unused]] void count_allocation() noexcept {
  ++allocations;
  forbid("allocation");
}

}  // namespace

std::int64_t allocations_of_this_thread() noexcept { return kSanitized ? -1 : allocations; }

std::int64_t page_faults_of_this_thread() noexcept {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_minflt + usage.ru_majflt;
}

NoAllocationScope::NoAllocationScope() noexcept : before_(allocations) {
  if (kChecked) page_faults_before_ = page_faults_of_this_thread();
  ++forbidden;
}

NoAllocationScope::~NoAllocationScope() {
  if (kChecked && memory_is_locked() && page_faults_of_this_thread() != page_faults_before_)
    forbid("page fault");
  if (forbidden > 0) --forbidden;
}

std::int64_t NoAllocationScope::count() const noexcept { return allocations - before_; }

WatcherScope::WatcherScope() noexcept
    : allocations_before_(allocations), forbidden_before_(forbidden) {
  forbidden = 0;
}

WatcherScope::~WatcherScope() {
  forbidden = forbidden_before_;
  allocations = allocations_before_;
}

void abort_on_allocation(bool abort) noexcept {
  abort_at_once.store(abort, std::memory_order_relaxed);
}

}  // namespace palpate::loop

#if !PALPATE_SANITIZED

// The C library's own entry points under their alternative names. free() is defined here only to
// ensure that memory is returned to the allocator it came from, even if a preloaded library defines
// free().
// Visible to the C++ library, whose operator new then calls these.
#pragma GCC visibility push(default)
extern "C" {

// NOLINTBEGIN(bugprone-reserved-identifier): these are the C library's names.
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void* __libc_valloc(std::size_t size);
void __libc_free(void* block);
// NOLINTEND(bugprone-reserved-identifier)

void free(void* block) noexcept { __libc_free(block); }

void* malloc(std::size_t size) noexcept {
  palpate::loop::count_allocation();
  return __libc_malloc(size);
}

void* calloc(std::size_t count, std::size_t size) noexcept {
  palpate::loop::count_allocation();
  return __libc_calloc(count, size);
}

void* realloc(void* block, std::size_t size) noexcept {
  palpate::loop::count_allocation();
  return __libc_realloc(block, size);
}

void* memalign(std::size_t alignment, std::size_t size) noexcept {
  palpate::loop::count_allocation();
  return __libc_memalign(alignment, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  palpate::loop::count_allocation();
  return __libc_memalign(alignment, size);
}

int posix_memalign(void** block, std::size_t alignment, std::size_t size) noexcept {
  palpate::loop::count_allocation();
  if (alignment % sizeof(void*) != 0 || alignment == 0 || (alignment & (alignment - 1)) != 0)
    return EINVAL;
  void* made = __libc_memalign(alignment, size);
  if (made == nullptr) return ENOMEM;
  *block = made;
  return 0;
}

void* valloc(std::size_t size) noexcept {
  palpate::loop::count_allocation();
  return __libc_valloc(size);
}

}  // extern "C"

#endif

#ifdef PALPATE_RTCHECK

namespace {

/// The C library's function that is overridden here.
template <class Function>
Function behind(const char* name) noexcept {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

int pthread_mutex_lock(pthread_mutex_t* mutex) noexcept {
  static std::atomic<int (*)(pthread_mutex_t*)> next{nullptr};
  palpate::loop::forbid("lock");
  if (next == nullptr) next = behind<int (*)(pthread_mutex_t*)>("pthread_mutex_lock");
  return next.load()(mutex);
}

int pthread_rwlock_rdlock(pthread_rwlock_t* lock) noexcept {
  static std::atomic<int (*)(pthread_rwlock_t*)> next{nullptr};
  palpate::loop::forbid("lock");
  if (next == nullptr) next = behind<int (*)(pthread_rwlock_t*)>("pthread_rwlock_rdlock");
  return next.load()(lock);
}

int pthread_rwlock_wrlock(pthread_rwlock_t* lock) noexcept {
  static std::atomic<int (*)(pthread_rwlock_t*)> next{nullptr};
  palpate::loop::forbid("lock");
  if (next == nullptr) next = behind<int (*)(pthread_rwlock_t*)>("pthread_rwlock_wrlock");
  return next.load()(lock);
}

}  // extern "C"
#pragma GCC visibility pop

#endif

#include "rt/loop/allocation_counter.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>

#include "rt/loop/sanitizer.hpp"

namespace palpate::loop {
namespace {

// Zero-initialised and trivial: reading them allocates nothing, not even at a thread's start.
thread_local std::int64_t allocations = 0;
thread_local int forbidden = 0;

#ifdef PALPATE_RTCHECK
std::atomic<bool> abort_at_once{true};
#else
std::atomic<bool> abort_at_once{false};
#endif

/// Called before every allocation.
[[maybe_unused]] void count_allocation() noexcept {
  ++allocations;
  if (forbidden == 0 || !abort_at_once.load(std::memory_order_relaxed)) return;
  forbidden = 0;
  constexpr char kText[] =
      "palpate: allocation where none is allowed; see the stack of this abort\n";
  const ssize_t written = write(STDERR_FILENO, kText, sizeof(kText) - 1);
  static_cast<void>(written);
  std::abort();
}

}  // namespace

std::int64_t allocations_of_this_thread() noexcept { return kSanitized ? -1 : allocations; }

std::int64_t page_faults_of_this_thread() noexcept {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_minflt + usage.ru_majflt;
}

NoAllocationScope::NoAllocationScope() noexcept : before_(allocations) { ++forbidden; }

NoAllocationScope::~NoAllocationScope() {
  if (forbidden > 0) --forbidden;
}

std::int64_t NoAllocationScope::count() const noexcept { return allocations - before_; }

void abort_on_allocation(bool abort) noexcept {
  abort_at_once.store(abort, std::memory_order_relaxed);
}

}  // namespace palpate::loop

#if !PALPATE_SANITIZED

// The C library's own entry points under their other names. free() is here only so that all memory
// goes back to where it came from, even where a preloaded library has a free() of its own.
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

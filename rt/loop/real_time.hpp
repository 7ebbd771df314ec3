#pragma once

#include <string>

namespace palpate::loop {

/// Individual steps of FixedRateLoop::acquire_real_time(). Each returns an empty text if the system
/// granted it, otherwise one line: the rejected setting, reason, and remedy.

/// Prevents the heap from being returned to the system, prefaults the heap and this thread's stack,
/// and locks all present and future memory of the process.
std::string lock_and_prefault_memory();

/// Whether lock_and_prefault_memory() has locked this process; a page fault is then an error.
bool memory_is_locked() noexcept;

/// Sets SCHED_FIFO for the calling thread; threads that it starts later do not inherit it.
std::string take_fifo(int priority);

/// Binds the calling thread to one processor.
std::string take_cpu(int cpu);

}  // namespace palpate::loop

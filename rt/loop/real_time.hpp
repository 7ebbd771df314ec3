#pragma once

#include <string>

namespace palpate::loop {

/// The steps of FixedRateLoop::acquire_real_time(), one by one. Each returns an empty text where
/// the system granted it, else one line: what was refused, why, and how to get it.

/// Keeps the heap from being given back to the system, makes the heap and this thread's stack
/// present, and locks all memory of the process, present and future.
std::string lock_and_prefault_memory();

/// Whether lock_and_prefault_memory() has locked this process: a page fault is then a defect.
bool memory_is_locked() noexcept;

/// SCHED_FIFO for the calling thread; threads that it starts later do not inherit it.
std::string take_fifo(int priority);

/// Binds the calling thread to one processor.
std::string take_cpu(int cpu);

}  // namespace palpate::loop

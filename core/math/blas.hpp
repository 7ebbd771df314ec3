#pragma once

#include <string>

namespace palpate::math {

/// The BLAS that this process has loaded.
struct Blas {
  std::string file;  // path of the shared library; empty if there is none
  int threads = 1;   // that it uses
  /// False: no locks protect its buffers, so that a product may be wrong if two threads of this
  /// process call it at the same time.
  bool is_thread_safe = true;
};

/// Ends the threads of an OpenBLAS built with POSIX threads, which are opened while the process
/// starts and would take the processors of the loop; calls from several threads remain safe. Other
/// builds are left as they are. The first call must not coincide with another use of the BLAS.
/// `library`: handle of the dlopen() that has loaded it; without one, it belongs to the program.
Blas hold_blas_to_one_thread(void* library = nullptr);

/// What is wrong with a BLAS for a process with several threads, and what to do about it; empty if
/// nothing is.
std::string problem_of(const Blas& blas);

}  // namespace palpate::math

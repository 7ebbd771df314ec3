#pragma once

#include <string>

namespace palpate::factor {

/// During the lifetime of this object parallel regions of OpenMP that the calling thread enters are
/// executed by it alone: CHOLMOD's request four threads whatever OMP_NUM_THREADS is. Without effect
/// if no OpenMP is loaded.
class OneThread {
 public:
  OneThread() noexcept;
  ~OneThread();
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  int levels_ = 0;  // of nested parallel regions that were allowed before
};

/// The BLAS that this process has loaded.
struct Blas {
  std::string file;  // path of the shared library; empty if there is none
  int threads = 1;   // that it uses; those of OpenBLAS exist from the start of the process
};
Blas loaded_blas();

}  // namespace palpate::factor

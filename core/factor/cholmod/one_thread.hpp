#pragma once

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

}  // namespace palpate::factor

#include "core/math/blas.hpp"

#include <dlfcn.h>

namespace palpate::math {
namespace {

enum OpenBlasBuild { kSerial = 0, kPosixThreads = 1 };  // openblas_get_parallel(); 2: OpenMP

// All functions are looked up at run time: which BLAS there is, is the choice of the machine.
template <class Function>
Function* function_of(void* library, const char* name) {
  return reinterpret_cast<Function*>(dlsym(library, name));
}

void hold_openblas(void* library, Blas& blas) {
  const auto parallel = function_of<int()>(library, "openblas_get_parallel");
  const auto threads = function_of<int()>(library, "openblas_get_num_threads");
  if (parallel == nullptr || threads == nullptr) return;
  // Debian's serial build has no locks; whether another one has them cannot be asked.
  blas.is_thread_safe = parallel() != kSerial;
  const auto set_threads = function_of<void(int)>(library, "openblas_set_num_threads");
  const auto end_threads = function_of<void()>(library, "blas_thread_shutdown_");
  if (parallel() != kPosixThreads || threads() == 1) return;
  if (set_threads == nullptr || end_threads == nullptr) return;
  set_threads(1);
  end_threads();
}

}  // namespace

Blas hold_blas_to_one_thread(void* library) {
  Blas blas;
  Dl_info found{};
  void* const product = dlsym(library == nullptr ? RTLD_DEFAULT : library, "dgemm_");
  if (product == nullptr || dladdr(product, &found) == 0) return blas;
  blas.file = found.dli_fname;
  // Several instances may be loaded: that of the product is asked.
  void* const self = dlopen(found.dli_fname, RTLD_LAZY | RTLD_NOLOAD);
  if (self == nullptr) return blas;
  hold_openblas(self, blas);
  for (const char* name :
       {"openblas_get_num_threads", "bli_thread_get_num_threads", "MKL_Get_Max_Threads"}) {
    if (const auto threads = function_of<int()>(self, name)) {
      blas.threads = threads() > 1 ? threads() : 1;  // BLIS: -1 unless set
      break;
    }
  }
  dlclose(self);
  return blas;
}

std::string problem_of(const Blas& blas) {
  constexpr const char* kRemedy =
      "; select that of the package libopenblas0-pthread by update-alternatives";
  if (!blas.is_thread_safe)
    return "the BLAS " + blas.file + " is not thread-safe, results may be wrong" + kRemedy;
  if (blas.threads > 1)
    return "the BLAS " + blas.file + " uses " + std::to_string(blas.threads) +
           " threads, which take the processors of the loop" + kRemedy;
  return "";
}

}  // namespace palpate::math

#include "core/factor/cholmod/one_thread.hpp"

#include <dlfcn.h>

namespace palpate::factor {
namespace {

// OpenMP's functions are looked up at run time, because which OpenMP there is, if any, is the
// choice of who has built CHOLMOD.
template <class Function>
Function* loaded_function(void* library, const char* name) {
  return reinterpret_cast<Function*>(dlsym(library, name));
}

struct Levels {
  int (*get)() = loaded_function<int()>(RTLD_DEFAULT, "omp_get_max_active_levels");
  void (*set)(int) = loaded_function<void(int)>(RTLD_DEFAULT, "omp_set_max_active_levels");
};

const Levels& openmp_levels() {
  static const Levels levels;
  return levels;
}

}  // namespace

OneThread::OneThread() noexcept {
  const Levels& levels = openmp_levels();
  if (levels.get == nullptr || levels.set == nullptr) return;
  levels_ = levels.get();
  levels.set(0);
}

OneThread::~OneThread() {
  const Levels& levels = openmp_levels();
  if (levels.get != nullptr && levels.set != nullptr) levels.set(levels_);
}

}  // namespace palpate::factor

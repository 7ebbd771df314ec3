#include "tests/bench/core/elasticity/single_thread.hpp"

#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <initializer_list>

namespace palpate::bench {

void run_libraries_in_one_thread(char** argv) {
  bool complete = true;
  for (const char* name : {"OMP_THREAD_LIMIT", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"}) {
    const char* value = std::getenv(name);
    if (value != nullptr && std::strcmp(value, "1") == 0) continue;
    complete = false;
    setenv(name, "1", 1);
  }
  if (!complete) execv("/proc/self/exe", argv);  // where that fails, go on as we are
}

}  // namespace palpate::bench

// Runs first, and is compiled for the oldest processor: on one that lacks the instructions of this
// build, the program could not even start its checks.

#include <unistd.h>

namespace {

#ifdef PALPATE_FOR_V3
[[gnu::constructor(101)]] void refuse_old_processor() {
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
      __builtin_cpu_supports("bmi2"))
    return;
  constexpr char kWords[] =
      "fail  cpu  lacks avx2, fma or bmi2: programs built for x86-64-v3 end with SIGILL here\n"
      "      fix: cmake --preset release -DPALPATE_MARCH=x86-64 && cmake --build build/release\n";
  const ssize_t ignored = write(STDOUT_FILENO, kWords, sizeof(kWords) - 1);
  _exit(ignored > 0 ? 1 : 2);
}
#endif

}  // namespace

// Runs a fuzz target without libFuzzer: its seeds, the corpus, then random damage of both, so that
// every build and compiler runs the targets among its tests.
//   PALPATE_FUZZ_ROUNDS=1000000 PALPATE_FUZZ_SEED=2 fuzz_meshes [CORPUS-FOLDER]

#include <sys/resource.h>

#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>

#include "tests/fuzz/mutation.hpp"
#include "tests/fuzz/target.hpp"

namespace {

constexpr unsigned kLongestInput = 20;  // s, of one input on a busy machine
constexpr long kMostMemory = 1 << 20;   // kB

volatile std::sig_atomic_t round_now = -1;  // -1: undamaged

/// Reports the input; uses only functions that a signal handler may call.
void report_and_exit(int signal) {
  char text[] = "\nsignal 00 in round 0000000000\n";
  text[8] = static_cast<char>('0' + signal / 10);
  text[9] = static_cast<char>('0' + signal % 10);
  long rest = round_now + 1;  // 0: one of the undamaged
  for (char* digit = text + sizeof(text) - 3; rest > 0; rest /= 10, --digit)
    *digit = static_cast<char>('0' + rest % 10);
  (void)!write(STDERR_FILENO, text, sizeof(text) - 1);
  _exit(1);
}

void run(const std::string& input) {
  alarm(kLongestInput);
  // A copy of exact size, so that a sanitizer detects a read beyond its end.
  const std::vector<std::uint8_t> bytes(input.begin(), input.end());
  LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
}

}  // namespace

int main(int argc, char** argv) {
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGBUS, SIGILL, SIGALRM})
    std::signal(signal, report_and_exit);
  std::vector<std::string> inputs = palpate::fuzz::seeds();
  if (argc > 1 && std::filesystem::is_directory(argv[1])) {
    for (const auto& entry : std::filesystem::directory_iterator(argv[1])) {
      std::ostringstream bytes;
      bytes << std::ifstream(entry.path(), std::ios::binary).rdbuf();
      inputs.push_back(bytes.str());
    }
  }
  run("");
  for (const std::string& input : inputs) run(input);

  const long rounds = palpate::fuzz::setting("PALPATE_FUZZ_ROUNDS", PALPATE_FUZZ_DEFAULT_ROUNDS);
  const auto seed = static_cast<std::uint64_t>(palpate::fuzz::setting("PALPATE_FUZZ_SEED", 1));
  for (long round = 0; round < rounds; ++round) {
    round_now = static_cast<std::sig_atomic_t>(round);
    const std::uint64_t number = seed * 1000003 + static_cast<std::uint64_t>(round);
    std::string input = inputs[number % inputs.size()];
    // Sometimes repeated damage.
    for (std::uint64_t k = 0; k <= number % 3 && !input.empty(); ++k)
      input = palpate::fuzz::damaged(input, number * 3 + k);
    run(input);
  }
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  std::cout << inputs.size() << " inputs and " << rounds << " damaged ones, "
            << usage.ru_maxrss / 1024 << " MB at most\n";
  return usage.ru_maxrss < kMostMemory ? 0 : 1;
}

// palpate-probe INPUTS STATES OUTPUTS < module.pt
//
// Loads a TorchScript module and evaluates it on zeros, in a process that may crash, hang or
// exhaust its memory without consequences. Exit code 0: accepted; 1: rejected, with the reason on
// standard output. Run before a module is loaded; see model_probe.hpp.

#include <sys/resource.h>

#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <iterator>
#include <vector>

#include "rt/inference/model_probe.hpp"
#include "rt/inference/torch_module.hpp"
#include "rt/loop/sanitizer.hpp"

namespace {

using namespace palpate::inference;

/// Call after libtorch has been initialised, whose start does not count.
void limit_this_process() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  const auto seconds =
      static_cast<rlim_t>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) + kProbeSeconds + 1;
  const rlimit processor{seconds, seconds + 1};
  setrlimit(RLIMIT_CPU, &processor);
  const rlimit none{0, 0};
  setrlimit(RLIMIT_CORE, &none);
  const rlimit memory{kProbeMemory, kProbeMemory};
  if (!palpate::loop::kSanitized) setrlimit(RLIMIT_AS, &memory);
}

/// Throws ModelError.
void try_module(const std::string& bytes, const ModelSizes& sizes) {
  const std::unique_ptr<SequenceModel> model = load_torch_module(bytes, sizes);
  const std::vector<float> input(sizes.inputs, 0.f);
  std::vector<float> state(sizes.states, 0.f), output(sizes.outputs);
  for (int step = 1; step <= kProbeSteps; ++step)
    if (!model->step(input.data(), state.data(), output.data()))
      throw ModelError("step " + std::to_string(step) +
                       " on zeros fails or gives a number that is not finite");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::cerr << "usage: palpate-probe INPUTS STATES OUTPUTS < module.pt\n";
    return 64;  // EX_USAGE, as rt/config/command_line.hpp has it
  }
  try {
    torch_version();
    limit_this_process();
    std::cin >> std::noskipws;
    const std::string bytes(std::istreambuf_iterator<char>(std::cin), {});
    try_module(bytes, {std::atoi(argv[1]), std::atoi(argv[2]), std::atoi(argv[3])});
  } catch (const std::bad_alloc&) {
    std::cout << "it wants too much memory";
    return 1;
  } catch (const std::exception& error) {
    std::cout << error.what();
    return 1;
  }
  std::cout.flush();
  std::_Exit(0);  // skips libtorch's shutdown, which takes longer than everything else
}

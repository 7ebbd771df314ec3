// Cards of learned models.

#include "rt/config/node.hpp"
#include "rt/inference/model_card.hpp"
#include "tests/fuzz/target.hpp"

namespace palpate::fuzz {

std::vector<std::string> seeds() {
  const std::string head =
      "format: " + std::to_string(inference::ModelCard::kFormat) +
      "\nname: sample\narchitecture: recurrent_network\nsha256: " + std::string(64, '0') +
      "\nrate: 100\naverage: 0.01\nstates: 40\n";
  const std::string channels =
      "inputs: [{name: e0, unit: count}, {name: e1, unit: count}]\n"
      "outputs: [{name: fx, unit: N}]\n";
  return {head + channels,
          head + channels +
              "payload: {mass: 1.5, first_moment: [0, 0, 0.1], inertia: [1, 0, 0, 1, 0, 1]}\n"
              "domain: {near: 1, far: 2, deviation: [1, 2], points: [0, 0, 1, 1]}\n",
          head + channels +
              "delays: [{stream: imu, seconds: 0.01}]\ntraining: {errors: [0.1, 0.2], of: run}\n"};
}

}  // namespace palpate::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  const fuzz::MemoryFile file({reinterpret_cast<const char*>(data), size});
  try {
    const inference::ModelCard card = inference::read_card(file.path());
    const inference::ModelSizes sizes = card.sizes();
    fuzz::require(sizes.inputs >= 1 && sizes.inputs <= 256, "inputs in range");
    fuzz::require(sizes.outputs >= 1 && sizes.outputs <= 64, "outputs in range");
    fuzz::require(sizes.states >= 0 && sizes.states <= 8192, "states in range");
    fuzz::require(card.rate >= 0.1 && card.rate <= 10000, "a rate in range");
    fuzz::require(card.sha256.size() == 64, "a hash of 64 digits");
  } catch (const config::Error& error) {
    fuzz::require(std::string(error.what()).find(file.path()) == 0, "an error names its file");
  }
  return 0;
}

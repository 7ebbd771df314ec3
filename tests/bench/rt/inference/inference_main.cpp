#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <random>

#include "rt/inference/compiled_executor.hpp"
#include "rt/inference/torch_executor.hpp"
#include "rt/inference/torch_module.hpp"
#include "rt/loop/allocation_counter.hpp"
#include "tools/evaluate/table.hpp"

// What one sample costs: libtorch streamed, libtorch over a window computed anew for each sample
// (as in the thesis), libtorch on its own thread, and palpate's kernel.
namespace {

using namespace palpate;

constexpr int kWindow = 50;

struct Network {
  const char* name;
  int inputs, outputs;
  std::vector<int> layers;
};

sensing::RecurrentWeights random_weights(const Network& network) {
  std::mt19937 random(1);
  std::normal_distribution<float> normal(0, 0.2f);
  sensing::RecurrentWeights weights =
      sensing::RecurrentWeights::zero(network.inputs, network.outputs, network.layers);
  for (sensing::LstmWeights& layer : weights.layers)
    for (Eigen::MatrixXf* part : {&layer.input, &layer.hidden})
      for (Eigen::Index i = 0; i < part->size(); ++i) part->data()[i] = normal(random);
  for (Eigen::Index i = 0; i < weights.dense.size(); ++i) weights.dense.data()[i] = normal(random);
  return weights;
}

/// A window for each sample: the state begins at zero and runs over the last samples.
class Windowed final : public inference::SequenceModel {
 public:
  explicit Windowed(std::unique_ptr<inference::SequenceModel> model) : model_(std::move(model)) {}
  inference::ModelSizes sizes() const noexcept override { return model_->sizes(); }
  const char* kind() const noexcept override { return model_->kind(); }
  bool step(const float* input, float* state, float* output) noexcept override {
    std::fill_n(state, sizes().states, 0.f);
    bool good = true;
    for (int i = 0; i < kWindow; ++i) good = model_->step(input, state, output) && good;
    return good;
  }

 private:
  std::unique_ptr<inference::SequenceModel> model_;
};

struct Row {
  double p50, p99, p999;  // us
  double allocations;     // per sample, of the caller's thread
  long late;
};

Row measure(inference::Executor& executor, int samples) {
  const inference::ModelSizes sizes = executor.sizes();
  std::mt19937 random(2);
  std::normal_distribution<float> normal;
  std::vector<float> input(sizes.inputs), output(sizes.outputs);
  std::vector<double> times(samples);
  std::int64_t allocations = 0;
  for (int k = -samples / 10; k < samples; ++k) {
    for (float& x : input) x = normal(random);
    const std::int64_t before = loop::allocations_of_this_thread();
    const auto start = std::chrono::steady_clock::now();
    executor.step(input.data(), output.data());
    const std::chrono::duration<double, std::micro> time = std::chrono::steady_clock::now() - start;
    if (k < 0) continue;
    times[k] = time.count();
    allocations += loop::allocations_of_this_thread() - before;
  }
  std::sort(times.begin(), times.end());
  const auto at = [&](double part) {
    return times[static_cast<std::size_t>(part * (samples - 1))];
  };
  return {at(0.5), at(0.99), at(0.999), static_cast<double>(allocations) / samples,
          static_cast<long>(executor.counters().late)};
}

}  // namespace

int main(int argc, char** argv) {
  int samples = 5000;
  std::string json_file;
  CLI::App app("Latency and allocations of a sample through each executor.");
  app.add_option("--samples", samples, "Of each row")->check(CLI::Range(10, 1000000));
  app.add_option("--json", json_file, "File for the figures");
  CLI11_PARSE(app, argc, argv);

  nlohmann::json json = nlohmann::json::array();
  evaluate::Table table(
      {"network and executor", "p50 us", "p99 us", "p99.9 us", "allocations a sample", "late"});
  for (const Network& network : {Network{"biotac 21 -> 20, 20 -> 3", 21, 3, {20, 20}},
                                 Network{"wrist 12 -> 15, 10 -> 6", 12, 6, {15, 10}}}) {
    const sensing::RecurrentWeights weights = random_weights(network);
    const std::string bytes = inference::write_torch_module(weights);
    const inference::ModelSizes sizes{network.inputs, weights.states(), network.outputs};
    table.section(network.name);
    const auto add = [&](const std::string& name, inference::Executor& executor, int count) {
      const Row row = measure(executor, count);
      table.add({name, evaluate::number(row.p50, 1), evaluate::number(row.p99, 1),
                 evaluate::number(row.p999, 1), evaluate::number(row.allocations, 1),
                 std::to_string(row.late)});
      json.push_back({{"network", network.name},
                      {"executor", name},
                      {"p50_us", row.p50},
                      {"p99_us", row.p99},
                      {"p999_us", row.p999},
                      {"allocations", row.allocations},
                      {"late", row.late}});
    };
    inference::DirectExecutor streamed(inference::load_torch_module(bytes, sizes));
    add("torch, streamed", streamed, samples);
    inference::DirectExecutor windowed(
        std::make_unique<Windowed>(inference::load_torch_module(bytes, sizes)));
    add("torch, window of 50", windowed, std::max(10, samples / 10));
    inference::TorchExecutor threaded(inference::load_torch_module(bytes, sizes));
    add("torch, streamed on its thread", threaded, samples);
    inference::DirectExecutor compiled(std::make_unique<inference::CompiledModel>(weights));
    add("compiled", compiled, samples);
  }
  table.print(std::cout);
  if (!json_file.empty()) {
    std::ofstream file(json_file);
    file << json.dump(2) << '\n';
    if (!file) {
      std::cerr << json_file << ": cannot be written\n";
      return 1;
    }
  }
  return 0;
}

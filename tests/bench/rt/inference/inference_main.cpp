#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "rt/config/command_line.hpp"
#include "rt/inference/compiled_executor.hpp"
#include "rt/inference/torch_executor.hpp"
#include "rt/inference/torch_module.hpp"
#include "rt/loop/allocation_counter.hpp"
#include "tests/bench/rt/inference/subjects.hpp"
#include "tools/common/table.hpp"

// Cost of one sample for the loop: palpate's kernel, libtorch streamed, libtorch over a window
// evaluated again for each sample as in the thesis, and libtorch in a separate thread.
namespace {

using namespace palpate;

struct Options {
  int samples = 100000;
  int windowed_samples = 10000;
  int period_us = 0;
  inference::TorchExecutorOptions threaded;
};

struct Figures {
  int samples = 0;
  double p50 = 0, p99 = 0, p999 = 0, largest = 0;  // us
  double loop_allocations = 0;                     // per sample, in the calling thread
  double model_allocations = 0;                    // per sample, in the thread that runs the model
  long late = 0;
};

/// Times of `executor` for its caller, on samples at intervals of `period_us`, or without pause.
Figures measure(inference::Executor& executor, const std::atomic<std::int64_t>& model_allocations,
                int samples, int period_us) {
  const inference::ModelSizes sizes = executor.sizes();
  std::mt19937 random(2);
  std::normal_distribution<float> normal;
  std::vector<float> input(sizes.inputs), output(sizes.outputs);
  std::vector<double> times(samples);
  std::int64_t in_loop = 0, in_model = 0, late = 0;
  auto next = std::chrono::steady_clock::now();
  for (int k = -samples / 10; k < samples; ++k) {
    // A window moves on by one sample of a few numbers; generating them all would dominate.
    for (int i = 0; i < std::min(sizes.inputs, 32); ++i) input[i] = normal(random);
    if (k == 0) {
      in_model = model_allocations;
      late = executor.counters().late;
    }
    if (period_us > 0) std::this_thread::sleep_until(next += std::chrono::microseconds(period_us));
    const std::int64_t before = loop::allocations_of_this_thread();
    const auto start = std::chrono::steady_clock::now();
    executor.step(input.data(), output.data());
    const std::chrono::duration<double, std::micro> time = std::chrono::steady_clock::now() - start;
    if (k < 0) continue;
    times[k] = time.count();
    in_loop += loop::allocations_of_this_thread() - before;
  }
  std::sort(times.begin(), times.end());
  const auto at = [&](double part) {
    return times[static_cast<std::size_t>(part * (samples - 1))];
  };
  return {samples,
          at(0.5),
          at(0.99),
          at(0.999),
          times.back(),
          static_cast<double>(in_loop) / samples,
          static_cast<double>(model_allocations - in_model) / samples,
          static_cast<long>(executor.counters().late - late)};
}

class Report {
 public:
  void section(const char* network) {
    network_ = network;
    table_.section(network);
  }

  /// The first of a section is the reference for the others.
  void add(const char* executor, const Figures& figures) {
    if (network_ != compared_) reference_ = figures.p50;
    compared_ = network_;
    const double ratio = figures.p50 / reference_;
    const auto text = [](double value) { return common::number(value, 1); };
    table_.add({executor, std::to_string(figures.samples), text(figures.p50), text(figures.p99),
                text(figures.p999), text(figures.largest), text(ratio),
                text(figures.loop_allocations), text(figures.model_allocations),
                std::to_string(figures.late)});
    json_.push_back({{"network", network_},
                     {"executor", executor},
                     {"samples", figures.samples},
                     {"p50_us", figures.p50},
                     {"p99_us", figures.p99},
                     {"p99.9_us", figures.p999},
                     {"max_us", figures.largest},
                     {"ratio", ratio},
                     {"loop_allocations", figures.loop_allocations},
                     {"model_allocations", figures.model_allocations},
                     {"late", figures.late}});
  }

  void print() const {
    table_.print(std::cout);
    std::cout << "times in us; ratio: of p50 to that of compiled; allocations a sample, in the "
                 "thread that\ncalls and in the one that runs the model, which are the same but "
                 "for the last row of each\n";
  }
  const nlohmann::json& json() const { return json_; }

 private:
  common::Table table_{{"network and executor", "samples", "p50", "p99", "p99.9", "max", "ratio",
                        "caller's", "model's", "late"}};
  nlohmann::json json_ = nlohmann::json::array();
  std::string network_, compared_;
  double reference_ = 1;
};

void measure_network(const bench::Network& network, const Options& options, Report& report) {
  const sensing::RecurrentWeights weights = bench::random_weights(network);
  const std::string bytes = inference::write_torch_module(weights);
  const inference::ModelSizes sizes{network.inputs, weights.states(), network.outputs};
  const inference::ModelSizes window{network.inputs * network.window, 1, network.outputs};
  std::atomic<std::int64_t> allocations{0};
  const auto counted = [&](std::unique_ptr<inference::SequenceModel> model) {
    return std::make_unique<bench::Counted>(std::move(model), allocations);
  };
  const auto direct = [&](std::unique_ptr<inference::SequenceModel> model, int samples) {
    inference::DirectExecutor executor(counted(std::move(model)));
    return measure(executor, allocations, samples, options.period_us);
  };
  report.section(network.name);
  report.add("compiled",
             direct(std::make_unique<inference::CompiledModel>(weights), options.samples));
  report.add("torch, streamed",
             direct(inference::load_torch_module(bytes, sizes), options.samples));
  report.add("torch, windowed",
             direct(inference::load_torch_module(bench::windowed_module(network, weights), window),
                    options.windowed_samples));
  inference::TorchExecutor threaded(counted(inference::load_torch_module(bytes, sizes)),
                                    options.threaded);
  report.add("torch, streamed on its thread",
             measure(threaded, allocations, options.samples, options.period_us));
}

/// Cost of a hanging model for the loop: only the time that it waits.
void measure_hang(const Options& options, Report& report) {
  std::atomic<bool> hangs{false};
  std::atomic<std::int64_t> allocations{0};
  inference::TorchExecutorOptions patient = options.threaded;
  patient.patience = 100;
  inference::TorchExecutor executor(std::make_unique<bench::Hanging>(hangs), patient);
  report.section("a model that hangs");
  hangs = true;
  report.add("on its thread", measure(executor, allocations, std::max(10, options.samples / 100),
                                      options.period_us));
  hangs = false;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  std::string json_file;
  double wait_us = options.threaded.wait * 1e6;
  CLI::App app(
      "Latency and allocations of a sample through each executor, as the loop's thread sees them.");
  app.add_option("--samples", options.samples, "of each row")->check(CLI::Range(10, 10000000));
  app.add_option("--windowed-samples", options.windowed_samples, "of each row with a window")
      ->check(CLI::Range(10, 10000000));
  app.add_option("--period-us", options.period_us, "between samples; 0: at once")
      ->check(CLI::Range(0, 1000000));
  app.add_option("--wait-us", wait_us, "that the loop waits for an answer")
      ->check(CLI::Range(0.0, 1e5));
  app.add_option("--priority", options.threaded.fifo_priority,
                 "SCHED_FIFO priority of the inference thread; 0: none")
      ->check(CLI::Range(0, 98));
  app.add_option("--cpu", options.threaded.cpu, "processor of the inference thread; -1: any")
      ->check(CLI::Range(-1, 1023));
  app.add_option("--json", json_file, "file for the figures");
  if (const auto code = palpate::config::parse(app, argc, argv)) return *code;
  options.threaded.wait = wait_us * 1e-6;
  options.threaded.patience = std::max(options.threaded.patience, options.threaded.wait);
  std::vector<std::string> remarks;
  options.threaded.remarks = &remarks;

  Report report;
  for (const bench::Network& network : bench::networks()) measure_network(network, options, report);
  measure_hang(options, report);
  report.print();
  for (const std::string& remark : remarks) std::cout << remark << "\n";
  if (!json_file.empty()) {
    std::ofstream file(json_file);
    file << report.json().dump(2) << '\n';
    if (!file) {
      std::cerr << json_file << ": cannot be written\n";
      return 1;
    }
  }
  return 0;
}

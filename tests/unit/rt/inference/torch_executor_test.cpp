#include "rt/inference/torch_executor.hpp"

#include <gtest/gtest.h>
#include <sched.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "rt/inference/compiled_executor.hpp"
#include "rt/loop/allocation_counter.hpp"

namespace palpate::inference {
namespace {

/// Accumulates its inputs in its state; may be delayed, or fail.
struct Remote {
  std::atomic<bool> open{true};
  std::atomic<bool> fails{false};
  std::atomic<int> begun{0};
};

class Adder final : public SequenceModel {
 public:
  explicit Adder(Remote& remote) : remote_(remote) {}
  ModelSizes sizes() const noexcept override { return {1, 1, 1}; }
  bool step(const float* input, float* state, float* output) noexcept override {
    ++remote_.begun;
    while (!remote_.open) std::this_thread::sleep_for(std::chrono::microseconds(50));
    if (remote_.fails) return false;
    state[0] += input[0];
    output[0] = state[0];
    return true;
  }
  const char* kind() const noexcept override { return "adder"; }

 private:
  Remote& remote_;
};

/// Waits long enough for any machine.
TorchExecutorOptions patient() {
  TorchExecutorOptions options;
  options.wait = 10;
  options.patience = 50;
  return options;
}

TEST(TorchExecutor, GivesEachSamplesAnswerInTheSameStep) {
  Remote remote;
  TorchExecutor executor(std::make_unique<Adder>(remote), patient());
  float output = 0, sum = 0;
  for (int k = 1; k <= 200; ++k) {
    const auto input = static_cast<float>(k);
    sum += input;
    ASSERT_EQ(executor.step(&input, &output), Answer::kFresh);
    ASSERT_EQ(output, sum);
  }
  EXPECT_EQ(executor.counters().steps, 200);
  EXPECT_EQ(executor.counters().late, 0);
  EXPECT_STREQ(executor.kind(), "adder");
}

TEST(TorchExecutor, TheWarmUpLeavesNoTraceAndResetRestarts) {
  Remote remote;
  TorchExecutorOptions options = patient();
  options.warm_up = 7;
  TorchExecutor executor(std::make_unique<Adder>(remote), options);
  EXPECT_EQ(remote.begun, 7);
  float input = 2, output = 0;
  executor.step(&input, &output);
  EXPECT_EQ(output, 2);
  executor.reset();
  input = 5;
  ASSERT_EQ(executor.step(&input, &output), Answer::kFresh);
  EXPECT_EQ(output, 5);
}

TEST(TorchExecutor, TakesLateAnswersLaterWithoutLosingASample) {
  Remote remote;
  TorchExecutorOptions options;
  options.wait = 1e-3;
  options.patience = 50;
  TorchExecutor executor(std::make_unique<Adder>(remote), options);
  float input = 1, output = -1;
  remote.open = false;
  EXPECT_EQ(executor.step(&input, &output), Answer::kNone);
  EXPECT_EQ(executor.step(&input, &output), Answer::kNone);
  EXPECT_EQ(output, -1);
  EXPECT_EQ(executor.counters().late, 2);
  remote.open = true;
  input = 0;
  Answer answer = Answer::kNone;
  while (answer != Answer::kFresh) {
    answer = executor.step(&input, &output);
    if (answer == Answer::kLate) {
      ASSERT_TRUE(output == 1 || output == 2);
    }
  }
  EXPECT_EQ(output, 2);  // both samples that arrived during the delay
  EXPECT_EQ(executor.counters().dropped, 0);
}

TEST(TorchExecutor, AHangIsAFaultUntilResetAndTheEndDoesNotWaitForEver) {
  static Remote remote;  // outlives the abandoned thread
  TorchExecutorOptions options;
  options.wait = 1e-4;
  options.patience = 2;  // longer than the delay of a thread on a busy machine
  options.depth = 4;
  {
    TorchExecutor executor(std::make_unique<Adder>(remote), options);
    remote.open = false;
    float input = 1, output = 0;
    Answer answer = Answer::kNone;
    for (int k = 0; k < 100000 && answer != Answer::kFault; ++k)
      answer = executor.step(&input, &output);
    ASSERT_EQ(answer, Answer::kFault);
    EXPECT_GT(executor.counters().dropped, 0);
    EXPECT_EQ(executor.counters().faults, 1);
    EXPECT_EQ(executor.step(&input, &output), Answer::kFault);
    executor.reset();
    EXPECT_EQ(executor.step(&input, &output), Answer::kNone);
  }
  remote.open = true;  // that thread may end now
}

TEST(TorchExecutor, AFailureIsAFaultUntilReset) {
  Remote remote;
  TorchExecutor executor(std::make_unique<Adder>(remote), patient());
  float input = 1, output = 0;
  ASSERT_EQ(executor.step(&input, &output), Answer::kFresh);
  remote.fails = true;
  EXPECT_EQ(executor.step(&input, &output), Answer::kFault);
  EXPECT_EQ(executor.step(&input, &output), Answer::kFault);
  EXPECT_EQ(executor.counters().faults, 1);
  remote.fails = false;
  executor.reset();
  EXPECT_EQ(executor.step(&input, &output), Answer::kFresh);
  EXPECT_EQ(output, 1);
}

TEST(TorchExecutor, TheLoopsSideAllocatesNothing) {
  Remote remote;
  TorchExecutor executor(std::make_unique<Adder>(remote), patient());
  float input = 1, output = 0;
  loop::NoAllocationScope scope;
  for (int k = 0; k < 100; ++k) executor.step(&input, &output);
  executor.reset();
  EXPECT_EQ(scope.count(), 0);
}

TEST(TorchExecutor, RefusesOptionsOutOfRangeAndAModelThatFailsAtOnce) {
  Remote remote;
  const auto make = [&](TorchExecutorOptions options) {
    TorchExecutor executor(std::make_unique<Adder>(remote), options);
  };
  TorchExecutorOptions options;
  options.depth = 0;
  EXPECT_THROW(make(options), std::invalid_argument);
  options = {};
  options.patience = options.wait / 2;
  EXPECT_THROW(make(options), std::invalid_argument);
  remote.fails = true;
  EXPECT_THROW(make({}), std::runtime_error);
}

TEST(TorchExecutor, SaysInOneLineWhatIsNotGranted) {
  Remote remote;
  std::vector<std::string> remarks;
  TorchExecutorOptions options = patient();
  options.remarks = &remarks;
  options.cpu = 1023;  // more processors than any test machine has
  TorchExecutor first(std::make_unique<Adder>(remote), options);
  TorchExecutor second(std::make_unique<Adder>(remote), options);
  ASSERT_EQ(remarks.size(), 1u);
  EXPECT_EQ(remarks[0].rfind("inference thread: not bound to processor 1023", 0), 0u) << remarks[0];
  EXPECT_EQ(remarks[0].find('\n'), std::string::npos);
  float input = 2, output = 0;
  EXPECT_EQ(first.step(&input, &output), Answer::kFresh);  // it runs nevertheless
  EXPECT_EQ(output, 2);
}

/// Outputs the priority of its thread, 0 without SCHED_FIFO; may be delayed.
struct Asking final : SequenceModel {
  explicit Asking(Remote& r) : remote(r) {}
  ModelSizes sizes() const noexcept override { return {1, 1, 1}; }
  bool step(const float*, float*, float* output) noexcept override {
    do {
      sched_param parameters{};
      sched_getparam(0, &parameters);
      remote.begun = parameters.sched_priority;
      std::this_thread::sleep_for(std::chrono::microseconds(50));
    } while (!remote.open);
    output[0] = static_cast<float>(remote.begun);
    return true;
  }
  const char* kind() const noexcept override { return "asking"; }
  Remote& remote;
};

TEST(TorchExecutor, TakesAPriorityAndGivesItBackWhileItHangs) {
  Remote remote;
  std::vector<std::string> remarks;
  TorchExecutorOptions options;
  options.wait = options.patience = 0.05;
  options.remarks = &remarks;
  options.fifo_priority = 1;
  TorchExecutor executor(std::make_unique<Asking>(remote), options);
  if (!remarks.empty()) {
    EXPECT_NE(remarks[0].find("no SCHED_FIFO priority 1"), std::string::npos);
    GTEST_SKIP() << remarks[0];
  }
  EXPECT_EQ(remote.begun, 1);
  float input = 0, output = -1;
  remote.open = false;
  while (executor.step(&input, &output) != Answer::kFault) {
  }
  while (remote.begun != 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  remote.open = true;
  do {
    executor.reset();
  } while (executor.step(&input, &output) != Answer::kFresh);
  EXPECT_EQ(output, 1);
}

TEST(DirectExecutor, CarriesTheStateAndLatchesFaults) {
  Remote remote;
  DirectExecutor executor(std::make_unique<Adder>(remote));
  float input = 3, output = 0;
  executor.step(&input, &output);
  EXPECT_EQ(executor.step(&input, &output), Answer::kFresh);
  EXPECT_EQ(output, 6);
  remote.fails = true;
  EXPECT_EQ(executor.step(&input, &output), Answer::kFault);
  remote.fails = false;
  EXPECT_EQ(executor.step(&input, &output), Answer::kFault);
  executor.reset();
  EXPECT_EQ(executor.step(&input, &output), Answer::kFresh);
  EXPECT_EQ(output, 3);
}

TEST(CompiledModel, AllocatesNothing) {
  sensing::RecurrentWeights weights = sensing::RecurrentWeights::zero(21, 3, {64, 20});
  DirectExecutor executor(std::make_unique<CompiledModel>(weights));
  const std::vector<float> input(21, 1.f);
  std::vector<float> output(3);
  loop::NoAllocationScope scope;
  for (int k = 0; k < 100; ++k) executor.step(input.data(), output.data());
  EXPECT_EQ(scope.count(), 0);
}

TEST(CompiledModel, ANumberThatIsNotFiniteIsAFailure) {
  CompiledModel model(sensing::RecurrentWeights::zero(1, 1, {1}));
  float input = std::nanf(""), output = 0;
  float state[2] = {0, 0};
  EXPECT_FALSE(model.step(&input, state, &output));
}

}  // namespace
}  // namespace palpate::inference

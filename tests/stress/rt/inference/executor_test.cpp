#include <gtest/gtest.h>

#include "rt/inference/torch_executor.hpp"
#include "tests/stress/rhythm.hpp"

namespace palpate::inference {
namespace {

/// Counts its samples in its state, at a rate that often misses the deadline.
class Counter final : public SequenceModel {
 public:
  ModelSizes sizes() const noexcept override { return {4, 1, 2}; }
  bool step(const float* input, float* state, float* output) noexcept override {
    rhythm_.beat();
    state[0] += 1;
    output[0] = state[0];
    output[1] = input[0] + input[1] + input[2] + input[3];
    return true;
  }
  const char* kind() const noexcept override { return "counter"; }

 private:
  stress::Rhythm rhythm_{5};
};

TEST(TorchExecutorStress, SamplesAndAnswersChangeHandsWhole) {
  TorchExecutorOptions options;
  options.wait = 20e-6;
  options.patience = 100;
  options.depth = 64;
  TorchExecutor executor(std::make_unique<Counter>(), options);
  stress::Rhythm rhythm(6);
  long answers = 0;
  float last = 0;
  for (int i = 1; i <= 20000; ++i) {
    rhythm.beat();
    const float quarter = static_cast<float>(i) / 4;
    const float input[] = {quarter, quarter, quarter, quarter};
    float output[] = {0, 0};
    const Answer answer = executor.step(input, output);
    ASSERT_NE(answer, Answer::kFault);
    if (answer == Answer::kNone) continue;
    ++answers;
    ASSERT_GE(output[0], last) << "answers come in order";
    last = output[0];
    // The model has received as many samples as were sent, except the dropped ones.
    ASSERT_LE(output[0], output[1]);
    ASSERT_GE(output[0], output[1] - static_cast<float>(executor.counters().dropped));
    if (answer == Answer::kFresh) {
      ASSERT_EQ(output[1], static_cast<float>(i));
    }
  }
  EXPECT_GT(answers, 0);
}

TEST(TorchExecutorStress, EndsAtAnyMoment) {
  for (int round = 0; round < 100; ++round) {
    TorchExecutorOptions options;
    options.wait = 0;
    options.patience = 100;
    TorchExecutor executor(std::make_unique<Counter>(), options);
    const float input[] = {1, 2, 3, 4};
    float output[2];
    for (int i = 0; i < round; ++i) {
      executor.step(input, output);
      if (i % 7 == 3) executor.reset();
    }
  }
}

}  // namespace
}  // namespace palpate::inference

#include "tools/train/trainer.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "core/sensing/recurrent_network.hpp"

namespace palpate::train {
namespace {

/// The target is the input three steps before: no map of the current input can represent it.
std::vector<Sequence> echoes() {
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  std::vector<Sequence> sequences;
  for (int s = 0; s < 2; ++s) {
    Sequence sequence;
    sequence.inputs.resize(400, 1);
    sequence.targets.setZero(400, 1);
    sequence.weights.setOnes(400);
    for (Eigen::Index k = 0; k < 400; ++k) {
      sequence.inputs(k, 0) = normal(random);
      if (k >= 3) sequence.targets(k, 0) = sequence.inputs(k - 3, 0);
    }
    sequences.push_back(sequence);
  }
  return sequences;
}

recordings::TrainingPlan short_plan() {
  recordings::TrainingPlan plan;
  plan.iterations = 300;
  plan.evaluate_every = 20;
  plan.lanes = 8;
  plan.steps = 25;
  plan.burn_in = 3;
  plan.rate = 0.02;
  return plan;
}

/// Mean squared error of the streamed kernel on the last sequence.
double streamed_error(const Cells& cells, const Sequence& sequence) {
  sensing::RecurrentWeights weights =
      sensing::RecurrentWeights::zero(1, 1, {cells.layers[0].size()});
  weights.layers = cells.layers;
  weights.dense = cells.dense;
  weights.offset = cells.offset;
  sensing::RecurrentNetwork network(weights);
  std::vector<float> state(network.states(), 0.f);
  double sum = 0;
  for (Eigen::Index k = 0; k < sequence.inputs.rows(); ++k) {
    float y = 0;
    network.step(&sequence.inputs(k, 0), state.data(), &y);
    sum += std::pow(y - sequence.targets(k, 0), 2);
  }
  return sum / static_cast<double>(sequence.inputs.rows());
}

TEST(Trainer, LearnsToRememberAndStreams) {
  const std::vector<Sequence> sequences = echoes();
  TrainerHooks hooks;
  hooks.validate = [&](const Cells& cells) { return streamed_error(cells, sequences[1]); };
  hooks.progress = [](const CurvePoint&) { return true; };
  const TrainerResult result = train_cells({sequences[0]}, {8}, short_plan(), hooks);
  EXPECT_LT(streamed_error(result.cells, sequences[1]), 0.3);  // 1 without memory
  EXPECT_GT(result.best_iteration, 0);
  EXPECT_EQ(result.curve.front().iteration, 0);
}

TEST(Trainer, AStopAndAResumptionChangeNothing) {
  const std::vector<Sequence> sequences = echoes();
  const std::string file =
      (std::filesystem::temp_directory_path() / ("palpate-checkpoint-" + std::to_string(getpid())))
          .string();
  recordings::TrainingPlan plan = short_plan();
  plan.iterations = 60;
  plan.input_noise = 0.1;
  TrainerHooks hooks;
  hooks.validate = [&](const Cells& cells) { return streamed_error(cells, sequences[1]); };
  hooks.progress = [](const CurvePoint&) { return true; };
  const TrainerResult whole = train_cells(sequences, {4}, plan, hooks);

  hooks.checkpoint = file;
  hooks.progress = [](const CurvePoint& point) { return point.iteration < 20; };
  train_cells(sequences, {4}, plan, hooks);
  hooks.resume = true;
  hooks.progress = [](const CurvePoint&) { return true; };
  const TrainerResult resumed = train_cells(sequences, {4}, plan, hooks);
  EXPECT_EQ(resumed.cells.layers[0].hidden, whole.cells.layers[0].hidden);
  EXPECT_EQ(resumed.cells.dense, whole.cells.dense);
  ASSERT_EQ(resumed.curve.size(), whole.curve.size());
  EXPECT_EQ(resumed.curve.back().training, whole.curve.back().training);

  plan.rate *= 2;
  EXPECT_THROW(train_cells(sequences, {4}, plan, hooks), std::runtime_error);
  std::ofstream(file) << "no checkpoint";
  EXPECT_THROW(train_cells(sequences, {4}, short_plan(), hooks), std::runtime_error);
  std::filesystem::remove(file);
}

TEST(Trainer, SaysWhereThereIsTooLittleToLearnFrom) {
  std::vector<Sequence> sequences = echoes();
  recordings::TrainingPlan plan = short_plan();
  plan.steps = 401;
  TrainerHooks hooks;
  hooks.validate = [](const Cells&) { return 1.0; };
  hooks.progress = [](const CurvePoint&) { return true; };
  EXPECT_THROW(train_cells(sequences, {4}, plan, hooks), std::runtime_error);
  EXPECT_THROW(train_cells({}, {4}, plan, hooks), std::runtime_error);
}

}  // namespace
}  // namespace palpate::train

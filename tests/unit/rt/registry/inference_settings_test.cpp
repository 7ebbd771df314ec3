#include <gtest/gtest.h>

#include "rt/registry/registry.hpp"

namespace palpate::registry {
namespace {

inference::TorchExecutorOptions read(const std::string& text, bool deterministic = false) {
  return read_inference(config::Node::from_text(text), deterministic);
}

TEST(InferenceSettings, LieJustBelowTheLoop) {
  EXPECT_EQ(read("{}").fifo_priority, 49);
  EXPECT_EQ(read("{}").cpu, -1);
  EXPECT_EQ(read("loop: {fifo_priority: 80}").fifo_priority, 79);
  EXPECT_EQ(read("loop: {fifo_priority: 0}").fifo_priority, 0);
  EXPECT_EQ(read("{loop: {fifo_priority: 80}, inference: {priority: 5, cpu: 2}}").fifo_priority, 5);
  EXPECT_EQ(read("inference: {cpu: 2}").cpu, 2);
}

TEST(InferenceSettings, AreNotTakenInDeterministicMode) {
  EXPECT_EQ(read("inference: {priority: 5, cpu: 2}", true).fifo_priority, 0);
  EXPECT_EQ(read("inference: {priority: 5, cpu: 2}", true).cpu, -1);
  EXPECT_THROW(read("inference: {priority: 99}", true), config::Error);
}

TEST(InferenceSettings, AreCheckedForRange) {
  EXPECT_THROW(read("inference: {priority: 99}"), config::Error);
  EXPECT_THROW(read("inference: {cpu: -2}"), config::Error);
}

}  // namespace
}  // namespace palpate::registry

#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "core/sensing/sequence_executor.hpp"

namespace palpate::sensing {

/// Computes a function of its input with a configurable status. The script must outlive it.
struct Script {
  ModelSizes sizes;
  std::function<void(const float* input, float* output)> answer;
  Answer says = Answer::kFresh;
  int steps = 0;
  int resets = 0;
};

class ScriptedExecutor final : public Executor {
 public:
  explicit ScriptedExecutor(Script& script) : script_(script) {}
  ModelSizes sizes() const noexcept override { return script_.sizes; }
  Answer step(const float* input, float* output) noexcept override {
    ++script_.steps;
    if (script_.says == Answer::kFresh || script_.says == Answer::kLate)
      script_.answer(input, output);
    return script_.says;
  }
  void reset() noexcept override { ++script_.resets; }
  ExecutorCounters counters() const noexcept override { return {script_.steps, 0, 0, 0}; }
  const char* kind() const noexcept override { return "scripted"; }

 private:
  Script& script_;
};

}  // namespace palpate::sensing

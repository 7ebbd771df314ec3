#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "core/sensing/sequence_executor.hpp"

namespace palpate::sensing {

/// Learned model within a component: selects its inputs from those the component offers and
/// arranges its outputs in the component's order.
class StreamedModel {
 public:
  /// `inputs`: for each input of the model its index in the argument of step(), >= 0; `outputs`:
  /// for each output that the component needs its index among the model's outputs. Throws
  /// std::invalid_argument if the executor is null or sizes or indices do not match it.
  StreamedModel(std::unique_ptr<Executor> executor, const std::vector<int>& inputs,
                const std::vector<int>& outputs);

  /// Runs one step on `offered`. After a fault it has no effect until reset().
  void step(const Eigen::Ref<const Eigen::VectorXd>& offered) noexcept;
  /// Starts a new sequence; a fault persists.
  void restart() noexcept;
  /// Starts a new sequence, also after a fault.
  void reset() noexcept;

  bool has_failed() const noexcept { return failed_; }
  /// An output of this sequence is available.
  bool has_answer() const noexcept { return has_answer_; }
  /// Latest output; zero before the first.
  const Eigen::VectorXd& answer() const noexcept { return answer_; }
  const Executor& executor() const noexcept { return *executor_; }

 private:
  std::unique_ptr<Executor> executor_;
  std::vector<int> inputs_, outputs_;
  std::vector<float> input_, output_;
  Eigen::VectorXd answer_;
  bool failed_ = false;
  bool has_answer_ = false;
};

}  // namespace palpate::sensing

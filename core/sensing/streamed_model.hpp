#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "core/sensing/sequence_executor.hpp"

namespace palpate::sensing {

/// A learned model within a component: picks its inputs out of all that the component can offer and
/// brings its outputs into the component's order.
class StreamedModel {
 public:
  /// `inputs`: for each input of the model its place in what step() is offered, none below 0;
  /// `outputs`: for each answer that the component wants its place among the model's outputs.
  /// Throws std::invalid_argument where the executor is absent or sizes or places do not fit it.
  StreamedModel(std::unique_ptr<Executor> executor, const std::vector<int>& inputs,
                const std::vector<int>& outputs);

  /// Runs one step on `offered`. After a fault it does nothing until reset().
  void step(const Eigen::Ref<const Eigen::VectorXd>& offered) noexcept;
  /// Begins a new sequence; a fault stays.
  void restart() noexcept;
  /// Begins a new sequence, after a fault also.
  void reset() noexcept;

  bool has_failed() const noexcept { return failed_; }
  /// Of this sequence.
  bool has_answer() const noexcept { return has_answer_; }
  /// The answer taken last; zero before the first.
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

#include "core/sensing/streamed_model.hpp"

#include <stdexcept>

namespace palpate::sensing {

StreamedModel::StreamedModel(std::unique_ptr<Executor> executor, const std::vector<int>& inputs,
                             const std::vector<int>& outputs)
    : executor_(std::move(executor)), inputs_(inputs), outputs_(outputs) {
  if (!executor_) throw std::invalid_argument("a learned model needs an executor");
  const ModelSizes sizes = executor_->sizes();
  if (static_cast<int>(inputs_.size()) != sizes.inputs)
    throw std::invalid_argument("a place is wanted for every input of the model");
  for (const int place : inputs_)
    if (place < 0) throw std::invalid_argument("an input of the model has no place");
  for (const int place : outputs_)
    if (place < 0 || place >= sizes.outputs)
      throw std::invalid_argument("the model has not the outputs that are wanted");
  input_.assign(sizes.inputs, 0.f);
  output_.assign(sizes.outputs, 0.f);
  answer_.setZero(static_cast<Eigen::Index>(outputs_.size()));
}

void StreamedModel::step(const Eigen::Ref<const Eigen::VectorXd>& offered) noexcept {
  if (failed_) return;
  for (std::size_t i = 0; i < inputs_.size(); ++i)
    input_[i] = static_cast<float>(offered[inputs_[i]]);
  switch (executor_->step(input_.data(), output_.data())) {
    case Answer::kFresh:
    case Answer::kLate:
      for (std::size_t i = 0; i < outputs_.size(); ++i)
        answer_[static_cast<Eigen::Index>(i)] = output_[outputs_[i]];
      // guards against executors that do not check their output
      failed_ = !answer_.allFinite();
      has_answer_ = !failed_;
      break;
    case Answer::kNone:
      break;
    case Answer::kFault:
      failed_ = true;
      has_answer_ = false;
      break;
  }
  if (failed_) answer_.setZero();
}

void StreamedModel::restart() noexcept {
  if (failed_) return;
  executor_->reset();
  has_answer_ = false;
  answer_.setZero();
}

void StreamedModel::reset() noexcept {
  failed_ = false;
  restart();
}

}  // namespace palpate::sensing

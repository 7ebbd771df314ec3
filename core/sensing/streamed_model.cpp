#include "core/sensing/streamed_model.hpp"

#include <stdexcept>

#include "core/math/option_check.hpp"

namespace palpate::sensing {

StreamedModel::StreamedModel(std::unique_ptr<Executor> executor, const std::vector<int>& inputs,
                             const std::vector<int>& outputs)
    : executor_(std::move(executor)), inputs_(inputs), outputs_(outputs) {
  if (!executor_) throw std::invalid_argument("executor: null; allowed: the model's executor");
  const ModelSizes sizes = executor_->sizes();
  math::check_option(static_cast<int>(inputs_.size()) == sizes.inputs, "inputs", inputs_.size(),
                     std::to_string(sizes.inputs) + " indices, one for each input of the model");
  for (const int place : inputs_) math::check_option(place >= 0, "inputs", place, "at least 0");
  for (const int place : outputs_)
    math::check_option(place >= 0 && place < sizes.outputs, "outputs", place,
                       "0 to below the model's " + std::to_string(sizes.outputs) + " outputs");
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

#include "core/sensing/signal_history.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace palpate::sensing {
namespace {

constexpr double kMostRows = 1e6;

int checked_capacity(int width, int window, double largest_delay) {
  if (width < 1 || window < 1 || !(largest_delay >= 0) || !(window + largest_delay <= kMostRows))
    throw std::invalid_argument("signal history: width, window or delay is out of range");
  return window + static_cast<int>(std::ceil(largest_delay)) + 1;
}

}  // namespace

SignalHistory::SignalHistory(int width, int window, double largest_delay)
    : rows_(Eigen::MatrixXd::Zero(width, checked_capacity(width, window, largest_delay))),
      window_(window) {}

void SignalHistory::push(const Eigen::Ref<const Eigen::VectorXd>& row) noexcept {
  const int capacity = static_cast<int>(rows_.cols());
  // After weeks at 1 kHz: reduces the count without changing its effect.
  if (count_ == std::numeric_limits<int>::max()) count_ = capacity + (count_ % capacity);
  rows_.col(count_ % capacity) = row;
  ++count_;
}

void SignalHistory::mean(int first, double delay, Eigen::Ref<Eigen::VectorXd> mean) const noexcept {
  mean.setZero();
  const int rows = std::min(window_, count_);
  const auto capacity = static_cast<int>(rows_.cols());
  const Eigen::Index width = mean.size();
  for (int k = count_ - rows; k < count_; ++k) {
    const double at = std::max(k - delay, 0.0);
    const int left = static_cast<int>(at);
    const double part = at - left;
    mean += (1 - part) * rows_.col(left % capacity).segment(first, width);
    if (part > 0) mean += part * rows_.col((left + 1) % capacity).segment(first, width);
  }
  if (rows > 0) mean /= rows;
}

}  // namespace palpate::sensing

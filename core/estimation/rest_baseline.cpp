#include "core/estimation/rest_baseline.hpp"

namespace palpate::estimation {
namespace {

constexpr double kMeanWindow = 0.05;  // s, window of the short-term mean
constexpr double kLongest = 2;        // s, averaging window of the baseline

}  // namespace

void RestBaseline::accumulate(const Innovation& now) noexcept {
  latest_ = now.y;
  if (count_ > 0 && held_ == now.held) {
    recent_ += (now.y - recent_) / sampling_.updates_in(kMeanWindow);
    return;
  }
  mean_ = recent_ = now.y;
  measured_ = now.measured;
  noise_ = spread_ = WrenchFilter::Wrenches::Zero(now.y.size());
  held_ = now.held;
  count_ = 1;
}

void RestBaseline::extend(const Innovation& now) noexcept {
  count_ = std::min(count_ + 1, sampling_.updates_in(kLongest));
  const WrenchFilter::Wrenches off = recent_ - mean_;
  spread_ += (off.cwiseAbs2() - spread_) / count_;
  noise_ += ((latest_ - mean_).cwiseAbs2() - noise_) / count_;
  mean_ += off / count_;
  measured_ += (now.measured - measured_) / count_;
}

Innovation RestBaseline::change(const Innovation& now, int states) const noexcept {
  Innovation result = now;
  result.y = recent_ - mean_;
  result.H.leftCols(states).setZero();
  result.R.setZero();
  // Equivalent number of equally weighted wrenches of an exponential mean over n: 2 n - 1.
  const double mean_of = 2.0 * sampling_.updates_in(kMeanWindow) - 1;
  for (int row = 0; row < result.y.size(); ++row) {
    const double noise = sampling_.deviation(row);
    result.R(row, row) = std::max(noise * noise / mean_of, spread_[row]);
  }
  return result;
}

WrenchFilter::Noise RestBaseline::noise(const WrenchFilter::Wrenches& pushed,
                                        int count) const noexcept {
  constexpr double kLeast = 0.3;      // lower bound, as a fraction of the expected noise
  constexpr double kUncertain = 1.3;  // margin for the uncertainty of the estimated spread
  // Relative error of the predicted response to an external contact, which is a small change.
  constexpr double kPushError = 0.05;
  WrenchFilter::Noise R = WrenchFilter::Noise::Zero(pushed.size(), pushed.size());
  for (int row = 0; row < pushed.size(); ++row) {
    const double least = kLeast * sampling_.deviation(row);
    const double error = kPushError * pushed.segment<3>(row - row % 3).norm();
    R(row, row) = std::max(kUncertain * noise_[row], least * least) / count + error * error;
  }
  return R;
}

void RestBaseline::follow(const WrenchFilter::Wrenches& off, bool has_contact) noexcept {
  if (count_ == 0 || recent_.size() != off.size()) return;
  recent_ -= off;
  if (!has_contact) mean_ -= off;
}

void RestBaseline::follow_contact(int grasp, const math::Vector6d& wrench) noexcept {
  if (count_ == 0 || !held_[grasp]) return;
  latest_.segment<6>(grasp == 1 && held_[0] ? 6 : 0) -= wrench;
}

}  // namespace palpate::estimation

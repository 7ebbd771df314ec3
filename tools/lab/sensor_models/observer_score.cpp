#include "tools/lab/sensor_models/observer_score.hpp"

#include <algorithm>
#include <cmath>
#include <palpate/channels.hpp>
#include <palpate/contacts_t.hpp>
#include <palpate/truth_touch_t.hpp>
#include <stdexcept>

#include "tools/log/log_reader.hpp"

namespace palpate::sensor_models {
namespace {

constexpr int kWristSource = 0;    // of contacts_t::source
constexpr double kMostLag = 0.2;   // s, looked for
constexpr double kLagStep = 1e-3;  // s

/// Linear interpolation between the samples; constant beyond the ends.
Eigen::Vector3d force_at(const ForceSeries& series, double time) {
  const auto after = std::upper_bound(series.time.begin(), series.time.end(), time);
  if (after == series.time.begin()) return series.force.col(0);
  const auto left = static_cast<Eigen::Index>(after - series.time.begin()) - 1;
  if (after == series.time.end()) return series.force.col(left);
  const double begin = series.time[left], share = (time - begin) / (*after - begin);
  return (1 - share) * series.force.col(left) + share * series.force.col(left + 1);
}

struct Errors {
  double rms = 0, max = 0;
};

Errors errors_at_lag(const ForceSeries& felt, const ForceSeries& truth, std::size_t first,
                     std::size_t last, double lag) {
  Errors errors;
  double squares = 0;
  for (std::size_t i = first; i <= last; ++i) {
    const double error =
        (force_at(felt, truth.time[i] + lag) - truth.force.col(static_cast<Eigen::Index>(i)))
            .norm();
    squares += error * error;
    errors.max = std::max(errors.max, error);
  }
  errors.rms = std::sqrt(squares / static_cast<double>(last - first + 1));
  return errors;
}

}  // namespace

ForceSeries read_wrist_contacts(const std::filesystem::path& log, double begin) {
  std::vector<contacts_t> messages;
  log::LogReader reader(log::LogClock::kSent);
  reader.collect(channel::kContacts, messages);
  reader.read(log);
  ForceSeries series;
  series.force.resize(3, static_cast<Eigen::Index>(messages.size()));
  series.torque.resizeLike(series.force);
  for (const contacts_t& message : messages) {
    const double time = 1e-6 * static_cast<double>(message.utime);
    if (time < begin || message.count < 1 || message.source[0] != kWristSource) continue;
    const auto k = static_cast<Eigen::Index>(series.time.size());
    series.time.push_back(time);
    series.force.col(k) = Eigen::Map<const Eigen::Vector3d>(message.wrench[0]);
    series.torque.col(k) = Eigen::Map<const Eigen::Vector3d>(message.wrench[0] + 3);
  }
  if (series.time.empty())
    throw std::runtime_error(log.string() + ": the daemon says nothing of the wrist");
  series.force.conservativeResize(3, static_cast<Eigen::Index>(series.time.size()));
  series.torque.conservativeResize(3, static_cast<Eigen::Index>(series.time.size()));
  return series;
}

ForceSeries read_true_touch(const std::filesystem::path& housekeeping_log) {
  std::vector<truth_touch_t> messages;
  log::LogReader reader(log::LogClock::kSent);
  reader.collect(channel::kTruthTouch, messages);
  reader.read(housekeeping_log);
  ForceSeries series;
  series.force.setZero(3, static_cast<Eigen::Index>(messages.size()));
  for (const truth_touch_t& message : messages) {
    const auto k = static_cast<Eigen::Index>(series.time.size());
    series.time.push_back(1e-6 * static_cast<double>(message.utime));
    for (int i = 0; i < message.fingertip_count; ++i)
      series.force.col(k) += Eigen::Map<const Eigen::Vector3d>(message.force[i]);
  }
  return series;
}

ResidualScore score_residual(const ForceSeries& felt) {
  const auto n = static_cast<double>(felt.time.size());
  const Eigen::RowVectorXd force = felt.force.colwise().norm(),
                           torque = felt.torque.colwise().norm();
  return {std::sqrt(force.squaredNorm() / n), force.maxCoeff(), std::sqrt(torque.squaredNorm() / n),
          torque.maxCoeff()};
}

TrackingScore score_tracking(const ForceSeries& felt, const ForceSeries& truth) {
  const Eigen::RowVectorXd size = truth.force.colwise().norm();
  std::size_t first = truth.time.size(), last = 0;
  for (std::size_t i = 0; i < truth.time.size(); ++i) {
    if (!(size(static_cast<Eigen::Index>(i)) > 0)) continue;
    first = std::min(first, i);
    last = i;
  }
  if (first > last) throw std::runtime_error("nothing touches the hand");
  TrackingScore score;
  score.peak = size.maxCoeff();
  score.peak_error = std::abs(felt.force.colwise().norm().maxCoeff() - score.peak);
  const Errors now = errors_at_lag(felt, truth, first, last, 0);
  score.error_rms = score.lagged_rms = now.rms;
  score.error_max = score.lagged_max = now.max;
  for (double lag = kLagStep; lag <= kMostLag; lag += kLagStep) {
    const Errors errors = errors_at_lag(felt, truth, first, last, lag);
    if (errors.rms >= score.lagged_rms) continue;
    score.lag = lag;
    score.lagged_rms = errors.rms;
    score.lagged_max = errors.max;
  }
  return score;
}

Eigen::RowVectorXd tracking_error(const ForceSeries& felt, const ForceSeries& truth) {
  Eigen::RowVectorXd errors(truth.force.cols());
  for (Eigen::Index k = 0; k < errors.size(); ++k)
    errors(k) = (force_at(felt, truth.time[k]) - truth.force.col(k)).norm();
  return errors;
}

}  // namespace palpate::sensor_models

#pragma once

#include <cmath>
#include <vector>

#include "core/estimation/wrench_filter.hpp"

namespace palpate::estimation {

/// Shapes of the last 0.3 s with the state that produced each, so that delayed observations are
/// compared with the shape at their acquisition time. Nothing allocates after construction.
class ShapeHistory {
 public:
  static constexpr double kPeriod = 0.005;  // s between two shapes
  static constexpr double kLongest = 0.3;   // s

  struct Moment {
    Eigen::Matrix3Xd positions;   // m
    Eigen::Matrix3Xd velocities;  // m/s
    WrenchFilter::ShapeState state;
  };

  explicit ShapeHistory(int nodes) : entries_(static_cast<std::size_t>(kLongest / kPeriod) + 2) {
    for (Entry& entry : entries_) entry.positions.setZero(3, nodes);
  }

  void clear() noexcept { count_ = 0; }

  /// Call once per tick of `dt` seconds.
  void record(const Eigen::Matrix3Xd& positions, const WrenchFilter::ShapeState& state,
              double dt) noexcept {
    since_ += dt;
    if (count_ > 0 && since_ < kPeriod * (1 - 1e-9)) return;
    newest_ = (newest_ + 1) % entries_.size();
    count_ = std::min(count_ + 1, entries_.size());
    Entry& entry = entries_[newest_];
    entry.positions = positions.cast<float>();
    entry.state = state;
    entry.since = since_;
    since_ = 0;
  }

  /// Shape `ago` seconds before the last record(), interpolated between two entries. False if that
  /// is older than the oldest entry.
  bool recall(double ago, Moment& moment) const noexcept {
    double age = since_;
    for (std::size_t i = 0; i + 1 < count_; ++i) {
      const Entry& later = entries_[(newest_ + entries_.size() - i) % entries_.size()];
      const Entry& earlier = entries_[(newest_ + entries_.size() - i - 1) % entries_.size()];
      if (ago <= age + later.since || later.since <= 0) {
        const auto share = static_cast<float>(std::clamp((ago - age) / later.since, 0.0, 1.0));
        const auto rate = static_cast<float>(1 / later.since);
        moment.positions =
            (later.positions + share * (earlier.positions - later.positions)).cast<double>();
        moment.velocities = (rate * (later.positions - earlier.positions)).cast<double>();
        moment.state = later.state + share * (earlier.state - later.state);
        return true;
      }
      age += later.since;
    }
    return false;
  }

 private:
  struct Entry {
    Eigen::Matrix3Xf positions;
    WrenchFilter::ShapeState state;
    double since = 0;  // s, from the previous entry
  };
  std::vector<Entry> entries_;
  std::size_t newest_ = 0, count_ = 0;
  double since_ = 0;  // s, since the newest entry
};

}  // namespace palpate::estimation

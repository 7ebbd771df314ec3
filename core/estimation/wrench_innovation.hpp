#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "core/estimation/wrench_filter.hpp"

namespace palpate::estimation {

/// Rate, noise and acceptance of the wrench updates of a filter.
struct WrenchSampling {
  double period = 0.01;   // s, between two wrench updates of the filter
  double force = 0.03;    // N, standard deviation of one wrench update, and of the model error
  double torque = 0.003;  // N m
  /// Gate on the normalised squared innovation of a hand, which is chi-square distributed with 6
  /// degrees of freedom: 40 is exceeded with p = 5e-7, once in 6 h at 100 Hz.
  double gate = 40;

  /// Standard deviation of a row of the innovation, N or N m.
  double deviation(Eigen::Index row) const noexcept { return row % 6 < 3 ? force : torque; }
  /// Number of wrench updates in a time, at least one.
  int updates_in(double seconds) const noexcept {
    return std::max(1, static_cast<int>(std::lround(seconds / period)));
  }
};

/// Rows of the innovation per hand.
inline constexpr int kHandRows = 6;

/// Innovation of all held hands with a wrench, and its dependence on the states. Six rows (N, N m,
/// in O at the origin of G) per hand, in order of the grasps.
struct Innovation {
  std::array<bool, 2> held{};
  WrenchFilter::Rows H;
  WrenchFilter::Wrenches y;   // measured minus predicted
  WrenchFilter::Noise R;      // covariance of y's noise and of the model error
  WrenchFilter::Noise noise;  // covariance of y's noise alone, including that of moving hands
  /// Motion of each hand since the last update, in distances that decorrelate the model error.
  std::array<double, 2> travel{};
  WrenchFilter::Wrenches measured;  // mean measured wrenches

  double rows() const noexcept { return static_cast<double>(y.size()); }
};

}  // namespace palpate::estimation
